"""Simulated user who holds a box and slides it along, with a hand that points along the way."""

from __future__ import annotations

from dataclasses import replace
from math import atan2, pi

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length
from models.objects import Box
from models.surface import Surface
from tasks.simulated_user.grasp import Grasp, grasp_across, wrapped
from tasks.simulated_user.hand import Hand
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.user import SkilledUser
from tasks.user import SeenObject, Sight, UserConfiguration

POINTS = pi / 4
"""rad, from the direction across a box, thumb to fingers, to that in which a hand points. Of eleven
simulated people with thumb, index and middle finger on a screen: 42 degrees, median."""
_STEP = 0.030
"""m that the user slides a box before the next look."""


class PointingHandling(BoxHandling):
    """Handling of a box by those two faces across which the hand points most nearly along the way.

    Attributes:
        way: rad, direction of the way; None until it is seen.
    """

    way: float | None = None

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp with a hand that points along the way."""
        assert isinstance(seen.shape, Box) and self.way is not None
        half = seen.shape.half_size
        wanted = self.way - POINTS
        quarter = min(range(4), key=lambda q: abs(wrapped(seen.yaw + q * pi / 2 - wanted)))
        axis = seen.yaw + quarter * pi / 2
        width, face = (half[0], half[1]) if quarter % 2 == 0 else (half[1], half[0])
        return replace(grasp_across(axis, 2 * width, 2 * face, hand), skew=0.0)


class BooksUser(SkilledUser):
    """Slides a box to its goal in short steps, with a look after each.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
    """

    drags = 12

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._pointing = PointingHandling()
        self._handling = self._pointing

    def _act(self, sight: Sight, now: float) -> None:
        if self._pointing.way is None:
            (goal,) = sight.goals
            x, y = (np.array(goal.position) - sight.objects[goal.object].position)[:2].tolist()
            self._pointing.way = atan2(y, x)
        super()._act(sight, now)

    def _leg(self, sight: Sight, box: SeenObject, off: Array, turn: float) -> tuple[Array, float]:
        """The next part of a straight way."""
        return off * min(1.0, _STEP / max(length(off), 1e-9)), turn
