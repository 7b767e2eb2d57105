"""A person who stacks boxes in a picture that they see from the front: up the screen is up.

They know what everybody knows: what is let go falls, a box has to be lifted over what is in its
way, and on a table it can only be gripped from its sides. What is nearer or farther they do not
see.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from models.objects import Box
from models.surface import Surface
from tasks.goals import flat_yaw
from tasks.simulated_user.grasp import Grasp
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.user import SkilledUser
from tasks.user import SeenObject, Sight, UserConfiguration

Array = NDArray[np.float64]

_QUARTER = np.pi / 2
_OVER = 0.012
"""m, how high above its place a box is carried there."""
_ASIDE = 0.005
"""m to the side of its place, from which on a box is lowered."""
_DOWN = 0.002
"""m above its place at which a box is let go: it stands, or falls no distance that matters."""
_SLIPPED = 0.015
"""m by which a box may fall behind the fingers before the user notes that it slipped."""
_MOVES = 14
"""Corrected movements of one grasp before the user lets go and looks afresh."""
_OPEN = 0.010
"""m by which each finger leaves a box sideways before it leaves the screen, for a box that is left
by one finger after another is pushed by those that stay."""


class FrontBoxHandling(BoxHandling):
    """A box is gripped from its sides, whichever of its faces they are."""

    enough = (0.006, float(np.deg2rad(2.0)))

    def grasp(
        self, seen: SeenObject, turn: float, c: UserConfiguration, failed: Grasp | None = None
    ) -> Grasp:
        """Thumb to the left, fingers to the right."""
        assert isinstance(seen.shape, Box)
        edge = 2 * seen.shape.half_size[0]
        return Grasp(roll(seen), edge, edge)


class FrontStacker(SkilledUser):
    """Puts a box on another one in the upright plane of the screen.

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
        seen = {name: in_picture(o) for name, o in sight.objects.items()}
        super()._act(replace(sight, objects=seen), now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """Shift (2,) and turn from the box as seen to its place, where it stands straight."""
        return np.asarray(sight.goals[0].position[:2]) - box.position[:2], -roll(box)

    def _drag(self, sight: Sight, box: SeenObject, now: float) -> None:
        """Up, across and down, as what is seen asks for it."""
        assert self._grasp is not None
        off, turn = self._missing(sight, box)
        held = self._grasp.middle(box) + self._drawn_offset(sight, now)
        slipped = self._tries > 0 and np.linalg.norm(held - self._middle(now)) > _SLIPPED
        there = abs(off[0]) < _ASIDE and abs(off[1]) < _DOWN
        if there or slipped or self._tries >= _MOVES or not sight.solid:
            self._let_go(now)
            return
        self._tries += 1
        shift = off
        if abs(off[0]) > _ASIDE:
            rise = off[1] + _OVER
            # First up, then across; what is left of the way up is made on the way across.
            shift = np.array([0.0 if rise > 0.5 * _OVER else off[0], rise])
        self._watch(self._fingers.carry(shift, turn, self._middle(now), now))

    def _let_go(self, now: float) -> None:
        """Opens the fingers; once they are open they leave the screen."""
        places = self._fingers.places(now)
        aside = np.sign(places[:, :1] - self._middle(now)[0]) * [1.0, 0.0]
        self._until = self._fingers.move(places + _OPEN * aside, now)
        self._opening = True


def in_picture(seen: SeenObject) -> SeenObject:
    """A box as it looks from the front: turned within the picture only."""
    turn = flat_yaw(seen.rotation)
    c, s = np.cos(turn), np.sin(turn)
    return replace(seen, rotation=np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))


def roll(seen: SeenObject) -> float:
    """rad, a box's least turn in the picture against standing on a face, either way."""
    return float((seen.yaw + _QUARTER / 2) % _QUARTER - _QUARTER / 2)
