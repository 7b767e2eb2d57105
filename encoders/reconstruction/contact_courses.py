"""Courses of the sizes of fingertips and palms in the first half second of a touch.

A size is the diameter of the circle of equal area. Fingertips have 5 to 28 mm, whether they come
down at once or flatten; palms have 25 to 120 mm, and half of them begin as small as a fingertip and
grow for 0.1 to 0.4 s. A course is one such way; how well a contact's reports fit the best course of
a palm, against the best of a fingertip, tells how likely it is a palm.
"""

from __future__ import annotations

from itertools import product
from math import exp, inf, log
from typing import NamedTuple

import numpy as np

from models.arithmetic.arrays import Array

GRID = 0.01
"""s between the times at which courses are known."""

LONGEST = 0.4
"""s of the slowest growth of a palm."""

NOISE = 0.12
"""Deviation of the logarithm of a reported size. With 15 % in width and in height it is 11 %."""

OUTLIER = 9.0
"""Largest squared deviation of a report, in squared deviations of the noise, that counts."""

MEMORY = 0.5
"""s after which a report counts 1/e, so that a finger may become a palm later."""

REPEATED = 0.5
"""Weight of a report that is equal to the last one: the contact does not grow, but the noise is
that of the last report too."""

_GROWING = log(0.25)
"""Log-odds of growing against coming down at once, by the best of a dozen courses."""

_ONTO = (100.0, 150.0, 200.0, 250.0, 300.0, 400.0)
"""ms that growth takes."""

FINGERTIPS, PALMS = (5.0, 28.0), (25.0, 120.0)
"""mm of fingertips and palms at rest."""


class _Course(NamedTuple):
    """A way from one size to another in mm, within some ms."""

    first: float
    last: float
    takes: float
    palm: bool

    def size(self, time: float) -> float:
        """mm, some seconds after touch-down."""
        share = 1.0 if self.takes <= 0 else min(1000.0 * time / self.takes, 1.0)
        return self.first + share * (self.last - self.first)

    @property
    def prior(self) -> float:
        """Log of the density of its last size, and of growing."""
        low, high = PALMS if self.palm else FINGERTIPS
        return -log(high - low) + (_GROWING if self.takes else 0.0)


def _courses() -> list[_Course]:
    tips = [5.0, 6.0, 7.0, 8.0, 9.0, *(float(d) for d in range(10, 29))]
    palms = [25.0, 26.0, 27.0, 28.0, 29.0, 31.0, 33.0, 36.0, 40.0, 45.0, 52.0, 60.0, 70.0, 85.0]
    courses = [_Course(d, d, 0.0, False) for d in tips]
    courses += [_Course(d, d, 0.0, True) for d in (*palms, 100.0, 120.0)]
    small = (6.0, 8.0, 10.0, 12.5, 15.0, 18.0, 21.0)
    courses += [
        _Course(first, last, takes, False)
        for first, last, takes in product(small, tips[6::2], _ONTO)
        if last >= 1.2 * first
    ]
    courses += [
        _Course(first, last, takes, True)
        for first, last, takes in product(small[1:], palms[::2], _ONTO)
        if last >= 1.2 * first
    ]
    return courses


_ALL = _courses()
_IS_PALM = np.array([c.palm for c in _ALL])
_PRIOR = np.array([c.prior for c in _ALL])
_TIMES = round(LONGEST / GRID) + 1
_LOG_SIZES = np.array([[log(c.size(GRID * t)) for c in _ALL] for t in range(_TIMES)])
"""(times, courses) logarithms of mm."""


_LEAST, _MOST = log(FINGERTIPS[0]), log(PALMS[1])


class SizeCourse:
    """The reports of one contact's size so far.

    Args:
        began: s, time of touch-down.

    Attributes:
        began: As given.
    """

    def __init__(self, began: float) -> None:
        self.began = began
        self._time = began
        self._misfit: Array = np.zeros(len(_ALL))
        self._last: tuple[float, float] | None = None

    def report(self, time: float, extent: tuple[float, float]) -> None:
        """Takes the width and height in m at a time in s."""
        weight = REPEATED if extent == self._last else 1.0
        size = 0.5 * (log(1000.0 * extent[0]) + log(1000.0 * extent[1]))
        # What is smaller or larger than all courses is like the smallest or largest of them.
        size = min(max(size, _LEAST), _MOST)
        row = min(round((time - self.began) / GRID), _TIMES - 1)
        off = (_LOG_SIZES[row] - size) / NOISE
        kept = exp(-(time - self._time) / MEMORY)
        self._misfit = kept * self._misfit + weight * np.minimum(off * off, OUTLIER)
        self._time, self._last = time, extent

    def pause(self, time: float) -> None:
        """Leaves out a report; what was reported before is remembered as it is now."""
        self._time = time

    @property
    def odds(self) -> float:
        """Log-odds of a palm against a fingertip, by its size alone."""
        fit = _PRIOR - 0.5 * self._misfit
        return float(fit[_IS_PALM].max(initial=-inf) - fit[~_IS_PALM].max(initial=-inf))
