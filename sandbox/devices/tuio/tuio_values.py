"""Checks of the values in TUIO messages that all versions of the protocol share."""

from __future__ import annotations

import math
from collections.abc import Sized
from dataclasses import dataclass, field
from typing import NamedTuple

from sandbox.devices.tuio.osc import MalformedPacket

MAX_IDS = 64
"""Largest number of living touches of one source; bounds memory."""

MAX_FRAMES = 16
"""Largest number of frames in a packet; regular senders use one. Bounds the work per packet."""

LOWEST, HIGHEST = -0.1, 1.1
"""Range of valid positions, in widths of the surface: sensors see a little beyond their edge."""

SMALLEST = 1e-6
"""Smallest length of a touch, in widths of the surface. Smaller ones are no finger's, and become 0
in metres."""

_SINGLE_PRECISION = 1e-6
"""Tolerance of positions, which are 32-bit floats, where 1.1 is slightly larger."""

MAX_NAME = 200
"""Largest number of characters in a source's name."""


class TuioPlace(NamedTuple):
    """Position and size of a touch, in 0..1 of the surface's width and height.

    `label` is the finger, 0 (thumb) to 4; None if the sender does not know it.
    """

    x: float
    y: float
    width: float | None = None
    height: float | None = None
    label: int | None = None


@dataclass(slots=True)
class TuioFrame:
    """Values from the messages of one frame; None for a value that was not sent.

    Attributes:
        source: Name of the sender.
        profile: Address of the profile, such as `/tuio/2Dcur`.
        alive: Ids of all living touches.
        places: Positions of the touches that have changed, by id.
        number: Number of the frame.
        sizes: Widths and heights that were sent apart from the positions, by id.
    """

    source: str | None
    profile: str
    alive: tuple[int, ...] | None = None
    places: dict[int, TuioPlace] = field(default_factory=dict)
    number: int | None = None
    sizes: dict[int, tuple[float, float]] = field(default_factory=dict)

    def take(self, later: TuioFrame) -> None:
        """Adds the values of a later part of the same frame."""
        self.alive = self.alive if later.alive is None else later.alive
        for touch, place in later.places.items():
            self.places.pop(touch, None)
            self.places[touch] = place
        self.sizes |= later.sizes
        self.number = later.number

    def forget_the_first(self) -> None:
        """Removes the oldest touches beyond `MAX_IDS`, for senders that never close a frame."""
        for kept in (self.places, self.sizes):
            while len(kept) > MAX_IDS:
                del kept[next(iter(kept))]


def read_int32(value: object, where: str) -> int:
    """Checks a 32-bit integer.

    Raises:
        MalformedPacket: The value is not one.
    """
    if isinstance(value, bool) or not isinstance(value, int) or not -(2**31) <= value < 2**31:
        raise MalformedPacket(
            "a value must be an integer", where=where, got=short(value), expected="an int32"
        )
    return value


def read_coordinate(value: object, where: str) -> float:
    """Checks a coordinate on the surface, and clips it to 0..1 if it lies in the margin.

    Raises:
        MalformedPacket: The value is not a number, or lies beyond the margin.
    """
    number = value if isinstance(value, int | float) and not isinstance(value, bool) else math.nan
    slack = _SINGLE_PRECISION
    if not LOWEST - slack <= number <= HIGHEST + slack:  # also true for NaN
        raise MalformedPacket(
            "a position is not on the surface",
            where=where,
            got=short(value),
            expected=f"{LOWEST} to {HIGHEST}",
        )
    return min(max(float(number), 0.0), 1.0)


def read_size(value: object) -> float | None:
    """A length in 0..1; None if the value is not a valid length, or too small for any finger."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value) if SMALLEST <= value <= 1.0 else None


def read_name(name: object) -> str:
    """Checks the name of a source.

    Raises:
        MalformedPacket: The value is not a short printable text.
    """
    if not isinstance(name, str) or len(name) > MAX_NAME or not name.isprintable():
        raise MalformedPacket(
            "the name of a source must be a short printable text", got=short(name)
        )
    return name


def check_count(touches: Sized) -> None:
    """Checks the number of touches in a frame.

    Raises:
        MalformedPacket: The frame has too many touches.
    """
    if len(touches) > MAX_IDS:
        raise MalformedPacket(
            "a frame has too many touches", got=len(touches), expected=f"{MAX_IDS} at most"
        )


def check_frames(frames: Sized) -> None:
    """Checks the number of frames in a packet.

    Raises:
        MalformedPacket: The packet has too many frames.
    """
    if len(frames) > MAX_FRAMES:
        raise MalformedPacket(
            "a packet has too many frames", got=len(frames), expected=f"{MAX_FRAMES} at most"
        )


def short(value: object) -> object:
    """The value as an error message may show it."""
    return value if value is None or isinstance(value, int | float) else str(value)[:60]
