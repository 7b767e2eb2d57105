"""Effective throughput of moving an object to its goal, in bit/s (ISO 9241-411)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import log, log2, sqrt

import numpy as np
from numpy.typing import ArrayLike

WIDTH = 4.133
"""Ratio of the effective width to the standard deviation of endpoints. 4 percent of a normal
distribution lie outside (Welford 1960, ISO 9241-411); sqrt(2 pi e) is 4.1327."""
FEWEST = 3
"""Smallest number of movements; a standard deviation of two values is too uncertain."""
POINTS = 1000
"""Points of the mean over the distribution of an estimated deviation; its error is below 0.1 %."""
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


@dataclass(frozen=True)
class Throughput:
    """Effective throughput of one person's movements under one condition, bit/s.

    Attributes:
        value: The throughput.
        error: Its standard error, to first order, for normally distributed endpoints.
        bias: Expected excess over the true throughput, because a standard deviation of few
            endpoints is uncertain and its logarithm is taken.
    """

    value: float
    error: float
    bias: float


def throughput(
    amplitudes: Sequence[float], errors: Sequence[float], times: Sequence[float]
) -> Throughput | None:
    """Effective throughput with its standard error and bias.

    The effective index of difficulty log2(Ae / We + 1) over the mean time: Ae is the mean
    amplitude, We 4.133 times the standard deviation of the endpoints along the way (ISO 9241-411;
    Soukoreff and MacKenzie, "Towards a standard for pointing device evaluation, perspectives on 27
    years of Fitts' law research in HCI", International Journal of Human-Computer Studies 61, 2004).

    Args:
        amplitudes: Distance moved along the line from start to goal, of each movement, m.
        errors: Signed distance beyond the goal at its end, m.
        times: Duration, s.

    Returns:
        The throughput, its error and its bias; None for fewer than three movements, or if all
        errors are equal.
    """
    if len(amplitudes) < FEWEST:
        return None
    width = WIDTH * float(np.std(errors, ddof=1))
    mean, time = float(np.mean(amplitudes)), float(np.mean(times))
    if not (width > 0.0 and time > 0.0 and mean > 0.0):
        return None
    ratio, count = mean / width, len(times)
    value = log2(ratio + 1.0) / time
    # Relative variances: of the endpoints' deviation, of the mean amplitude, of the mean time.
    of_ratio = 1.0 / (2 * (count - 1)) + float(np.var(amplitudes, ddof=1)) / count / mean**2
    of_time = float(np.var(times, ddof=1)) / count / time**2
    by_ratio = ratio / (ratio + 1.0) / log(2.0) / time
    error = sqrt(by_ratio**2 * of_ratio + value**2 * of_time)
    return Throughput(value, error, value - value / (1.0 + relative_bias(ratio, count)))


def relative_bias(ratio: float, count: int) -> float:
    """Expected relative excess of a throughput for normally distributed endpoints.

    Args:
        ratio: Mean amplitude divided by the effective width.
        count: Number of movements.
    """
    from scipy import stats

    shares = (np.arange(POINTS) + 0.5) / POINTS
    deviation = np.sqrt(stats.chi2.ppf(shares, count - 1) / (count - 1))
    return float(np.mean(np.log2(ratio / deviation + 1.0)) / log2(ratio + 1.0) - 1.0)
