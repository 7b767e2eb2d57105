"""Values in TUIO messages, checked one by one: what every version of the protocol has in common."""

from __future__ import annotations

import math
from collections.abc import Sized
from dataclasses import dataclass, field
from typing import NamedTuple

from sandbox.devices.tuio.osc import MalformedPacket

MAX_IDS = 64
"""Living touches of one source. More than a room full of hands; bounds our memory."""

MAX_FRAMES = 16
"""Frames of one packet. Honest senders put one into each; bounds the work of a packet."""

LOWEST, HIGHEST = -0.1, 1.1
"""Where a position may lie, in widths of the surface: sensors see a little beyond their edge."""

_SINGLE_PRECISION = 1e-6
"""Positions travel as 32-bit floats, in which 1.1 is a little more than 1.1."""

MAX_NAME = 200
"""Characters of a source's name."""


class Place(NamedTuple):
    """Where a touch is and how large, in 0..1 of the surface's width and height.

    `label` is the finger, 0 (thumb) to 4, where the sender knows it.
    """

    x: float
    y: float
    width: float | None = None
    height: float | None = None
    label: int | None = None


@dataclass(slots=True)
class Frame:
    """What the messages of one frame say; None is "not said".

    Attributes:
        source: Name of the sender.
        profile: What it is about: an address such as `/tuio/2Dcur`.
        alive: Ids of all living touches.
        places: Of the touches that have changed.
        number: The frame's counter.
        sizes: Width and height that came apart from the places, by id.
    """

    source: str | None
    profile: str
    alive: tuple[int, ...] | None = None
    places: dict[int, Place] = field(default_factory=dict)
    number: int | None = None
    sizes: dict[int, tuple[float, float]] = field(default_factory=dict)

    def take(self, later: Frame) -> None:
        """Adds what a later part of the same frame says."""
        self.alive = self.alive if later.alive is None else later.alive
        for touch, place in later.places.items():
            self.places.pop(touch, None)
            self.places[touch] = place
        self.sizes |= later.sizes
        self.number = later.number

    def forget_the_first(self) -> None:
        """Keeps no more than `MAX_IDS` touches, for senders that never close a frame."""
        for kept in (self.places, self.sizes):
            while len(kept) > MAX_IDS:
                del kept[next(iter(kept))]


def read_int32(value: object, where: str) -> int:
    """A whole number of 32 bits.

    Raises:
        MalformedPacket: It is none.
    """
    if isinstance(value, bool) or not isinstance(value, int) or not -(2**31) <= value < 2**31:
        raise MalformedPacket(
            "a whole number is missing", where=where, got=short(value), expected="an int32"
        )
    return value


def read_coordinate(value: object, where: str) -> float:
    """A position on the surface, moved to 0..1 where it lies in the margin.

    Raises:
        MalformedPacket: It is no number, or not even near the surface.
    """
    number = value if isinstance(value, int | float) and not isinstance(value, bool) else math.nan
    slack = _SINGLE_PRECISION
    if not LOWEST - slack <= number <= HIGHEST + slack:  # false for what is not a number, too
        raise MalformedPacket(
            "a position is not on the surface",
            where=where,
            got=short(value),
            expected=f"{LOWEST} to {HIGHEST}",
        )
    return min(max(float(number), 0.0), 1.0)


def read_size(value: object) -> float | None:
    """A length in 0..1, None where the sender measures none or it makes no sense."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value <= 1.0:
        return None
    return float(value)


def read_name(name: object) -> str:
    """The name of a source.

    Raises:
        MalformedPacket: It is no short printable text.
    """
    if not isinstance(name, str) or len(name) > MAX_NAME or not name.isprintable():
        raise MalformedPacket(
            "the name of a source must be a short printable text", got=short(name)
        )
    return name


def check_count(touches: Sized) -> None:
    """Refuses a frame of too many touches.

    Raises:
        MalformedPacket: It is one.
    """
    if len(touches) > MAX_IDS:
        raise MalformedPacket(
            "a frame has too many touches", got=len(touches), expected=f"{MAX_IDS} at most"
        )


def check_frames(frames: Sized) -> None:
    """Refuses a packet of too many frames.

    Raises:
        MalformedPacket: It is one.
    """
    if len(frames) > MAX_FRAMES:
        raise MalformedPacket(
            "a packet has too many frames", got=len(frames), expected=f"{MAX_FRAMES} at most"
        )


def short(value: object) -> object:
    """The value as an error message may show it."""
    return value if value is None or isinstance(value, int | float) else str(value)[:60]
