"""Effective throughput: how much of moving a thing to its place is done in a second."""

from __future__ import annotations

from collections.abc import Sequence
from math import log2

import numpy as np
from numpy.typing import ArrayLike

WIDTH = 4.133
"""Effective width over the standard deviation of endpoints: 4 percent of a normal distribution lie
beyond, as Welford (1960) and ISO 9241-411 have it; sqrt(2 pi e) is 4.1327."""
FEWEST = 3
"""Movements of which it is made at least: a deviation of two is hardly one."""
NEAR = 0.010
"""m between start and goal, below which there is no way to be moved along."""


def movement_along(start: ArrayLike, goal: ArrayLike, end: ArrayLike) -> tuple[float, float] | None:
    """A movement seen along the line from its start to its goal, all (3,) m.

    Returns:
        How far it went, and how far it ended beyond the goal, m; None where there is no way.
    """
    way = np.asarray(goal, float) - start
    distance = float(np.linalg.norm(way))
    if distance < NEAR:
        return None
    went = float((np.asarray(end, float) - start) @ way / distance)
    return went, went - distance


def throughput(
    amplitudes: Sequence[float], errors: Sequence[float], times: Sequence[float]
) -> float | None:
    """Effective throughput of one person's movements under one condition, bit/s.

    The effective index of difficulty log2(Ae / We + 1) over the mean time: Ae is the mean
    amplitude, We 4.133 times the standard deviation of the endpoints along the way (ISO 9241-411;
    Soukoreff and MacKenzie, "Towards a standard for pointing device evaluation, perspectives on 27
    years of Fitts' law research in HCI", International Journal of Human-Computer Studies 61, 2004).

    Args:
        amplitudes: m, how far each movement went.
        errors: m, signed, how far beyond the goal it ended.
        times: s that it took.

    Returns:
        None for fewer than three movements, or where all ended at the very same place.
    """
    if len(amplitudes) < FEWEST:
        return None
    width = WIDTH * float(np.std(errors, ddof=1))
    mean, time = float(np.mean(amplitudes)), float(np.mean(times))
    if not (width > 0.0 and time > 0.0 and mean > 0.0):
        return None
    return log2(mean / width + 1.0) / time
