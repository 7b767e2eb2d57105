"""Paired captures: a folder of touches and hand frames that were recorded together.

    touches.jsonl   as `sandbox touches record` writes it, and "host" in every frame
    hands.jsonl     a Leap message, or the landmarks of a picture, and "host" in every line
    asked.jsonl     fingers that the guide requests from time "host" on; only with a camera
    about.json      side and pseudonym of the person, names of the devices

"host" is the arrival time of the frame, s on the clock of the machine that wrote both files. Each
file of frames can be played as a device by itself. Times in a file without "host" are on the clock
of its device.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Literal

import numpy as np
from msgspec import Struct

from models.arithmetic import Array
from models.errors import RecordingError
from models.frames import HandFrame, TouchFrame
from models.json_input import decoded, numbered_lines, read_bytes
from models.reader_report import ReaderReport
from models.surface import Surface
from sandbox.devices.device import Closeable
from sandbox.devices.files.frame_file import LONGEST_LINE, LineFile, frame_record, header_record
from sandbox.devices.leap.leap_file import read_leap
from sandbox.devices.leap.leap_write import leap_message

UNNAMED = "unnamed"
"""Default pseudonym of a person."""

TOUCHES, HANDS, ASKED, ABOUT = "touches.jsonl", "hands.jsonl", "asked.jsonl", "about.json"


class About(Struct):
    """Contents of `about.json`; the program ignores other fields.

    Attributes:
        side: Side of the recorded hand.
        subject: Pseudonym of the recorded person; None if it is not given.
        simulated: True if the recording is of a simulated person.
        corners: px, the surface's corners in the camera's picture: top left, top right, bottom
            right, bottom left; None if they were not marked.
        fov: Horizontal field of view of the camera, degrees; None if it is unknown.
    """

    side: Literal["right", "left"]
    subject: str | None = None
    simulated: bool = False
    corners: list[tuple[float, float]] | None = None
    fov: float | None = None

    def person(self, asked: str | None) -> str:
        """Returns the pseudonym of the person: `asked`, or else the recorded pseudonym."""
        return asked or self.subject or UNNAMED


class _Arrival(Struct):
    """The fields of a line that are needed to find the arrival time of its frame, s."""

    contacts: list[Any] | None = None
    host: float | None = None


def check_new(folder: Path) -> None:
    """Checks that a folder has no session yet.

    Raises:
        RecordingError: The folder has a session.
    """
    if any((folder / name).exists() for name in (TOUCHES, HANDS, ABOUT)):
        raise RecordingError(
            "this folder has a session already, which is not overwritten",
            where=str(folder),
            remedy="Name another folder",
        )


class PairedCaptureWriter(Closeable):
    """Writes a session while it is recorded; a crash loses at most two lines.

    Args:
        folder: Folder that is created; it must not have a session already.
        surface: Surface of the touch device.
        about: Contents of `about.json`: `side`, `subject`, `simulated` and others; JSON values.
        camera: First line of the file of hands if they are landmarks; None with a Leap.

    Attributes:
        touches: Number of touch frames written.
        hands: Number of hand frames written.

    Raises:
        RecordingError: The folder cannot be written to, or has a session.
    """

    def __init__(
        self,
        folder: Path,
        surface: Surface,
        about: dict[str, Any],
        camera: dict[str, Any] | None = None,
    ) -> None:
        self.touches = self.hands = 0
        self._folder, self._about = folder, about
        self._asked: LineFile | None = None
        check_new(folder)
        try:
            folder.mkdir(parents=True, exist_ok=True)
            (folder / ABOUT).write_text(json.dumps(about, indent=1) + "\n", encoding="utf-8")
        except OSError as error:
            raise RecordingError(
                "the folder cannot be written",
                where=str(folder),
                got=str(error),
                remedy="Name another folder",
            ) from None
        self._touches, self._hands = LineFile(folder / TOUCHES), LineFile(folder / HANDS)
        self._touches.write(header_record(surface, str(about.get("touches", "touches"))))
        if camera is not None:
            self._hands.write(camera)

    def touch(self, frame: TouchFrame, host: float) -> None:
        """Writes a frame of the touch device that arrived at `host`, s.

        Raises:
            RecordingError: The frame cannot be written; those before it are on disk.
        """
        self._touches.write(frame_record(frame) | {"host": host})
        self.touches += 1

    def hand(self, frame: HandFrame, host: float) -> None:
        """Writes a frame of the Leap that arrived at `host`, s.

        Raises:
            RecordingError: The frame cannot be written; those before it are on disk.
        """
        self._hands.write(leap_message(frame, self.hands + 1) | {"host": host})
        self.hands += 1

    def picture(self, message: dict[str, Any], host: float) -> None:
        """Writes the landmarks of a picture that arrived at `host`, s.

        Raises:
            RecordingError: The picture cannot be written; those before it are on disk.
        """
        self._hands.write(message | {"host": host})
        self.hands += 1

    def request(self, fingers: Sequence[int], host: float) -> None:
        """Writes the fingers that the guide requests from the time `host` (s) on.

        Raises:
            RecordingError: The line cannot be written.
        """
        if self._asked is None:
            self._asked = LineFile(self._folder / ASKED)
        self._asked.write({"host": host, "asked": list(fingers)})

    def describe(self, **more: Any) -> None:
        """Adds values (JSON) that were found during the session to `about.json`.

        Raises:
            RecordingError: The file cannot be written.
        """
        self._about = self._about | more
        text = json.dumps(self._about, indent=1) + "\n"
        try:
            (self._folder / ABOUT).write_text(text, encoding="utf-8")
        except OSError as error:
            raise RecordingError(
                f"{ABOUT} cannot be written", where=str(self._folder), got=str(error)
            ) from None

    def close(self) -> None:
        """Closes the files; may be called twice."""
        self._touches.close()
        self._hands.close()
        if self._asked is not None:
            self._asked.close()


@dataclass(frozen=True)
class HandsFile:
    """Hand frames of a file.

    Attributes:
        frames: Frames in order.
        time: (n,) s, times on the device's clock.
        host: (n,) s, arrival times; None if they are missing in the file.
        damage: Error that ended the file early; empty if it is undamaged.
        report: Report on left-out data and assumptions.
    """

    frames: tuple[HandFrame, ...]
    time: Array
    host: Array | None
    damage: str
    report: ReaderReport


def read_hands(path: Path, unit: str = "") -> HandsFile:
    """Reads any Leap recording, with the arrival times of its frames if it has them.

    Args:
        path: The file.
        unit: Units that a person gave, such as `cm,ms`.

    Raises:
        RecordingError: The file cannot be read, or has no usable frame.
    """
    recording = read_leap(path, unit)
    arrived = np.array([_number(recording.messages[i].get("host")) for i in recording.used])
    return HandsFile(
        recording.frames,
        np.array([f.time for f in recording.frames]),
        arrived if np.isfinite(arrived).all() else None,
        str(recording.damage) if recording.damage else "",
        recording.report,
    )


def arrivals(path: Path, count: int) -> Array | None:
    """Returns the arrival times (count,) s of the frames in a file of touches; None if missing."""
    host: list[float] = []
    with suppress(RecordingError):
        for number, line in numbered_lines(path, LONGEST_LINE):
            arrival = _arrival(line, f"{path}, line {number}")
            if arrival.contacts is not None:
                host.append(math.nan if arrival.host is None else arrival.host)
    times = np.array(host[:count])
    return times if len(times) == count and np.isfinite(times).all() else None


def picture_arrivals(path: Path, lines: Sequence[int]) -> Array | None:
    """Returns the arrival times (s) of the pictures in lines of a file; None if missing."""
    host: dict[int, float] = {}
    wanted = set(lines)
    with suppress(RecordingError):
        for number, line in numbered_lines(path, LONGEST_LINE):
            if number in wanted:
                arrived = _arrival(line, f"{path}, line {number}").host
                host[number] = math.nan if arrived is None else arrived
    times = np.array(list(host.values()))
    return times if len(times) == len(wanted) and np.isfinite(times).all() else None


class RequestedFingers(Struct):
    """A line of `asked.jsonl`: fingers (thumb 0 to little 4) requested from time `host` (s) on."""

    host: float
    asked: list[int]


def read_requests(folder: Path) -> tuple[RequestedFingers, ...]:
    """Reads the requests of the guide, in order; empty without a guide.

    Raises:
        RecordingError: A line is damaged.
    """
    path = folder / ASKED
    if not path.is_file():
        return ()
    return tuple(
        decoded(
            line,
            RequestedFingers,
            RecordingError,
            what="the line is damaged",
            where=f"{path}, line {number}",
        )
        for number, line in numbered_lines(path, LONGEST_LINE)
    )


def first_line_with_host(path: Path) -> float | None:
    """Arrival time (s) of the first frame in a file; None if the file or the time is missing."""
    if not path.is_file():
        return None
    with suppress(RecordingError):
        for number, line in islice(numbered_lines(path, LONGEST_LINE), 2):
            host = _arrival(line, f"{path}, line {number}").host
            if host is not None:
                return host
    return None


def read_about(folder: Path) -> About:
    """Reads the description of a session.

    Raises:
        RecordingError: The folder has no session, or its description is damaged.
    """
    path = folder / ABOUT
    if not path.exists():
        raise RecordingError(
            "this is not a folder of `sandbox capture record`",
            where=str(folder),
            expected=f"{TOUCHES}, {HANDS} and {ABOUT}",
        )
    data = read_bytes(path, RecordingError, what="the file cannot be read")
    return decoded(
        data,
        About,
        RecordingError,
        what="the description of the session is damaged",
        where=str(path),
        expected='"side": right or left',
    )


def _arrival(line: bytes, where: str) -> _Arrival:
    return decoded(line, _Arrival, RecordingError, what="the line is damaged", where=where)


def _number(value: object) -> float:
    sound = isinstance(value, (int, float)) and not isinstance(value, bool)
    return float(value) if sound and math.isfinite(value) else math.nan  # type: ignore[arg-type]
