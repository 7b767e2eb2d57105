"""Files of landmarks, by `sandbox devices webcam record`: a header, then one picture a line.

    {"landmarks": 1, "camera": {"view": 60.0, ...}, "hand_size": 1.0}
    {"time": s, "taken": s, "size": [px, px], "seen": [{"side", "score", "image", "world"}]}

The file is recognised by its first line, whatever its name.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import msgspec

from encoders.webcam.camera import Camera
from models.errors import InputError, RecordingError
from models.frames import LandmarkFrame
from models.json_input import decoded, numbered_lines
from sandbox.devices.device import LandmarkDevice
from sandbox.devices.webcam.landmarks_json import frame_of, picture_message

VERSION = 1
LONGEST_LINE = 1 << 16
"""Bytes; four hands have about five thousand."""


class Header(msgspec.Struct):
    """The first line.

    Attributes:
        landmarks: Version of the format.
        camera: The camera that took the pictures; None if nobody said.
    """

    landmarks: int
    camera: Camera | None = None


@dataclass(frozen=True)
class LandmarkRecording:
    """The pictures of a file.

    Attributes:
        frames: In order of time.
        camera: The camera that took them; None if the file does not say.
        damage: Error that ended the file early; None if it is undamaged.
    """

    frames: tuple[LandmarkFrame, ...]
    camera: Camera | None
    damage: RecordingError | None = None


def header_record(camera: Camera) -> dict[str, Any]:
    """JSON values of a file's first line."""
    return {"landmarks": VERSION, "camera": asdict(camera)}


def is_landmark_file(path: Path) -> bool:
    """True if a file's first line is that of a file of landmarks; the rest may be damaged."""
    try:
        with path.open("rb") as file:
            line = file.readline(LONGEST_LINE)
    except OSError:
        return False
    try:
        values = msgspec.json.decode(line)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return False
    return isinstance(values, dict) and "landmarks" in values


def read_landmarks(path: Path) -> LandmarkRecording:
    """Reads a file up to its end or to the first damaged line.

    Raises:
        RecordingError: It cannot be read, or has no picture before the damage.
        InputError: Its camera is impossible.
    """
    frames: list[LandmarkFrame] = []
    header: Header | None = None
    damage: RecordingError | None = None
    try:
        for number, line in numbered_lines(path, LONGEST_LINE):
            where = f"{path}, line {number}"
            if header is None:
                header = _header(line, where)
                continue
            try:
                frame = replace(frame_of(picture_message(line, where), where), source="file")
                if frames and frame.taken < frames[-1].taken:
                    raise InputError("the time runs backwards", where=where, got=frame.taken)
            except InputError as error:
                damage = RecordingError(
                    f"the recording is damaged: {error.what}",
                    where=where,
                    got=None if error.got is None else str(error.got)[:40],
                    expected=error.expected,
                    remedy="The pictures before it are played" if frames else None,
                )
                break
            frames.append(frame)
    except OSError as error:
        raise RecordingError("cannot be read", where=str(path), got=error.strerror) from None
    if not frames:
        raise damage or RecordingError("the file contains no pictures", where=str(path))
    return LandmarkRecording(tuple(frames), header.camera if header else None, damage)


def _header(line: bytes, where: str) -> Header:
    header = decoded(
        line,
        Header,
        RecordingError,
        what="this is not a file of landmarks",
        where=where,
        expected=f'{{"landmarks": {VERSION}, "camera": {{...}}}}',
    )
    if header.landmarks != VERSION:
        raise RecordingError(
            "another version of the format",
            where=where,
            got=header.landmarks,
            expected=str(VERSION),
        )
    return header


class LandmarkFileDevice(LandmarkDevice):
    """Plays a recording of landmarks; its first picture plays at session time 0.

    Args:
        recording: A recording from `read_landmarks`.

    Attributes:
        camera: The camera that took it; None if the recording does not say.
    """

    name = "landmark recording"
    lift = True
    plays_file = True
    damage: Exception | None

    def __init__(self, recording: LandmarkRecording) -> None:
        start = recording.frames[0].taken
        self._frames = [
            replace(f, time=f.taken - start, taken=f.taken - start) for f in recording.frames
        ]
        self.damage, self.camera = recording.damage, recording.camera
        self._next = 0

    @property
    def finished(self) -> bool:
        """True after the last picture."""
        return self._next >= len(self._frames)

    def poll(self, now: float) -> Sequence[LandmarkFrame]:
        """The pictures due by `now`, oldest first."""
        first = self._next
        while not self.finished and self._frames[self._next].time <= now:
            self._next += 1
        return self._frames[first : self._next]

    def close(self) -> None:
        """Ends playback."""
        self._next = len(self._frames)
