"""Simulated user who stacks boxes on an upright screen, seen from the front.

The user knows common facts: a released box falls, a box has to be lifted over obstacles, and a box
on a table can only be gripped from its sides. They do not see depth.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, sin

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length
from models.objects import Box
from models.surface import Surface
from tasks.goals import flat_yaw
from tasks.simulated_user.grasp import Grasp, grasp_across
from tasks.simulated_user.hand import Hand
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.user import SkilledUser
from tasks.user import SeenObject, Sight, UserConfiguration

_QUARTER = np.pi / 2
_OVER = 0.012
"""m, height above its place at which a box is carried."""
_ASIDE = 0.005
"""m to the side of its place, within which a box is lowered."""
_DOWN = 0.002
"""m above its place at which a box is let go: it stands, or falls a negligible distance."""
_SLIPPED = 0.015
"""m by which a box may fall behind the fingers before the user notes that it slipped."""
_MOVES = 14
"""Corrected movements of one grasp before the user lets go and starts again."""
_OPEN = 0.010
"""m by which each finger leaves a box sideways before it leaves the screen. Without it, the fingers
that lift last would push the box."""


class FrontBoxHandling(BoxHandling):
    """Handling of a box that is gripped from its left and right side."""

    enough = (0.006, float(np.deg2rad(2.0)))

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp with the thumb to the left and the fingers to the right."""
        assert isinstance(seen.shape, Box)
        edge = 2 * seen.shape.half_size[0]
        return grasp_across(roll(seen), edge, edge, hand)


class FrontStacker(SkilledUser):
    """Puts a box on another one in the upright plane of the screen.

    Args:
        configuration: Settings of the simulated user.
        surface: The screen as the user sees it: lying flat (see `FrontView`).
        seed: Seed of the user's randomness.
    """

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._handling = FrontBoxHandling()
        self._opening = False

    def _act(self, sight: Sight, now: float) -> None:
        if self._opening:
            self._opening = False
            super()._let_go(now)
            return
        seen = {name: in_picture(o) for name, o in sight.objects.items()}
        super()._act(replace(sight, objects=seen), now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """Missing shift (2,) m and turn rad from the box as seen to its place, where it stands
        straight."""
        return np.asarray(sight.goals[0].position[:2]) - box.position[:2], -roll(box)

    def _drag(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Moves the box up, across or down, depending on where it is seen."""
        assert self._grasp is not None
        off, turn = self._missing(sight, box)
        held = self._grasp.middle(box) + self._drawn_offset(sight)
        slipped = self._tries > 0 and length(held - self._middle(now)) > _SLIPPED
        there = abs(off[0]) < _ASIDE and abs(off[1]) < _DOWN
        if there or slipped or self._tries >= _MOVES or not sight.solid:
            self._let_go(now)
            return
        self._tries += 1
        shift = off
        if abs(off[0]) > _ASIDE:
            rise = off[1] + _OVER
            # First up, then across; the rest of the way up is made on the way across.
            shift = np.array([0.0 if rise > 0.5 * _OVER else off[0], rise])
        self._watch(self._fingers.carry(shift, turn, self._middle(now), now))

    def _let_go(self, now: float) -> None:
        """Opens the fingers, and lifts them once they are open."""
        places = self._fingers.places(now)
        aside = np.sign(places[:, :1] - self._middle(now)[0]) * [1.0, 0.0]
        self._until = self._fingers.move(places + _OPEN * aside, now)
        self._opening = True


def in_picture(seen: SeenObject) -> SeenObject:
    """A box as it looks from the front: rotated within the picture only."""
    turn = flat_yaw(seen.rotation)
    c, s = cos(turn), sin(turn)
    return replace(seen, rotation=np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))


def roll(seen: SeenObject) -> float:
    """A box's least rotation in the picture, in rad, from standing on a face; signed."""
    return float((seen.yaw + _QUARTER / 2) % _QUARTER - _QUARTER / 2)
