"""Simulated user who turns a knob: grasps it around its rim, turns as far as the wrist goes, lets
go, and grasps again."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, pi, radians, sin

import numpy as np

from models.arithmetic.arrays import Array
from models.mechanisms.mechanism import Part
from tasks.goals import Goal
from tasks.simulated_user.grasp import Grasp, wrapped
from tasks.simulated_user.hand import Hand
from tasks.simulated_user.user import SkilledUser
from tasks.user import SeenObject, Sight

WRIST = radians(60.0)
"""rad from the natural axis, to either side, to which the hand turns: most of what wrist and
forearm allow with the fingers on a table; assumed."""
SPAN = radians(60.0)
"""rad along the rim from the middle finger to the outermost one, at most."""

_TIP_RADIUS = 0.007
"""m, radius of a fingertip as the user assumes it."""
_QUARTER = pi / 2


@dataclass(frozen=True)
class KnobGrasp(Grasp):
    """A grasp around a round thing: the thumb opposite the fingers, all on one circle."""

    def places(self, centre: Array, gap: float, hand: Hand) -> Array:
        """Positions (fingers, 2) m of the fingertips, thumb first; see `Grasp.places`."""
        radius = self.width / 2 + _TIP_RADIUS
        angles = [self.axis + pi]
        # Index first: with the thumb to the lower left, the index is the leftmost finger.
        angles += [self.axis - float(x) / radius for x in hand.row(self.fingers)[:, 0]]
        out = radius + gap
        return np.array(
            [[centre[0] + out * cos(angle), centre[1] + out * sin(angle)] for angle in angles]
        )


class KnobHandling:
    """Handling of a knob: turned about its middle, which stays.

    Args:
        knob: Its shape.
    """

    good = (0.003, radians(2.0))
    enough = (0.007, radians(3.5))
    patience = 8

    def __init__(self, knob: Part) -> None:
        low, high = knob.bounds
        self._width = float(high[0] - low[0])

    def missing(self, seen: SeenObject, goal: Goal) -> tuple[Array, float]:
        """The shorter turn to the goal, whatever the end stops."""
        return np.zeros(2), wrapped(goal.yaw - seen.yaw)

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp from which the wrist turns as far as the turn needs, or as far as it goes."""
        natural = hand.natural_axis
        axis = natural - float(np.clip(turn / 2, -WRIST, WRIST))
        radius = self._width / 2 + _TIP_RADIUS
        fingers = hand.within(2 * SPAN * radius)
        return KnobGrasp(axis, self._width, fingers, side=axis - seen.yaw)

    def pivot(self, seen: SeenObject) -> Array:
        """The middle of the knob."""
        return np.array(seen.position[:2])

    def reach(self, seen: SeenObject, grasp: Grasp, turn: float, hand: Hand) -> float:
        """Part of the turn that the wrist allows."""
        now = wrapped(grasp.axis_on(seen.yaw) - hand.natural_axis)
        low, high = min(-WRIST, now), max(WRIST, now)
        return float(np.clip(now + turn, low, high) - now)


class DialUser(SkilledUser):
    """Turns the knob the way that its scale goes, with as many grasps as that takes."""

    def _act(self, sight: Sight, now: float) -> None:
        shape = sight.objects[sight.goals[0].object].shape
        if self._handling is None and isinstance(shape, Part):
            self._handling = KnobHandling(shape)
        super()._act(sight, now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """No shift, and the turn (rad) that does not cross the gap of the scale."""
        assert isinstance(box.shape, Part) and box.shape.carrier is not None
        plate = sight.objects[box.shape.carrier]
        # The pointer is the knob's y axis, and the middle of the scale is the plate's.
        middle = _direction(plate)
        pointer = wrapped(_direction(box) - middle)
        mark = wrapped(sight.goals[0].yaw + _QUARTER - middle)
        return np.zeros(2), mark - pointer


def _direction(seen: SeenObject) -> float:
    """Direction in rad of a thing's y axis, seen from above."""
    return atan2(seen.rotation[1, 1], seen.rotation[0, 1])
