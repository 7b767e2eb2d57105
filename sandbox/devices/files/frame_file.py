"""Recorded touch frames: JSON lines, one per frame, lengths in inches.

    {"surface_in": [7.76, 5.82], "surface_calibrated": true, "device": "evdev"}
    {"time": 2.99, "contacts": [{"id": 0, "x": 1.21, "y": 1.21, "finger": null}]}

The first line is optional; its `surface_calibrated` is false where the size is a guess. A frame may
also have `cancelled` (ids) and `lift` (0 to 1), a contact `size`, or `width` and `height` too. A
damaged file is read up to the damage.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal

from msgspec import Meta, Struct

from models.errors import FrameError, InputError, RecordingError
from models.frames import FINGERS, Contact, TouchFrame
from models.json_input import decoded, numbered_lines
from models.surface import METRES_PER_INCH, Surface
from sandbox.devices.device import Closeable, Device


class LineFile(Closeable):
    """Writes lines from one thread; a crash loses at most the line being written.

    Args:
        path: The file; an existing file is never overwritten.

    Attributes:
        lines: Number of lines written.

    Raises:
        RecordingError: The file exists or cannot be made.
    """

    def __init__(self, path: Path) -> None:
        self.path, self.lines = path, 0
        try:
            self._file = path.open("x", encoding="utf-8")
        except FileExistsError:
            raise RecordingError(
                "this file exists already, and is not overwritten", where=str(path)
            ) from None
        except OSError as error:
            raise RecordingError("cannot be written", where=str(path), got=error.strerror) from None

    def write(self, values: Mapping[str, Any]) -> None:
        """Appends a line.

        Raises:
            RecordingError: The line cannot be written; the lines before it are on disk.
        """
        try:
            print(json.dumps(values, separators=(",", ":")), file=self._file, flush=True)
        except OSError as error:
            raise RecordingError(
                "the recording cannot go on",
                where=str(self.path),
                got=error.strerror,
                remedy="Make room on the disk; the lines before this are kept",
            ) from None
        self.lines += 1

    def discard(self) -> None:
        """Closes the file and removes it, where nothing was to be written."""
        self.close()
        self.path.unlink(missing_ok=True)

    def close(self) -> None:
        """Closes the file; may be called twice."""
        # `write` has already reported a line that could not be written.
        with suppress(OSError):
            self._file.close()


LONGEST_LINE = 1_000_000
"""Largest number of bytes in a line; a frame of ten contacts has about a thousand."""

_DAMAGED = "the recording of touches is damaged here"
_PLAYABLE = "The lines before this one can be played"
_FORMATS = "`sandbox touches formats` lists what can be played"
_EXPECTED = '{"time": seconds, "contacts": [{"id", "x", "y", "finger"}]}, times never backwards'


class TouchLine(Struct):
    """A contact in a line; lengths in inches."""

    id: int
    x: float
    y: float
    finger: Literal["thumb", "index", "middle", "ring", "little"] | None = None
    size: Annotated[float, Meta(gt=0)] | None = None
    width: Annotated[float, Meta(gt=0)] | None = None
    height: Annotated[float, Meta(gt=0)] | None = None


class FrameLine(Struct):
    """A frame in a line; time in seconds."""

    time: float
    contacts: list[TouchLine]
    lift: float | None = None
    cancelled: list[int] = []


class HeaderLine(Struct):
    """The first line of a file with a header."""

    surface_in: tuple[float, float] | None = None
    surface_calibrated: bool = True


@dataclass(frozen=True)
class FrameFile:
    """The frames of a file.

    Attributes:
        frames: Frames up to the end or the damage.
        surface: Touch surface, if the file has its size; else None.
        damage: Error with file and line that ended the file early; None if it is undamaged.
    """

    frames: tuple[TouchFrame, ...]
    surface: Surface | None = None
    damage: RecordingError | None = None


class FramesDevice(Device):
    """Plays frames at their times; the first frame plays at session time 0.

    Args:
        frames: Frames in order of time.
        damage: Error that ended their file early; None without damage.
    """

    name = "frames"
    plays_file = True
    damage: RecordingError | None
    lift: bool

    def __init__(self, frames: Sequence[TouchFrame], damage: RecordingError | None = None) -> None:
        start = frames[0].time if frames else 0.0
        self._frames = [replace(frame, time=frame.time - start) for frame in frames]
        self._next = 0
        self.damage = damage
        self.lift = any(frame.lift is not None for frame in frames)

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
        """Ends playback."""
        self._next = len(self._frames)


def frame_record(frame: TouchFrame) -> dict[str, Any]:
    """JSON values of a frame's line, without unknown values; an unknown finger is null."""
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
        if contact.extent is not None:
            record["width"], record["height"] = (e / METRES_PER_INCH for e in contact.extent)
        contacts.append(record)
    line: dict[str, Any] = {"time": frame.time, "contacts": contacts}
    if frame.lift is not None:
        line["lift"] = frame.lift
    if frame.cancelled:
        line["cancelled"] = sorted(frame.cancelled)
    return line


