"""One of two who carry a tray through the air: raises their own end, and watches the other one.

The two do not talk. Each sees on the screen how high the other end is; nobody goes far ahead.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from models.arithmetic.arrays import Array
from models.objects import Tray
from sandbox.devices.simulated.air_user.holds import Hold
from sandbox.devices.simulated.air_user.person import AirPerson, Stage
from tasks.user import SeenObject, Sight

_AHEAD = 0.020
"""m by which one's own end is raised above the other one."""
_UP = 0.6
"""Of the way up: the share at which both ends are up, so that the tray may be carried along."""
_STEP, _STEP_TURN = 0.025, float(np.deg2rad(8.0))
"""m and rad of one movement to the side, after which one looks what the other does."""
_IN_PLACE, _STRAIGHT, _LEVEL = 0.005, float(np.deg2rad(3.0)), 0.004
"""m from its place to the side, rad, and m in height at which an end is left in peace."""
_GONE = 0.030
"""m from the drawn fingers at which a handle is taken to have slipped."""
_LOOK = 0.10
"""s between two looks of one who waits."""
_FELT = 0.35
"""Of a seen error, how much of it is corrected at once: two who correct at once add up."""


class AirCarrier(AirPerson):
    """Lifts and carries the end of a tray that is nearer to their home, and holds it there."""

    def _lift(self, sight: Sight, now: float) -> None:
        self._stage = Stage.LIFTED
        self._carry(sight, now)

    def _carry(self, sight: Sight, now: float) -> None:
        thing, goal = self._thing(sight), self._goal(sight)
        assert isinstance(thing.shape, Tray)
        aim, hold = self._motion.aim, self._hold(sight)
        if float(np.linalg.norm(hold.position - (aim.centre - self._offset))) > _GONE:
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
        along = np.array([np.cos(goal.yaw), np.sin(goal.yaw)])
        side = np.sign((hold.position - thing.position)[:2] @ along)
        place = np.asarray(goal.position[:2]) + side * thing.shape.grip * along
        off = _FELT * (place - hold.position[:2])
        turn = _FELT * float((goal.yaw - thing.yaw + np.pi) % (2 * np.pi) - np.pi)
        steps = max(float(np.linalg.norm(off)) / _STEP, abs(turn) / _STEP_TURN, 1.0)
        if float(np.linalg.norm(off)) < _FELT * _IN_PLACE:
            off = np.zeros(2)
        return off / steps, turn / steps if abs(turn) > _FELT * _STRAIGHT else 0.0


def _other(thing: SeenObject, hold: Hold) -> Hold:
    """The handle at the other end."""
    return replace(hold, position=2.0 * thing.position - hold.position)
