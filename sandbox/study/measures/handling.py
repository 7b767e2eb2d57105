"""Measures of handling: grasps, regrasps and drops, as functions of who pushes a thing."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

RELEASE = 0.1
"""s without any push of the hand, after which a thing has been let go."""
FORCE = 0.05
"""N from which on a hand pushes a thing. It then does until nothing of it pushes at all: with one
bound for both, a light touch would be many."""
FALL = 0.010
"""m by which a thing that nothing touches must sink to have been dropped. One that is let go a
little above its place is put down."""
PALM = "p"


def true_intervals(mask: ArrayLike) -> list[tuple[int, int]]:
    """First and last index of every run of true values."""
    edges = np.diff(np.concatenate([[0], np.asarray(mask, bool).astype(int), [0]]))
    return list(
        zip(
            np.flatnonzero(edges > 0).tolist(),
            (np.flatnonzero(edges < 0) - 1).tolist(),
            strict=True,
        )
    )


def push_intervals(digits: Sequence[str], grip: ArrayLike, period: float) -> list[tuple[int, int]]:
    """Stretches in which a hand pushes a thing, by first and last index.

    Args:
        digits: Letters of what of the hand pushes, by moment.
        grip: (n,) N.
        period: s between two moments.
    """
    strong = np.asarray(grip, float) >= FORCE
    joined: list[tuple[int, int]] = []
    for first, last in true_intervals([bool(d) for d in digits]):
        enough = strong[first : last + 1]
        if not enough.any():
            continue
        if joined and (first - joined[-1][1]) * period < RELEASE - 1e-9:
            joined[-1] = (joined[-1][0], last)
        else:
            joined.append((first + int(np.argmax(enough)), last))
    return joined


def grasps(digits: Sequence[str], runs: Sequence[tuple[int, int]]) -> int:
    """How many of some stretches are grasps: two digits of one hand push at the same moment."""
    return sum(any(map(_grasped, digits[first : last + 1])) for first, last in runs)


def _grasped(digits: str) -> bool:
    """Whether two digits of one hand push; a second hand's are capital letters."""
    fingers = digits.lower().replace(PALM, "")
    second = sum(letter.isupper() for letter in digits.replace(PALM.upper(), ""))
    return max(second, len(fingers) - second) >= 2


def drops(free: ArrayLike, height: ArrayLike) -> int:
    """How often a thing fell.

    Args:
        free: (n,) whether nothing touches it.
        height: (n,) m.
    """
    heights = np.asarray(height, float)
    falls = [
        heights[max(first - 1, 0)] - heights[first : last + 2].min()
        for first, last in true_intervals(free)
    ]
    return sum(bool(fall > FALL) for fall in falls)
