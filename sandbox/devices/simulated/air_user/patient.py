"""A simulated person before a device that errs by more than a hand can make good, such as a webcam.

What is seen of a hand from above tells badly how far fingers are bent and how high they are. This
person does what people do then: keeps the fingers as in any pinch, closes although one of them is
not where it should be, goes on closing until the drawn fingers are at the thing, raises it until it
is up, and lets go once it sinks no further. A thing that is alone on the table is held lightly and
pushed to its place before; if it lies wrong then, the fingers are still about it, and close again.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, radians, sin

import numpy as np

from models.arithmetic import Array, length, small_product
from sandbox.devices.simulated.air_user.body import AXIS
from sandbox.devices.simulated.air_user.holds import (
    Hold,
    at_goal,
    pinch_motion,
    remaining_motion,
    stays_down,
)
from sandbox.devices.simulated.air_user.person import AirHabits, AirPerson, Stage
from tasks.task import Goal
from tasks.user import Sight

PATIENT = AirHabits(good=0.006, looks=4, placed=0.006, straight=radians(7.0), press=0.006)
"""Habits of a person who knows that the drawn hand is not exact."""

_FINGERS = (1, 2)
"""Labels of those that oppose the thumb."""
_AT, _HELD = 0.002, 0.004
"""m between drawn pads and faces below which fingers are at a thing, and hold it."""
_CLOSER, _FIRM = 0.006, 0.014
"""m by which a gap is closed further where fingers are not at a thing, and once, where they are."""
_NARROWEST = 0.010
"""m, smallest own gap."""
_RISEN = 0.75
"""Share of the height to be raised by at which a thing is up, where others stand about."""
_TIMES = 6
"""Most times that the hand is closed or raised further."""
_LEAST = 0.005
"""m, least height by which it is raised further."""
_SINKS, _LOW = 0.002, 0.010
"""m by which a thing must have sunk to be lowered on, once it is lower than the second above its
place."""
_PUSHES = 2
"""Most times that a thing is pushed to its place before it is let go."""
_UNDER = 0.003
"""m below a thing's upper side at which a finger is beside it."""


