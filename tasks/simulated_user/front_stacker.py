"""A person who stacks boxes in a picture that they see from the front: up the screen is up.

They know what everybody knows: a box that is let go falls, it has to be lifted over what is in its
way, and on a table it can only be gripped from its sides. What is nearer or farther they do not see.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from models.objects import Box
from models.surface import Surface
from tasks.simulated_user.configuration import UserConfiguration
from tasks.simulated_user.grasp import Grasp
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.sight import SeenObject, Sight
from tasks.simulated_user.user import SkilledUser

Array = NDArray[np.float64]

_QUARTER = np.pi / 2
_OVER = 0.012
"""m, how high over what it is to stand on a box is carried."""
_ASIDE = 0.005
"""m beside its place, from which on a box is no more lifted but lowered."""
_DOWN = 0.002
"""m above its place, at which a box is let go: it stands, or falls no distance that matters."""


class FrontBoxHandling(BoxHandling):
    """A box is gripped from its sides, whichever of its faces they are."""

    enough = (0.006, float(np.deg2rad(2.0)))

    def grasp(
        self, seen: SeenObject, turn: float, c: UserConfiguration, failed: Grasp | None = None
    ) -> Grasp:
        """Thumb to the left, fingers to the right."""
        half = _half(seen)
        return Grasp(roll(seen), 2 * half, 2 * half)


class FrontStacker(SkilledUser):
    """Puts boxes on each other in the upright plane of the screen.

    Args:
        configuration: What kind of person.
        surface: The screen as it is seen: lying flat (see `FrontView`).
        seed: Of everything this person does by chance.
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
        super()._act(sight, now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """Shift (2,) and turn from the box as seen to where it belongs, upright."""
        return np.asarray(sight.goals[0].position[:2]) - box.position[:2], -roll(box)

    def _drag(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Up, across and down, as what is seen asks for it."""
        assert self._grasp is not None
        off, turn = self._missing(sight, box)
        held = self._grasp.middle(box) + self._drawn_offset(sight, now)
        slipped = self._tries > 0 and np.linalg.norm(held - self._middle(now)) > 0.015
        there = abs(off[0]) < _ASIDE and abs(off[1]) < _DOWN
        if there or slipped or self._tries >= 14 or not sight.solid:
            self._let_go(now)
            return
        self._tries += 1
        shift = off
        if abs(off[0]) > _ASIDE:
            rise = off[1] + _OVER
            shift = np.array([0.0, rise]) if rise > 0.5 * _OVER else np.array([off[0], rise])
        self._watch(self._fingers.carry(shift, turn, self._middle(now), now))

    def _let_go(self, now: float) -> None:
        """Opens the fingers, and lifts them when they are open."""
        places = self._fingers.places(now)
        middle = self._middle(now)
        away = places - middle
        away[:, 1] = 0.0
        wider = places + 0.010 * np.sign(away)
        self._until = self._fingers.move(wider, now)
        self._opening = True


def roll(seen: SeenObject) -> float:
    """rad, a box's least turn in the picture against standing on a face, either way."""
    return float((seen.yaw + _QUARTER / 2) % _QUARTER - _QUARTER / 2)


def _half(seen: SeenObject) -> float:
    assert isinstance(seen.shape, Box)
    return seen.shape.half_size[0]
