"""Landmarks of hands in pictures as JSON: messages of the page, and files of them that play as a
camera.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any, Literal

import msgspec

from encoders.webcam.camera import Camera
from models.errors import DeviceError, FrameError, InputError, RecordingError
from models.frames import LandmarkFrame, SeenHand
from models.json_input import decoded, numbered_lines
from sandbox.devices.device import LandmarkDevice

SOURCE = "webcam"
MOST_SEEN = 4
"""Largest number of hands in a message; the page looks for three."""
_LARGEST = 1e5
"""Largest coordinate in pixels, or size of a picture; anything beyond is nonsense."""

Point = tuple[float, float]
Vector = tuple[float, float, float]
Trouble = Literal["absent", "in use", "refused", "engine", "hidden"]


class HandMessage(msgspec.Struct):
    """A hand in a picture, as `models.frames.SeenHand` describes it."""

    side: Literal["right", "left"]
    score: float
    image: list[Point]
    world: list[Vector]


class PictureMessage(msgspec.Struct):
    """What was seen in a picture (`models.frames.LandmarkFrame`), or why there is none.

    Attributes:
        time: s, when the page had found the hands, on its own clock; None for a trouble.
        taken: s, when the picture was taken, on the same clock; without it, `time`.
        size: Width and height of the picture in pixels.
        seen: Hands in the picture.
        trouble: Why there is no picture; None with one.
        corners: px, a surface's corners that the person marked: top left, top right, bottom right,
            bottom left; None in other messages.
    """

    time: float | None = None
    taken: float | None = None
    size: tuple[int, int] = (640, 480)
    seen: list[HandMessage] = []
    trouble: Trouble | None = None
    corners: tuple[Point, Point, Point, Point] | None = None


def picture_message(text: bytes | str, where: str = SOURCE) -> PictureMessage:
    """Reads a message of the page, or a line of a file.

    Raises:
        DeviceError: It is neither a picture nor a trouble.
    """
    message = decoded(
        text.encode() if isinstance(text, str) else text,
        PictureMessage,
        DeviceError,
        what="these are not landmarks",
        where=where,
        expected='{"time": s, "size": [px, px], "seen": [...]}',
    )
    if message.time is None and message.trouble is None and message.corners is None:
        raise DeviceError("the picture has no time", where=where)
    return message


def frame_of(message: PictureMessage, where: str = SOURCE) -> LandmarkFrame:
    """The frame of a picture.

    Raises:
        FrameError: Its numbers are not valid for a frame.
    """
    if message.time is None:
        raise FrameError("this is not a picture", where=where, got=message.trouble)
    if len(message.seen) > MOST_SEEN:
        raise FrameError("too many hands", where=where, got=len(message.seen))
    for hand in message.seen:
        far = max((abs(c) for p in hand.image for c in p), default=0.0)
        if not far <= _LARGEST:
            raise FrameError("a landmark is too far away", where=where, got=far, expected="pixels")
    if max(message.size) > _LARGEST:
        raise FrameError("the picture is too large", where=where, got=message.size)
    taken = message.time if message.taken is None else message.taken
    if not math.isfinite(taken):
        raise FrameError("a picture's time must be finite", where=where, got=taken)
    hands = tuple(SeenHand(h.side, h.score, tuple(h.image), tuple(h.world)) for h in message.seen)
    return LandmarkFrame(message.time, hands, message.size, taken, SOURCE)


def message_of(frame: LandmarkFrame) -> dict[str, Any]:
    """JSON values of a frame, which `picture_message` and `frame_of` read back exactly."""
    return {
        "time": frame.time,
        "taken": frame.taken,
        "size": frame.size,
        "seen": [
            {"side": h.side, "score": h.score, "image": h.image, "world": h.world}
            for h in frame.hands
        ],
    }


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
