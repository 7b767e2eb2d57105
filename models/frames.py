"""Touch frames: all contacts of one device at one moment."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from models.errors import FrameError

FINGERS = ("thumb", "index", "middle", "ring", "little")
"""Finger names by label; a label is an index into this tuple."""


@dataclass(frozen=True, slots=True)
class Contact:
    """One finger on the surface.

    Attributes:
        id: Lives from touch-down to touch-up; unique among the contacts of one frame.
        x: Surface position, metres to the right of the top left corner.
        y: Surface position, metres down from the top left corner.
        size: Contact diameter in metres, where the device measures one.
        label: Finger (thumb 0 .. little 4), where the *device* knows it; None otherwise.
    """

    id: int
    x: float
    y: float
    size: float | None = None
    label: int | None = None

    def __post_init__(self) -> None:
        if not (math.isfinite(self.x) and math.isfinite(self.y)):
            raise FrameError(
                "a contact's position must be finite",
                where=f"contact {self.id}",
                got=(self.x, self.y),
                expected="metres on the surface",
            )
        if self.label is not None and self.label not in range(len(FINGERS)):
            raise FrameError(
                "no such finger", where=f"contact {self.id}", got=self.label, expected="0 to 4"
            )


@dataclass(frozen=True, slots=True)
class TouchFrame:
    """All contacts of one device at one moment.

    Attributes:
        time: Seconds on the device's own monotonic clock.
        contacts: The contacts that are down, in any order; ids are unique.
        lift: Position of the device's lift control, 0 (down) to 1, or None where it has none.
        cancelled: Ids that left since the last frame because the system took them away. They
            were not lifted by the person, so nothing is to be let go of because of them.
        source: Name of the sender, for messages and logs.
    """

    time: float
    contacts: tuple[Contact, ...] = ()
    lift: float | None = None
    cancelled: frozenset[int] = field(default_factory=frozenset)
    source: str = ""

    def __post_init__(self) -> None:
        if not math.isfinite(self.time):
            raise FrameError("a frame's time must be finite", got=self.time, expected="seconds")
        ids = [c.id for c in self.contacts]
        if len(set(ids)) != len(ids):
            raise FrameError(
                "two contacts of one frame share an id", got=sorted(ids), expected="unique ids"
            )
        if self.lift is not None and not 0.0 <= self.lift <= 1.0:
            raise FrameError("the lift control is out of range", got=self.lift, expected="0 to 1")
