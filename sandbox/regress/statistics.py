"""Statistics of success over seeds: intervals, paired tests and their power.

The same seeds are run before and after a change, so that trials come in pairs. Only pairs that
differ are informative: without an effect, about half of them should be lost and half won. This is
McNemar's test, here exact and one-sided, since only losses matter.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import binom, binomtest

ALPHA = 0.05
"""Chance of calling a loss where there is none, over all tasks of a run together."""
POWER = 0.8
"""Chance with which a drop has to be noticed to count as noticeable."""
CONFIDENCE = 0.95
"""Of intervals of success."""


def wilson(successes: int, n: int) -> tuple[float, float]:
    """Wilson interval of a rate, 0 to 1; nothing is known from no trials.

    Source: Wilson (1927), without continuity correction.
    """
    if n == 0:
        return 0.0, 1.0
    interval = binomtest(successes, n).proportion_ci(CONFIDENCE, method="wilson")
    return float(interval.low), float(interval.high)


def mcnemar(lost: int, won: int) -> float:
    """Chance of at least so many losses among the pairs that differ, were each as likely a win.

    Args:
        lost: Pairs that succeeded before and fail now.
        won: Pairs that failed before and succeed now.
    """
    if lost + won == 0:
        return 1.0
    return float(binomtest(lost, lost + won, 0.5, alternative="greater").pvalue)


def falls_short(successes: int, n: int, rate: float) -> float:
    """Chance of so few successes, or fewer, were success as likely as the rate, 0 to 1."""
    return float(binomtest(successes, n, rate, alternative="less").pvalue) if n else 1.0


def holm(p_values: Mapping[str, float]) -> dict[str, float]:
    """P values adjusted for multiple tests; those up to alpha are significant.

    Source: Holm (1979), step down.
    """
    ordered = sorted(p_values, key=lambda name: p_values[name])
    adjusted: dict[str, float] = {}
    largest = 0.0
    for i, name in enumerate(ordered):
        largest = max(largest, min(1.0, (len(ordered) - i) * p_values[name]))
        adjusted[name] = largest
    return {name: adjusted[name] for name in p_values}


def fewest_losses(tests: int = 1) -> int:
    """Losses without a single win that are significant in any of so many tests."""
    losses = 1
    while mcnemar(losses, 0) * tests > ALPHA:
        losses += 1
    return losses


def power(pairs: int, loss: float, win: float = 0.0, tests: int = 1) -> float:
    """Chance that a change is called a loss.

    Args:
        pairs: Seeds that are run before and after.
        loss: Chance that a pair is lost.
        win: Chance that a pair is won.
        tests: Tasks that are tested together; the hardest of Holm's steps is assumed.
    """
    differ = loss + win
    # SciPy's binomial overflows at the smallest chances, with which hardly any pair ever differs.
    if differ < 1e-12:
        return 0.0
    counts = np.arange(pairs + 1)
    called = binom.sf(_critical(pairs, tests) - 1, counts, loss / differ)
    return float(np.sum(binom.pmf(counts, pairs, min(differ, 1.0)) * called))


def noticeable_drop(pairs: int, win: float = 0.0, tests: int = 1) -> float | None:
    """The noise floor: the smallest drop of success that so many pairs notice with power `POWER`.

    Args:
        pairs: Seeds that are run before and after.
        win: Chance that a pair is won at the same time: churn, which hides losses.
        tests: Tasks that are tested together.

    Returns:
        Success before less success now, 0 to 1; None where not even a total loss is noticed.
    """

    def short(drop: float) -> float:
        return power(pairs, win + drop, win, tests) - POWER

    most = 1.0 - 2.0 * win
    if pairs == 0 or most <= 0.0 or short(most) < 0.0:
        return None
    return float(brentq(short, 0.0, most, xtol=1e-6))


@cache
def _critical_cached(pairs: int, tests: int) -> tuple[int, ...]:
    critical = []
    for differ in range(pairs + 1):
        # The least number of losses whose chance, or of any more, is small enough.
        losses = int(binom.isf(ALPHA / tests, differ, 0.5)) + 1
        while losses > 0 and mcnemar(losses - 1, differ - losses + 1) * tests <= ALPHA:
            losses -= 1
        while losses <= differ and mcnemar(losses, differ - losses) * tests > ALPHA:
            losses += 1
        critical.append(losses)
    return tuple(critical)


def _critical(pairs: int, tests: int) -> NDArray[np.int64]:
    """(pairs + 1,) losses that are significant among 0, 1, 2 ... pairs that differ."""
    return np.array(_critical_cached(pairs, tests))
