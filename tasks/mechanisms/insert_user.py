"""Simulated user who brings a peg before its socket, lines it up, and pushes it in."""

from __future__ import annotations

from math import cos, pi, radians, sin
from typing import NamedTuple

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length, small_product
from models.mechanisms.mechanism import Part
from models.objects import Box
from models.surface import Surface
from tasks.simulated_user.grasp import Grasp, wrapped
from tasks.simulated_user.hand import Hand
from tasks.simulated_user.user import SkilledUser
from tasks.task import Goal
from tasks.user import SeenObject, Sight, UserConfiguration

STAGE = 0.006
"""m before the mouth, where the peg is lined up."""
ALIGNED = (0.0012, radians(2.0))
"""m and rad off the socket's axis, within which the user pushes."""
STEP = 0.012
"""m that the user pushes before the next look."""
FARTHER = 0.0015
"""m by which the user pushes beyond the bottom, to be sure of it."""
_FINGER = 0.010
"""m along the peg from the middle of a fingertip to the mouth, or to its end, at least."""
_CLEAR = 0.0086
"""m per side by which the hand comes down wider than the peg."""


class Lie(NamedTuple):
    """Where a peg lies, as seen along its socket.

    Attributes:
        along: m from where its middle is once it is in, negative before that.
        aside: m off the socket's axis, to its left.
        skew: rad off the socket's axis.
        before: m from its front to the mouth, negative once it is in.
    """

    along: float
    aside: float
    skew: float
    before: float


def lie_of(peg: SeenObject, socket: SeenObject, goal: Goal, along: Array) -> Lie:
    """Where a peg lies before its socket, or in it.

    Args:
        peg: The peg as seen.
        socket: The socket.
        goal: The goal of the peg.
        along: (2,) unit vector into the socket.
    """
    assert isinstance(peg.shape, Box) and isinstance(socket.shape, Part)
    x, y = (np.asarray(peg.position[:2]) - np.array(goal.position[:2])).tolist()
    c, s = along.tolist()
    deep, aside = c * x + s * y, c * y - s * x
    mouth = float(socket.shape.bounds[0][0])
    before = mouth - deep - peg.shape.half_size[0]
    return Lie(deep, aside, _half_wrapped(peg.yaw - goal.yaw), before)


class PegHandling:
    """Handling of a peg: held where it stays out of the socket, and equal after half a turn.

    Attributes:
        along: (2,) unit vector into the socket.
        inside: m of the peg that are in the socket at the goal.
    """

    good = (0.0012, radians(2.0))
    enough = (0.0018, radians(20.0))
    patience = 8

    def __init__(self) -> None:
        self.along: Array = np.zeros(2)
        self.inside = 0.0

    def missing(self, seen: SeenObject, goal: Goal) -> tuple[Array, float]:
        """Missing movement to the nearer of the two equivalent poses."""
        off = np.asarray(goal.position[:2]) - seen.position[:2]
        return off, _half_wrapped(goal.yaw - seen.yaw)

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp across the peg, behind what goes into the socket."""
        assert isinstance(seen.shape, Box)
        half, half_width, _ = seen.shape.half_size
        # The end of the peg that is in front.
        front = 1.0 if float(small_product(seen.rotation[:2, 0], self.along)) > 0.0 else -1.0
        out = 2 * half - self.inside
        fingers = hand.within(out - 2 * _FINGER)
        options = []
        for number, side in enumerate((pi / 2, -pi / 2)):
            axis = seen.yaw + side
            worst = max(abs(wrapped(a - hand.natural_axis)) for a in (axis, axis + turn)) + (
                10.0 if failed and side == failed.side else 0.0
            )
            grip = -front * self.inside / 2
            options.append(
                (worst, number, Grasp(axis, 2 * half_width, fingers, grip, side, 0.0, _CLEAR))
            )
        return min(options, key=lambda o: o[:2])[2]

    def pivot(self, seen: SeenObject) -> Array:
        """The middle of the peg."""
        return np.array(seen.position[:2])

    def reach(self, seen: SeenObject, grasp: Grasp, turn: float, hand: Hand) -> float:
        """The whole turn, which is small."""
        return turn


class InsertUser(SkilledUser):
    """Pushes a peg into its socket in steps, with a look at it after each.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
    """

    drags = 24

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._peg = PegHandling()
        self._handling = self._peg

    def _act(self, sight: Sight, now: float) -> None:
        goal = sight.goals[0]
        shape, socket = sight.objects[goal.object].shape, _socket(sight)
        assert isinstance(shape, Box) and isinstance(socket.shape, Part)
        if not length(self._peg.along):
            # The peg is seen to lie before the mouth, which a mirror image leaves as it is.
            axis = np.array([cos(goal.yaw), sin(goal.yaw)])
            way = np.array(goal.position[:2]) - sight.objects[goal.object].position[:2]
            self._peg.along = axis if float(small_product(way, axis)) > 0.0 else -axis
        self._peg.inside = shape.half_size[0] - float(socket.shape.bounds[0][0])
        super()._act(sight, now)

    def _missing(self, sight: Sight, box: SeenObject) -> tuple[Array, float]:
        """Missing shift (2,) m and turn rad; between the walls only the depth counts."""
        off, turn = super()._missing(sight, box)
        goal = sight.goals[0]
        lie = lie_of(box, _socket(sight), goal, self._peg.along)
        if lie.before < 0.0 and abs(lie.aside) < ALIGNED[0] + 0.002:
            return -lie.along * self._peg.along, 0.0
        return off, turn

    def _leg(self, sight: Sight, box: SeenObject, off: Array, turn: float) -> tuple[Array, float]:
        """The next movement: to a place before the mouth, or a step into the socket."""
        goal = sight.goals[0]
        along = self._peg.along
        lie = lie_of(box, _socket(sight), goal, along)
        across = np.array([-along[1], along[0]])
        aligned = abs(lie.aside) < ALIGNED[0] and abs(lie.skew) < ALIGNED[1]
        if lie.before < -0.002:
            ahead = min(FARTHER - lie.along, STEP)
        elif aligned and lie.before < 2 * STAGE:
            ahead = max(lie.before, 0.0) + STEP / 2
        else:
            ahead = lie.before - STAGE
        return ahead * along - lie.aside * across, -lie.skew


def _socket(sight: Sight) -> SeenObject:
    """The socket as seen."""
    goal = sight.goals[0].object
    (other,) = (o for name, o in sight.objects.items() if name != goal)
    return other


def _half_wrapped(angle: float) -> float:
    """Wraps an angle, rad, to -pi/2 to pi/2."""
    return float((angle + pi / 2) % pi - pi / 2)
