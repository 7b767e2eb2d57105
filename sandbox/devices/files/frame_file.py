"""Recorded touch frames: JSON lines, one a frame, lengths in inches.

    {"surface_in": [7.76, 5.82], "device": "evdev"}
    {"time": 2.99, "contacts": [{"id": 0, "x": 1.21, "y": 1.21, "finger": null}]}

The first line is optional. A frame may also have `cancelled` (ids) and `lift` (0 to 1), a contact
`size`. A damaged file is good up to the damage.
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from models.errors import FrameError, InputError, RecordingError
from models.frames import FINGERS, Contact, TouchFrame
from models.surface import METRES_PER_INCH, Surface
from sandbox.session.device import Device

_LONGEST_LINE = 1_000_000
_EXPECTED = '{"time": seconds, "contacts": [{"id", "x", "y", "finger"}]}, times never backwards'


@dataclass(frozen=True)
class FrameFile:
    """The frames of a file.

    Attributes:
        frames: Up to the end or the damage.
        surface: Its size, where the file says so.
        damage: What ended the file early, with file and line; None where it is whole.
    """

    frames: tuple[TouchFrame, ...]
    surface: Surface | None = None
    damage: RecordingError | None = None


class FramesDevice(Device):
    """Plays frames at their times; time 0 of the session is the first of them.

    Args:
        frames: In order of time.
        damage: What ended the file that they are from.
    """

    name = "frames"
    plays_file = True
    damage: RecordingError | None
    has_lift: bool

    def __init__(self, frames: Sequence[TouchFrame], damage: RecordingError | None = None) -> None:
        start = frames[0].time if frames else 0.0
        self._frames = [replace(frame, time=frame.time - start) for frame in frames]
        self._next = 0
        self.damage = damage
        self.has_lift = any(frame.lift is not None for frame in frames)

    @property
    def finished(self) -> bool:
        """True after the last frame."""
        return self._next >= len(self._frames)

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The frames due by `now`, oldest first."""
        first = self._next
        while not self.finished and self._frames[self._next].time <= now:
            self._next += 1
        return self._frames[first : self._next]

    def close(self) -> None:
        """Ends the play."""
        self._next = len(self._frames)


def frame_record(frame: TouchFrame) -> dict[str, Any]:
    """A frame as a line has it; what a device does not tell is left out, save for the finger."""
    contacts = []
    for contact in frame.contacts:
        record: dict[str, Any] = {
            "id": contact.id,
            "x": contact.x / METRES_PER_INCH,
            "y": contact.y / METRES_PER_INCH,
            "finger": None if contact.label is None else FINGERS[contact.label],
        }
        if contact.size is not None:
            record["size"] = contact.size / METRES_PER_INCH
        contacts.append(record)
    line: dict[str, Any] = {"time": frame.time, "contacts": contacts}
    if frame.lift is not None:
        line["lift"] = frame.lift
    if frame.cancelled:
        line["cancelled"] = sorted(frame.cancelled)
    return line


def header_record(surface: Surface, device: str) -> dict[str, Any]:
    """The first line of a file."""
    return {"surface_in": [surface.width_in, surface.height_in], "device": device}


def read_frame_file(path: Path) -> FrameFile:
    """Reads a file up to its end or to the first damaged line.

    Raises:
        RecordingError: There is no such file, or not even its first frame can be read.
    """
    surface: Surface | None = None
    frames: list[TouchFrame] = []
    damage: RecordingError | None = None
    try:
        for number, line in _lines(path):
            try:
                record = json.loads(line)
                if not isinstance(record, dict):
                    raise TypeError("the line is not a JSON object")
                if "surface_in" in record and not frames and surface is None:
                    width, height = record["surface_in"]
                    surface = Surface(float(width), float(height))
                    continue
                frame = _frame(record)
                if frames and frame.time < frames[-1].time:
                    raise ValueError("the time runs backwards")
            except (ValueError, TypeError, KeyError, OverflowError, RecursionError,
                    InputError) as error:  # fmt: skip
                damage = RecordingError(
                    f"the recording of touches is damaged here: {_reason(error)}",
                    where=f"{path}, line {number}",
                    got=line[:40],
                    expected=_EXPECTED,
                    remedy="What stands before this line can be played" if frames else
                    "`sandbox touches formats` lists what can be played",
                )  # fmt: skip
                break
            frames.append(frame)
    except OSError as error:
        raise RecordingError("cannot be read", where=str(path), got=error.strerror) from None
    if not frames:
        raise damage or RecordingError(
            "there is no touch in it", where=str(path), expected=f"lines like {_EXPECTED}"
        )
    return FrameFile(tuple(frames), surface, damage)


def _lines(path: Path) -> Iterator[tuple[int, bytes]]:
    with path.open("rb") as file:
        number = 0
        while line := file.readline(_LONGEST_LINE):
            number += 1
            if line.strip():
                yield number, line


def _frame(record: dict[str, Any]) -> TouchFrame:
    """One line; what is wrong with it leaves as an error of Python's or as a `FrameError`."""
    contacts = []
    for c in record["contacts"]:
        finger, size = c.get("finger"), c.get("size")
        if finger is not None and finger not in FINGERS:
            raise ValueError(f"there is no finger {str(finger)[:20]!r}")
        if size is not None and not 0.0 < float(size) < math.inf:
            raise ValueError("a size is not positive")
        contacts.append(
            Contact(
                _id(c["id"]),
                METRES_PER_INCH * float(c["x"]),
                METRES_PER_INCH * float(c["y"]),
                None if size is None else METRES_PER_INCH * float(size),
                None if finger is None else FINGERS.index(finger),
            )
        )
    lift = record.get("lift")
    return TouchFrame(
        float(record["time"]),
        tuple(contacts),
        None if lift is None else float(lift),
        frozenset(_id(i) for i in record.get("cancelled", [])),
        "file",
    )


def _id(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise TypeError("an id is no whole number")
    return value


def _reason(error: Exception) -> str:
    if isinstance(error, KeyError):
        return f"{error} is missing"
    if isinstance(error, FrameError):
        return str(error.args[0]) if error.args else "no frame"
    return str(error)
