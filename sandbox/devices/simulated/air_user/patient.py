"""A simulated person who uses a device with large errors, such as a webcam.

A camera measures the bend and the height of fingers badly if it looks from above. The simulated
person reacts to the errors as people do. They

- hold the fingers as in any pinch, and close them even if the drawn fingers are misplaced;
- continue to close until the drawn fingers are at the object;
- raise the hand until the object is up, and let go when the object sinks no further;
- hold a single object on the table lightly, and push it to its goal. If the object is not at the
  goal then, the fingers are still around it and close again.
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
"""Habits of a person who expects the drawn hand to be inexact."""

_FINGERS = (1, 2)
"""Labels of the fingers that oppose the thumb."""
_AT, _HELD = 0.002, 0.004
"""Distances (m) between drawn finger pads and faces of an object below which the fingers are at the
object (`_AT`), and hold it (`_HELD`)."""
_CLOSER, _FIRM = 0.006, 0.014
"""Distances (m) by which the gap is closed further: repeatedly while the fingers are not at the
object (`_CLOSER`), and once when they are (`_FIRM`)."""
_NARROWEST = 0.010
"""Smallest gap between the person's own fingers, m."""
_RISEN = 0.75
"""Share of the intended height at which an object counts as raised, if there are other objects."""
_TIMES = 6
"""Largest number of times that the hand is closed or raised further."""
_LEAST = 0.005
"""Smallest additional height, m."""
_SINKS, _LOW = 0.002, 0.010
"""While an object is lower than `_LOW` (m) above its goal, the hand is lowered further only if the
object has sunk by at least `_SINKS` (m)."""
_PUSHES = 2
"""Largest number of times that an object is pushed to its place before the hand lets go."""
_UNDER = 0.003
"""Depth (m) below an object's upper side from which a finger counts as beside it."""


class PatientPerson(AirPerson):
    """Brings boxes to their goals by a drawn hand that follows inaccurately."""

    _most_bent = 0.010

    _closed = _raised = _pushed = 0
    _firm = _again = False
    _foot = 0.0
    """Height of the object before it was gripped, m."""
    _above_goal = float("inf")
    _let_go: tuple[Array, float] | None = None
    """Shift (2,), m, and rotation, rad, from object to goal at the last release."""
    _dragged: tuple[Array, float] | None = None
    """Shift (2,), m, and rotation, rad, of an object caused by a release, as observed so far."""

    def _around(self, sight: Sight, now: float) -> None:
        self._begin(sight)
        self._again = False
        super()._around(sight, now)

    def _begin(self, sight: Sight) -> None:
        """Begins a new grasp."""
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
            # The object is held, even if it has not risen as intended: continue to carry.
            self._stood = float(hold.position[2]) - self._held
        super()._carry(sight, now)

    def _lower(self, sight: Sight, now: float) -> None:
        above = float(self._seen_object(sight).position[2]) - self._goal(sight).position[2]
        down = above < _LOW and self._above_goal - above < _SINKS
        if _alone(sight) and (self._pushed or down):
            self._push(sight, now)
            return
        if down:
            # A push would move the object below.
            self._open(now)
            return
        self._above_goal = above
        super()._lower(sight, now)

    def _push(self, sight: Sight, now: float) -> None:
        """Pushes an object on the table to its goal; lets go when it is there."""
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
            # The hand is still around the object, so it need not be raised first.
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
        """Stores how the release moved an object.

        Args:
            before: Shift and rotation from the object to its goal before the release.
            after: The same after the release.
        """
        shift, turn = before[0] - after[0], before[1] - after[1]
        if self._dragged is not None:
            shift = (shift + self._dragged[0]) / 2.0
            turn = (turn + self._dragged[1]) / 2.0
        self._dragged = shift, turn

    def _goal(self, sight: Sight) -> Goal:
        """Returns the goal, shifted so that the movement at the release ends at the goal."""
        goal = super()._goal(sight)
        if self._dragged is None:
            return goal
        (x, y), turn = self._dragged[0].tolist(), self._dragged[1]
        at = goal.position
        return replace(goal, position=(at[0] - x, at[1] - y, at[2]), yaw=goal.yaw - turn)

    # Observations of the person.

    def _axis(self) -> Array:
        """Direction (3,) from the thumb to the fingers."""
        return small_product(self._movement.aim.rotation, np.array([cos(AXIS), sin(AXIS), 0.0]))

    def _apart(self, sight: Sight) -> float:
        """Distance (m) between the pads of the drawn thumb and of the finger nearest to it."""
        axis, thumb = self._axis(), sight.tips[0]
        return min(
            float(small_product(sight.tips[f] - thumb, axis) - self._radius[0] - self._radius[f])
            for f in _FINGERS
        )

    def _about(self, sight: Sight, hold: Hold) -> bool:
        """True if the drawn thumb and a finger are beside opposite faces of an object."""
        axis = self._axis()

        def at_face(finger: int, side: float) -> bool:
            from_middle = sight.tips[finger] - hold.position
            far = side * float(small_product(from_middle, axis))
            return far > hold.width / 2.0 - _AT and float(from_middle[2]) < hold.half - _UNDER

        return at_face(0, -1.0) and any(at_face(f, 1.0) for f in _FINGERS)

    def _holds(self, sight: Sight, hold: Hold) -> bool:
        """True if an object is between the drawn thumb and a finger, and both are at it."""
        return self._apart(sight) - hold.width < _HELD and self._about(sight, hold)


def _alone(sight: Sight) -> bool:
    """True if a single object is on the table."""
    return len(sight.objects) == 1
