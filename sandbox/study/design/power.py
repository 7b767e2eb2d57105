"""Power of a study: the smallest difference that a paired t test detects."""

from __future__ import annotations

from dataclasses import dataclass
from math import expm1, sqrt

import numpy as np

SPREAD = 0.30
"""Assumed standard deviation over people of the difference between two conditions in the natural
logarithm of completion time. It is a guess, to be replaced by the result of a pilot."""

POINTS = 2000
"""Points of the integral over the estimated spread; its error is below 0.0005."""


MOST = 50.0
"""Largest effect that is looked for, in standard deviations."""


@dataclass(frozen=True)
class Detectable:
    """The smallest effect that is detected with a given probability; infinite if none up to `MOST`
    is.

    Attributes:
        effect: Difference in units of a standard deviation: that of the differences over people if
            each person does both conditions, or that of people if each does one.
        change: Corresponding relative change of completion time, for the assumed spread.
    """

    effect: float
    change: float


def power(effect: float, n: int, alpha: float = 0.05, between: bool = False) -> float:
    """Probability of finding an effect with a two-sided t test.

    Args:
        effect: Size of the effect, in standard deviations.
        n: Number of people; between participants, half of them are in each group.
        alpha: Significance level of the test.
        between: True for two groups instead of pairs.
    """
    from scipy import stats

    freedom = n - 2 if between else n - 1
    if freedom < 1:
        return alpha
    shift = effect * sqrt(n / 4 if between else n)
    limit = stats.t.ppf(1 - alpha / 2, freedom)
    # Mean over the distribution of the estimated spread; scipy's noncentral t fails in far tails.
    shares = (np.arange(POINTS) + 0.5) / POINTS
    spread = np.sqrt(stats.chi2.ppf(shares, freedom) / freedom)
    probability = stats.norm.cdf(shift - limit * spread) + stats.norm.cdf(-shift - limit * spread)
    return float(np.mean(probability))


def people_needed(
    effect: float, tests: int = 1, between: bool = False, wanted: float = 0.8, most: int = 10_000
) -> int | None:
    """The smallest number of people who detect an effect with probability `wanted`.

    Args:
        effect: Size of the effect, in standard deviations.
        tests: Number of tests of the study; alpha is 0.05 divided by it.
        between: True for two groups instead of pairs.
        wanted: Required power.
        most: Largest number that is tried.

    Returns:
        The number, which is even for two groups; None if it is above `most`.
    """
    step = 2 if between else 1
    low, high = 2 // step, most // step + 1
    while high - low > 1:
        middle = (low + high) // 2
        enough = power(effect, middle * step, 0.05 / tests, between) >= wanted
        low, high = (low, middle) if enough else (middle, high)
    return high * step if high * step <= most else None


def detectable(
    n: int,
    comparisons: int = 1,
    between: bool = False,
    wanted: float = 0.8,
    spread: float = SPREAD,
) -> Detectable:
    """The smallest effect that n people detect with probability `wanted`.

    Args:
        n: Number of people.
        comparisons: Number of tests of the study; alpha is 0.05 divided by it.
        between: True for two groups instead of pairs.
        wanted: Required power.
        spread: Standard deviation of the difference in log time over people.
    """
    from scipy.optimize import brentq

    alpha = 0.05 / comparisons
    if n < (4 if between else 3):
        return Detectable(float("inf"), float("inf"))
    if power(MOST, n, alpha, between) < wanted:
        return Detectable(float("inf"), float("inf"))
    effect = brentq(lambda d: power(d, n, alpha, between) - wanted, 1e-6, MOST)
    return Detectable(float(effect), expm1(float(effect) * spread))
