"""Effective throughput of moving an object to its goal, in bit/s (ISO 9241-411)."""

from __future__ import annotations

from collections.abc import Sequence
from math import log2

import numpy as np
from numpy.typing import ArrayLike

WIDTH = 4.133
"""Ratio of the effective width to the standard deviation of endpoints. 4 percent of a normal
distribution lie outside (Welford 1960, ISO 9241-411); sqrt(2 pi e) is 4.1327."""
FEWEST = 3
"""Smallest number of movements; a standard deviation of two values is too uncertain."""
NEAR = 0.010
"""m; if start and goal are nearer than this, the line between them has no defined direction."""


def movement_along(start: ArrayLike, goal: ArrayLike, end: ArrayLike) -> tuple[float, float] | None:
    """Projects a movement onto the line from its start to its goal.

    Args:
        start, goal, end: (3,) positions, m.

    Returns:
        Distance moved along the line, and signed distance of the end beyond the goal, m; None if
        start and goal are nearer than `NEAR`.
    """
    way = np.asarray(goal, float) - start
    distance = float(np.linalg.norm(way))
    if distance < NEAR:
        return None
    moved = float((np.asarray(end, float) - start) @ way / distance)
    return moved, moved - distance


def throughput(
    amplitudes: Sequence[float], errors: Sequence[float], times: Sequence[float]
) -> float | None:
    """Effective throughput of one person's movements under one condition, bit/s.

    The effective index of difficulty log2(Ae / We + 1) over the mean time: Ae is the mean
    amplitude, We 4.133 times the standard deviation of the endpoints along the way (ISO 9241-411;
    Soukoreff and MacKenzie, "Towards a standard for pointing device evaluation, perspectives on 27
    years of Fitts' law research in HCI", International Journal of Human-Computer Studies 61, 2004).

    Args:
        amplitudes: Distance moved along the line from start to goal, of each movement, m.
        errors: Signed distance beyond the goal at its end, m.
        times: Duration, s.

    Returns:
        The throughput; None for fewer than three movements, or if all errors are equal.
    """
    if len(amplitudes) < FEWEST:
        return None
    width = WIDTH * float(np.std(errors, ddof=1))
    mean, time = float(np.mean(amplitudes)), float(np.mean(times))
    if not (width > 0.0 and time > 0.0 and mean > 0.0):
        return None
    return log2(mean / width + 1.0) / time
