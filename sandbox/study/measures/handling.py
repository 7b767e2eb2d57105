"""Measures of handling (grasps, regrasps and drops), computed from what pushes an object."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

RELEASE = 0.1
"""s without any push of the hand, after which the object counts as let go."""
FORCE = 0.05
"""N; a push begins when the force reaches this value, and ends when no digit pushes at all. With
one threshold for both, a single light touch would count as many."""
FALL = 0.010
"""m that an untouched object must fall to count as dropped. One that is let go a little above its
place is put down, not dropped."""
PALM = "p"


def true_intervals(mask: ArrayLike) -> list[tuple[int, int]]:
    """First and last index of every run of true values in a mask (n,)."""
    edges = np.diff(np.concatenate([[0], np.asarray(mask, bool).astype(int), [0]]))
    return list(
        zip(
            np.flatnonzero(edges > 0).tolist(),
            (np.flatnonzero(edges < 0) - 1).tolist(),
            strict=True,
        )
    )


def push_intervals(digits: Sequence[str], grip: ArrayLike, period: float) -> list[tuple[int, int]]:
    """Intervals in which a hand pushes an object, by first and last index.

    An interval begins with a push of `FORCE` or more; later pushes of any force belong to it until
    there was none for `RELEASE`.

    Args:
        digits: Letters of the pushing digits at each moment.
        grip: (n,) total normal force, N.
        period: Time between two moments, s.
    """
    strong = np.asarray(grip, float) >= FORCE
    joined: list[tuple[int, int]] = []
    for first, last in true_intervals([bool(d) for d in digits]):
        if joined and (first - joined[-1][1]) * period < RELEASE - 1e-9:
            joined[-1] = (joined[-1][0], last)
        elif (enough := strong[first : last + 1]).any():
            joined.append((first + int(np.argmax(enough)), last))
    return joined


def grasps(digits: Sequence[str], runs: Sequence[tuple[int, int]]) -> int:
    """Number of intervals that are grasps: two digits of one hand push at the same moment."""
    return sum(any(map(_grasped, digits[first : last + 1])) for first, last in runs)


def _grasped(digits: str) -> bool:
    """True if two digits of one hand push; capital letters are those of a second hand."""
    fingers = digits.lower().replace(PALM, "")
    second = sum(map(str.isupper, digits.replace(PALM.upper(), "")))
    return max(second, len(fingers) - second) >= 2


def drops(free: ArrayLike, height: ArrayLike) -> int:
    """Number of times that an object was dropped.

    Args:
        free: (n,) true while nothing touches the object.
        height: (n,) height of the object, m.
    """
    heights = np.asarray(height, float)
    falls = [
        heights[max(first - 1, 0)] - heights[first : last + 2].min()
        for first, last in true_intervals(free)
    ]
    return sum(bool(fall > FALL) for fall in falls)