def header_record(surface: Surface, device: str) -> dict[str, Any]:
    """JSON values of a file's first line."""
    size = [surface.width_in, surface.height_in]
    return {"surface_in": size, "surface_calibrated": surface.calibrated, "device": device}


def read_frame_file(path: Path) -> FrameFile:
    """Reads a file up to its end or to the first damaged line.

    Raises:
        RecordingError: The file does not exist, or its first frame cannot be read.
    """
    surface: Surface | None = None
    frames: list[TouchFrame] = []
    damage: RecordingError | None = None
    try:
        for number, line in numbered_lines(path, LONGEST_LINE):
            where, remedy = f"{path}, line {number}", _PLAYABLE if frames else _FORMATS
            try:
                if not frames and surface is None:
                    surface = frame_surface(line, where)
                    if surface is not None:
                        continue
                frame = _frame(decoded_frame(line, where, remedy))
                if frames and frame.time < frames[-1].time:
                    raise FrameError("the time runs backwards", got=frame.time)
            except RecordingError as error:
                damage = error
                break
            except InputError as error:
                damage = RecordingError(
                    f"{_DAMAGED}: {error.what}",
                    where=where,
                    got=None if error.got is None else str(error.got)[:40],
                    expected=error.expected,
                    remedy=remedy,
                )
                break
            frames.append(frame)
    except OSError as error:
        raise RecordingError("cannot be read", where=str(path), got=error.strerror) from None
    if not frames:
        raise damage or RecordingError(
            "the file contains no touches", where=str(path), expected=f"lines like {_EXPECTED}"
        )
    return FrameFile(tuple(frames), surface, damage)


def decoded_frame(line: bytes, where: str, remedy: str) -> FrameLine:
    """Decodes a line of a file.

    Args:
        line: The line, JSON.
        where: The file and the line's number.
        remedy: The next step for the person who reads the error.

    Raises:
        RecordingError: The line is not a frame.
    """
    return decoded(
        line,
        FrameLine,
        RecordingError,
        what=_DAMAGED,
        where=where,
        expected=_EXPECTED,
        remedy=remedy,
    )


def frame_surface(line: bytes, where: str) -> Surface | None:
    """The surface of a header line; None for a line without a surface.

    Raises:
        InputError: The line is not a JSON object, or its surface is invalid.
    """
    header = decoded(
        line,
        HeaderLine,
        RecordingError,
        what=_DAMAGED,
        where=where,
        expected=_EXPECTED,
        remedy=_FORMATS,
    )
    if header.surface_in is None:
        return None
    return Surface(*header.surface_in, calibrated=header.surface_calibrated)


def _frame(line: FrameLine) -> TouchFrame:
    return TouchFrame(
        line.time,
        tuple(
            Contact(
                touch.id,
                METRES_PER_INCH * touch.x,
                METRES_PER_INCH * touch.y,
                None if touch.size is None else METRES_PER_INCH * touch.size,
                None if touch.finger is None else FINGERS.index(touch.finger),
                None
                if touch.width is None or touch.height is None
                else (METRES_PER_INCH * touch.width, METRES_PER_INCH * touch.height),
            )
            for touch in line.contacts
        ),
        line.lift,
        frozenset(line.cancelled),
        "file",
    )
