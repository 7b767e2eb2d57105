"""Messages of the camera's page as frames: the same JSON in a session and in a recorded file."""

from __future__ import annotations

import math
from typing import Any, Literal

import msgspec

from models.errors import DeviceError, FrameError
from models.frames import LandmarkFrame, SeenHand
from models.json_input import decoded

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
