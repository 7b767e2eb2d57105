"""Simulated user at one half of a case: the one at the cap pushes, the other one holds."""

from __future__ import annotations

from dataclasses import replace
from math import pi, radians

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length
from models.mechanisms.mechanism import Part
from models.objects import Box
from models.surface import Surface
from tasks.simulated_user.grasp import Grasp, grasp_across, wrapped
from tasks.simulated_user.hand import Hand
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.user import SkilledUser
from tasks.user import SeenObject, Sight, UserConfiguration

SHUT = 0.001
"""m between the rims, from which on the user lets go."""
_HELD = 0.6
"""Share of a half from its rim to where it is held."""
_STEP, _FARTHER = 0.008, 0.002
"""m that the user pushes before the next look, at most, and beyond the rim."""
_FIRST = 1.0
"""s that the user leaves to the other one to grasp, also when the other half has given way."""
_YIELDS = 0.002
"""m by which the other half moves under a push before the user waits for who should hold it."""
_SLIPPED = 0.015
"""m by which a half may lag behind the fingers before it counts as slipped."""
_PATIENCE = 12.0
"""s that the user holds a half before letting go to start again."""
_LOOK = 0.10
"""s between two looks while waiting."""


class HalfHandling(BoxHandling):
    """Handling of half a case: grasped across, with the thumb on the more comfortable side."""

    enough = (SHUT, radians(90.0))

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp with the thumb on one long side and the fingers on the other."""
        assert isinstance(seen.shape, Box)
        along, across, _ = seen.shape.half_size
        sides = [seen.yaw + side for side in (pi / 2, -pi / 2)]
        axis = min(sides, key=lambda a: abs(wrapped(a - hand.natural_axis)))
        return grasp_across(axis, 2 * across, 2 * along, hand)


class CaseUser(SkilledUser):
    """Takes the half of a case that is nearer to the middle of their tablet.

    The two users do not communicate: who pushes sees whether the other half gives way.

    Args:
        configuration: Settings of the simulated user.
        surface: The user's tablet.
        seed: Seed of the user's randomness.
    """

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._handling = HalfHandling()
        self._home = surface.to_world(surface.size / 2)[:2]
        self._mine = ""
        self._seen: tuple[SeenObject, SeenObject] | None = None
        self._since: float | None = None
        self._before: Array | None = None
        self._ready = 0.0

    def _act(self, sight: Sight, now: float) -> None:
        cap = sight.goals[0].object
        (first, second) = sight.objects.items()
        if not self._mine:
            far = [
                length(_place(a[1], b[1]) - self._home)
                for a, b in ((first, second), (second, first))
            ]
            self._mine = first[0] if far[0] < far[1] else second[0]
        mine, other = (first[1], second[1]) if self._mine == first[0] else (second[1], first[1])
        self._seen = mine, other
        super()._act(replace(sight, objects={cap: _as_box(mine, other)}), now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """The way (2,) m to the other half's rim, and no turn."""
        assert self._seen is not None
        mine, other = self._seen
        return np.asarray(other.position[:2] - mine.position[:2]), 0.0

    def _reach(self, sight: Sight, box: SeenObject, now: float) -> None:
        self._since, self._before = None, None
        super()._reach(sight, box, now)

    def _drag(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Holds the half, or pushes it towards the other one in steps."""
        assert self._grasp is not None and self._seen is not None
        off, _ = self._missing(sight, box)
        gap = length(off)
        if self._since is None:
            self._since = now
        held = self._grasp.middle(box) + self._drawn_offset(sight)
        slipped = length(held - self._middle(now)) > _SLIPPED
        tired = now - self._since > _PATIENCE
        if gap < SHUT or slipped or tired or not sight.solid:
            self._let_go(now)
            return
        goal, there = sight.goals[0], self._seen[1].position[:2]
        gives_way = self._before is not None and length(there - self._before) > _YIELDS
        self._before = np.array(there)
        if gives_way:
            self._ready = now + _FIRST
        if self._mine != goal.object or now < max(self._since + _FIRST, self._ready):
            self._wait(_LOOK, now)
            return
        ahead = min(gap + _FARTHER, _STEP) / gap
        self._watch(self._fingers.carry(ahead * off, 0.0, np.array(box.position[:2]), now))


def _place(mine: SeenObject, other: SeenObject) -> Array:
    """Place (2,) m where a half is held: away from the rim of the other one."""
    assert isinstance(mine.shape, Part)
    low, high = mine.shape.bounds
    away = np.asarray((mine.position - other.position)[:2])
    out = _HELD * float(high[0] - low[0]) / max(length(away), 1e-9)
    return np.asarray(mine.position[:2] + out * away)


def _as_box(mine: SeenObject, other: SeenObject) -> SeenObject:
    """A half as a box with its middle where it is held, as long as there is room on either side."""
    assert isinstance(mine.shape, Part)
    low, high = mine.shape.bounds
    x, y = _place(mine, other).tolist()
    z = float(mine.position[2])
    room = (1.0 - _HELD) * float(high[0] - low[0])
    box = Box("half", (room, float(high[1]), float(high[2])), mine.shape.mass, (x, y, z))
    return SeenObject(box, np.array([x, y, z]), mine.rotation)