class PatientPerson(AirPerson):
    """Brings boxes to their goals by a drawn hand that follows badly."""

    _most_bent = 0.010

    _closed = _raised = _pushed = 0
    _firm = _again = False
    _foot = 0.0
    """m, height of the thing before it was gripped."""
    _above_goal = float("inf")
    _let_go: tuple[Array, float] | None = None
    """Shift (2,) m and turn, rad, to the goal when the thing was let go last."""
    _dragged: tuple[Array, float] | None = None
    """Shift (2,) m and turn, rad, of a thing by letting go, as seen so far."""

    def _around(self, sight: Sight, now: float) -> None:
        self._begin(sight)
        self._again = False
        super()._around(sight, now)

    def _begin(self, sight: Sight) -> None:
        """Begins a grasp anew."""
        self._closed, self._raised, self._pushed, self._firm = 0, 0, 0, False
        self._foot, self._above_goal = float(self._hold(sight).position[2]), float("inf")

    def _blocked(self, sight: Sight, hold: Hold) -> bool:
        return super()._blocked(sight, hold) and not self._about(sight, hold)

    def _lift(self, sight: Sight, now: float) -> None:
        aim, hold = self._movement.aim, self._hold(sight)
        apart = self._apart(sight) - hold.width
        at = apart <= _AT
        firm = at and (self._firm or _alone(sight))
        if not firm and self._closed < _TIMES and aim.gap > _NARROWEST:
            self._closed += 1
            self._firm = at
            gap = aim.gap - max(apart, 0.0) - (_FIRM if at else _CLOSER)
            self._go(replace(aim, gap=max(gap, _NARROWEST)), Stage.CLOSED, now, 1.3)
            return
        if self._again:
            self._stage = Stage.LOWERED
            self._push(sight, now)
            return
        super()._lift(sight, now)

    def _carry(self, sight: Sight, now: float) -> None:
        hold = self._hold(sight)
        if not stays_down(self._seen_object(sight).shape) and self._holds(sight, hold):
            risen = float(hold.position[2]) - self._foot
            low = not _alone(sight) and risen < _RISEN * self._held
            if low and self._raised < _TIMES:
                self._raised += 1
                aim = self._movement.aim
                up = np.array([0.0, 0.0, max(self._held - risen, _LEAST)])
                self._go(replace(aim, centre=aim.centre + up), Stage.LIFTED, now, 1.2)
                return
            # It is held, however high it is.
            self._stood = float(hold.position[2]) - self._held
        super()._carry(sight, now)

    def _lower(self, sight: Sight, now: float) -> None:
        above = float(self._seen_object(sight).position[2]) - self._goal(sight).position[2]
        down = above < _LOW and self._above_goal - above < _SINKS
        if _alone(sight) and (self._pushed or down):
            self._push(sight, now)
            return
        if down:
            # A push would move what it stands on.
            self._open(now)
            return
        self._above_goal = above
        super()._lower(sight, now)

    def _push(self, sight: Sight, now: float) -> None:
        """Pushes a thing that is down to its place; lets go of one that is there."""
        thing, goal, habits = self._seen_object(sight), self._goal(sight), self.habits
        self._above_goal = float(thing.position[2]) - goal.position[2]
        off, turn = remaining_motion(thing, goal)
        near = length(off) < habits.placed and abs(turn) < habits.straight
        if near or self._pushed >= _PUSHES:
            self._let_go = remaining_motion(thing, super()._goal(sight))
            self._open(now)
            return
        self._pushed += 1
        aim = self._movement.aim
        shift, turn = pinch_motion(thing, goal, (aim.centre - self._offset)[:2])
        centre = aim.centre + np.append(shift, 0.0)
        self._go(replace(aim, centre=centre, yaw=aim.yaw + turn), Stage.LOWERED, now, 1.2)

    def _leave(self, sight: Sight, now: float) -> None:
        thing, goal, hold = self._seen_object(sight), super()._goal(sight), self._hold(sight)
        if self._let_go is not None:
            self._learn(self._let_go, remaining_motion(thing, goal))
            self._let_go = None
        at_height = abs(float(thing.position[2]) - goal.position[2]) < _LOW
        wrong = _alone(sight) and at_height and not at_goal(thing, goal)
        if wrong and self.grasps < self.habits.attempts and self._about(sight, hold):
            # The hand is still about it: it need not be raised again.
            self.grasps += 1
            self._begin(sight)
            self._again = True
            aim = self._movement.aim
            self._offset = aim.centre - self._grip(hold, sight)
            gap = self._centres(hold.width - 2.0 * self.habits.squeeze)
            self._go(replace(aim, gap=gap), Stage.CLOSED, now, 1.3)
            return
        super()._leave(sight, now)

    def _learn(self, before: tuple[Array, float], after: tuple[Array, float]) -> None:
        """Remembers how letting go moved a thing."""
        shift, turn = before[0] - after[0], before[1] - after[1]
        if self._dragged is not None:
            shift = (shift + self._dragged[0]) / 2.0
            turn = (turn + self._dragged[1]) / 2.0
        self._dragged = shift, turn

    def _goal(self, sight: Sight) -> Goal:
        """The goal, so far beside it that letting go brings the thing there."""
        goal = super()._goal(sight)
        if self._dragged is None:
            return goal
        (x, y), turn = self._dragged[0].tolist(), self._dragged[1]
        at = goal.position
        return replace(goal, position=(at[0] - x, at[1] - y, at[2]), yaw=goal.yaw - turn)

    # What the person sees.

    def _axis(self) -> Array:
        """(3,) direction from the thumb to the fingers."""
        return small_product(self._movement.aim.rotation, np.array([cos(AXIS), sin(AXIS), 0.0]))

    def _apart(self, sight: Sight) -> float:
        """m between the drawn thumb's pad and that of the finger that is nearer to it."""
        axis, thumb = self._axis(), sight.tips[0]
        return min(
            float(small_product(sight.tips[f] - thumb, axis) - self._radius[0] - self._radius[f])
            for f in _FINGERS
        )

    def _about(self, sight: Sight, hold: Hold) -> bool:
        """True if the drawn thumb and one finger are beside opposite faces of a thing."""
        axis = self._axis()

        def beside(finger: int, side: float) -> bool:
            from_middle = sight.tips[finger] - hold.position
            far = side * float(small_product(from_middle, axis))
            return far > hold.width / 2.0 - _AT and float(from_middle[2]) < hold.half - _UNDER

        return beside(0, -1.0) and any(beside(f, 1.0) for f in _FINGERS)

    def _holds(self, sight: Sight, hold: Hold) -> bool:
        """True if a thing is between the drawn thumb and a finger that are at it."""
        return self._apart(sight) - hold.width < _HELD and self._about(sight, hold)


def _alone(sight: Sight) -> bool:
    """True if a thing has the table to itself."""
    return len(sight.objects) == 1
