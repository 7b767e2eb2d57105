"""Sweep twelve dice into a ring."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import cos, pi, sin
from typing import ClassVar

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length, squared_lengths
from models.errors import InputError, SurfaceTooSmallError
from models.message import Message
from models.objects import Box
from models.scene import PaintedRing
from models.surface import Surface
from tasks.clutter.gather_user import GatherUser
from tasks.sensing import Sensing
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import UserMaker

COUNT = 12
EDGE = 0.012
"""m, edge of a die: the small size that is sold, beside that of 16 mm."""
MASS = 0.0021
"""kg, of a die of acrylic glass (1.19 g/cm3) that is sold as 12 mm."""
RADIUS = 0.040
"""m, of the ring: dice fill a third of it, so that they need not be packed."""
BORDER = 0.028
"""m from the surface's border to the nearest die, so that fingertips have room behind it."""
RING_BORDER = 0.055
"""m from the surface's border to the ring's middle."""
APART, OUTSIDE = 0.018, 0.012
"""m, least distances of two dice, and of a die from the ring, at the start: dice do not touch, and
all have to be moved."""
SPEED_TOLERANCE = 0.010
"""m/s."""
IVORY = (0.93, 0.90, 0.82)

_TRIES, _PLACES = 100, 200
"""Number of rings that are drawn until a surface is reported as too small, and of places that are
drawn around each."""


@dataclass(frozen=True)
class Gather(TaskDefaults):
    """Sweep twelve dice into a ring on the table, several at a time.

    Scene: twelve dice of 12 mm, 2.1 g each, anywhere on the table around a ring of 4 cm radius
    that is painted on it; friction 0.5 against the table.
    Goal: all dice in the ring; translucent ones show that there is room for them.
    Success: the middle of every die within the ring, every die slower than 1 cm/s and touched by no
    hand, all for 0.5 s without a break, within 90 s.
    Start: the ring's middle uniform over the surface less a border of 55 mm; dice one after the
    other, uniform over the surface less a border of 28 mm, redrawn until they are 18 mm from each
    other and outside of the ring by 12 mm; yaws uniform.
    History: version 1.
    """

    name: ClassVar[str] = "gather"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 90.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.5
    touch_height: ClassVar[float] = 0.003
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"
    user: ClassVar[UserMaker | None] = GatherUser

    seed: int
    objects: tuple[Box, ...]
    goals: tuple[Goal, ...]
    ring: PaintedRing

    @property
    def painted(self) -> tuple[PaintedRing, ...]:
        """The ring."""
        return (self.ring,)

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Gather:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            SurfaceTooSmallError: The surface has no room for the ring and the dice around it.
        """
        rng = np.random.default_rng([seed, cls.version, 23])
        size = surface.size
        if np.any(size < 2 * RING_BORDER):
            raise _too_small(surface)
        for _ in range(_TRIES):
            middle = rng.uniform(np.full(2, RING_BORDER), size - RING_BORDER)
            dice = _scattered(rng, middle, size)
            if len(dice) == COUNT:
                break
        else:
            raise _too_small(surface)
        yaws = rng.uniform(-pi / 4, pi / 4, COUNT).tolist()
        centre = surface.to_world(middle[None])[0, :2].tolist()
        half = EDGE / 2
        objects = tuple(
            Box(f"die{i + 1}", (half,) * 3, MASS, (*place, half), yaw, IVORY)
            for i, (place, yaw) in enumerate(
                zip(surface.to_world(np.stack(dice))[:, :2].tolist(), yaws, strict=True)
            )
        )
        ring = PaintedRing("ring", (centre[0], centre[1]), RADIUS)
        return cls(seed, objects, _shown(ring), ring)

    def shifted(self) -> tuple[str, ...]:
        """Nothing.

        Raises:
            InputError: Always, with the reason.
        """
        raise InputError(
            "the dice start anywhere around the ring as it is, so that no shift makes it harder",
            where=f"{self.name}, --vary start",
            remedy="Vary something else, such as room",
        )

    def with_room(self, factor: float) -> Gather:
        """The same trial with a ring so much larger or smaller."""
        ring = replace(self.ring, radius=factor * self.ring.radius)
        return replace(self, ring=ring, goals=_shown(ring))

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether all dice are in the ring now."""
        ring = self.ring
        dice = [sensing.object(die.name) for die in self.objects]
        off = np.array([die.position[:2] for die in dice]) - ring.middle
        outside = int(np.sum(squared_lengths(off) > ring.radius**2))
        reason: str = ""
        if outside:
            reason = Message(
                "dice_outside", "{count} of the dice are not in the ring", count=f"{outside}"
            )
        elif any(die.held for die in dice):
            reason = Message("dice_touched", "a hand still touches a die")
        elif max(die.speed for die in dice) > SPEED_TOLERANCE:
            reason = Message("dice_move", "a die is still moving")
        progress = 1.0 if not reason else min(1.0 - outside / len(dice), 0.99)
        return Measure(not reason, progress, reason)


def _scattered(rng: np.random.Generator, middle: Array, size: Array) -> list[Array]:
    """Places (2,) m of dice around a ring; fewer than wanted where there was no room for more.

    Args:
        rng: Source of randomness.
        middle: (2,) m on the surface, of the ring.
        size: (2,) m, of the surface.
    """
    dice: list[Array] = []
    for place in rng.uniform(np.full(2, BORDER), size - BORDER, (_PLACES, 2)):
        apart = [length(place - other) for other in dice]
        if length(place - middle) > RADIUS + OUTSIDE and min(apart, default=1.0) > APART:
            dice.append(place)
    return dice[:COUNT]


def _shown(ring: PaintedRing) -> tuple[Goal, ...]:
    """Places of translucent dice: an outer circle of nine and an inner one of three."""
    goals = []
    for i in range(COUNT):
        share, angle = (0.78, 2 * pi * i / 9) if i < 9 else (0.28, 2 * pi * i / 3)
        x, y = ring.middle
        out = share * ring.radius
        goals.append(
            Goal(f"die{i + 1}", (x + out * cos(angle), y + out * sin(angle), EDGE / 2), angle)
        )
    return tuple(goals)


def _too_small(surface: Surface) -> SurfaceTooSmallError:
    size = surface.width_in, surface.height_in
    return SurfaceTooSmallError(Gather.name, size, "a ring and twelve dice around it", (7.8, 5.9))
