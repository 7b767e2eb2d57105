"""A simulated person before a device that errs by more than a hand can make good, such as a webcam.

What is seen of a hand from above tells badly how far fingers are bent and how high they are. This
person does what people do then: keeps the fingers as in any pinch, closes although one of them is
not where it should be, goes on closing until the drawn fingers are at the thing, raises it until it
is up, and lets go once it sinks no further.
"""

from __future__ import annotations

from dataclasses import replace
from math import cos, radians, sin

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import small_product
from sandbox.devices.simulated.air_user.body import AXIS
from sandbox.devices.simulated.air_user.holds import Hold, stays_down
from sandbox.devices.simulated.air_user.person import AirHabits, AirPerson, Stage
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
"""Share of the height to be raised by at which a thing is up."""
_TIMES = 6
"""Most times that the hand is closed or raised further."""
_LEAST = 0.005
"""m, least height by which it is raised further."""
_SINKS, _LOW = 0.002, 0.010
"""m by which a thing must have sunk to be lowered on, once it is lower than the second above its
place."""
_UNDER = 0.003
"""m below a thing's upper side at which a finger is beside it."""


class PatientPerson(AirPerson):
    """Brings boxes to their goals by a drawn hand that follows badly."""

    _most_bent = 0.010

    _closed = _raised = 0
    _firm = False
    _foot = 0.0
    """m, height of the thing before it was gripped."""
    _above_goal = float("inf")

    def _around(self, sight: Sight, now: float) -> None:
        # A grasp begins anew.
        self._closed, self._raised, self._firm = 0, 0, False
        self._foot, self._above_goal = float(self._hold(sight).position[2]), float("inf")
        super()._around(sight, now)

    def _blocked(self, sight: Sight, hold: Hold) -> bool:
        return super()._blocked(sight, hold) and not self._about(sight, hold)

    def _lift(self, sight: Sight, now: float) -> None:
        aim, hold = self._movement.aim, self._hold(sight)
        apart = self._apart(sight) - hold.width
        at = apart <= _AT
        if not (at and self._firm) and self._closed < _TIMES and aim.gap > _NARROWEST:
            self._closed += 1
            self._firm = at
            gap = aim.gap - max(apart, 0.0) - (_FIRM if at else _CLOSER)
            self._go(replace(aim, gap=max(gap, _NARROWEST)), Stage.CLOSED, now, 1.3)
            return
        super()._lift(sight, now)

    def _carry(self, sight: Sight, now: float) -> None:
        hold = self._hold(sight)
        if not stays_down(self._thing(sight).shape) and self._holds(sight, hold):
            risen = float(hold.position[2]) - self._foot
            if risen < _RISEN * self._held and self._raised < _TIMES:
                self._raised += 1
                aim = self._movement.aim
                up = np.array([0.0, 0.0, max(self._held - risen, _LEAST)])
                self._go(replace(aim, centre=aim.centre + up), Stage.LIFTED, now, 1.2)
                return
            # It is held, however high it is.
            self._stood = float(hold.position[2]) - self._held
        super()._carry(sight, now)

    def _lower(self, sight: Sight, now: float) -> None:
        above = float(self._thing(sight).position[2]) - self._goal(sight).position[2]
        if above < _LOW and self._above_goal - above < _SINKS:
            self._open(now)
            return
        self._above_goal = above
        super()._lower(sight, now)

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
