"""A simulated user who carries one end of a tray through the air and watches the other end.

The two users do not communicate. Each sees on the screen how high the other end is, and stays close
to it.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, sin

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length, small_product
from models.objects import Tray
from sandbox.devices.simulated.air_user.holds import Hold
from sandbox.devices.simulated.air_user.person import AirPerson, Stage
from tasks.user import SeenObject, Sight

_AHEAD = 0.020
"""m by which the own end is raised above the other one."""
_UP = 0.6
"""Share of the lift above which both ends count as up, so that the tray may be carried along."""
_STEP, _STEP_TURN = 0.025, float(np.deg2rad(8.0))
"""m and rad, largest sideways movement before the user looks at the other end again."""
_IN_PLACE, _STRAIGHT, _LEVEL = 0.005, float(np.deg2rad(3.0)), 0.004
"""m sideways, rad and m in height: tolerances within which an end is not corrected."""
_GONE = 0.030
"""m from the drawn fingers at which a handle is taken to have slipped."""
_LOOK = 0.10
"""s between two looks of a waiting user."""
_FELT = 0.35
"""Share of a seen error that is corrected at once; small, since both users' corrections add up."""


class AirCarrier(AirPerson):
    """Lifts and carries the end of a tray that is nearer to their home, and holds it there."""

    def _lift(self, sight: Sight, now: float) -> None:
        self._stage = Stage.LIFTED
        self._carry(sight, now)

    def _carry(self, sight: Sight, now: float) -> None:
        thing, goal = self._thing(sight), self._goal(sight)
        assert isinstance(thing.shape, Tray)
        aim, hold = self._movement.aim, self._hold(sight)
        if length(hold.position - (aim.centre - self._offset)) > _GONE:
            self._open(now)
            return
        low = thing.shape.handle[2]
        height, other = hold.half_above(low), _other(thing, hold).half_above(low)
        top = goal.position[2] - low
        wanted = min(top, other + _AHEAD)
        step = np.zeros(3)
        if abs(wanted - height) > _LEVEL:
            step[2] = wanted - height if height < _UP * top else _FELT * (wanted - height)
        turn = 0.0
        if min(height, other) > _UP * top:
            shift, turn = self._aside(thing, hold, sight)
            step[:2] = shift
        if not step.any() and turn == 0.0:
            self._until = now + _LOOK
            return
        self._go(replace(aim, centre=aim.centre + step, yaw=aim.yaw + turn), Stage.LIFTED, now, 1.2)

    def _aside(self, thing: SeenObject, hold: Hold, sight: Sight) -> tuple[Array, float]:
        """Movement (2,) m to the side, and turn, of the own end."""
        goal = self._goal(sight)
        assert isinstance(thing.shape, Tray)
        along = np.array([cos(goal.yaw), sin(goal.yaw)])
        side = np.sign(small_product((hold.position - thing.position)[:2], along))
        place = np.asarray(goal.position[:2]) + side * thing.shape.grip * along
        off = _FELT * (place - hold.position[:2])
        turn = _FELT * float((goal.yaw - thing.yaw + np.pi) % (2 * np.pi) - np.pi)
        steps = max(length(off) / _STEP, abs(turn) / _STEP_TURN, 1.0)
        if length(off) < _FELT * _IN_PLACE:
            off = np.zeros(2)
        return off / steps, turn / steps if abs(turn) > _FELT * _STRAIGHT else 0.0


def _other(thing: SeenObject, hold: Hold) -> Hold:
    """The handle at the other end."""
    return replace(hold, position=2.0 * thing.position - hold.position)
