"""Statistics of success over seeds: intervals, paired tests and their power.

The same seeds are run before and after a change, so that trials come in pairs. For success, only
pairs that differ are informative. A pair is lost if only the trial before the change succeeded, and
won if only the trial after it did. Without an effect, about half of these pairs are lost and half
are won. McNemar's test checks this; here it is exact and one-sided. Times and other measures are
compared by the signed ranks of their differences.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import brentq
from scipy.stats import binom, binomtest, norm, rankdata
from scipy.stats import t as student_t

K = TypeVar("K")

ALPHA = 0.05
"""Probability of a false alarm in a single test."""
GATE = 0.02
"""Probability of a false alarm in a whole comparison with a baseline: one in fifty runs."""
POWER = 0.8
"""Probability of detection from which a drop counts as detectable."""
CONFIDENCE = 0.95
"""Coverage of intervals."""
_EQUAL = 1e-9
"""Largest difference of a pair that counts as equal."""
_COUNTED = 400
"""Largest number of pairs for which the exact distribution of a rank sum is computed. For more
pairs, the normal distribution is used."""
_QUANTILES = np.linspace(0.0, 1.0, _COUNTED)


def wilson(successes: int, n: int) -> tuple[float, float]:
    """Wilson interval of a success rate, 0 to 1; (0, 1) without trials.

    Source: Wilson (1927), without continuity correction.
    """
    if n == 0:
        return 0.0, 1.0
    interval = binomtest(successes, n).proportion_ci(CONFIDENCE, method="wilson")
    return float(interval.low), float(interval.high)


def mcnemar(lost: int, won: int) -> float:
    """P value of McNemar's test: exact, one-sided.

    It is the probability of at least this number of losses among the pairs that differ, if losses
    and wins are equally likely.

    Args:
        lost: Pairs that succeeded before and fail now.
        won: Pairs that failed before and succeed now.
    """
    if lost + won == 0:
        return 1.0
    return float(binomtest(lost, lost + won, 0.5, alternative="greater").pvalue)


def signed_rank(*samples: ArrayLike) -> float:
    """P value of Wilcoxon's signed-rank test, one-sided.

    It is the probability of a sum of positive ranks of this size or larger, if both signs are
    equally likely. Pairs without a difference are left out, and differences of equal size get their
    mean rank. The test is exact for up to `_COUNTED` pairs.

    Args:
        samples: Differences (n,) of pairs, one array per sample; positive differences are evidence
            of the effect. Each sample is ranked separately, so that a sample with small differences
            has as much weight as one with large differences.

    Source: Wilcoxon (1945); Streitberg and Roehmel (1986) for ties.
    """
    some = [_differing(differences) for differences in samples]
    n = sum(map(len, some))
    if n == 0:
        return 1.0
    # Twice the mean ranks are whole numbers. Rounding keeps equal sizes equal.
    ranks = np.concatenate([2.0 * rankdata(np.round(np.abs(each), 12)) for each in some])
    ranks = np.rint(ranks).astype(np.int64)
    observed = int(ranks[np.concatenate(some) > 0.0].sum())
    if n > _COUNTED:
        middle, spread = 0.5 * ranks.sum(), 0.5 * float(np.sqrt(np.sum(ranks.astype(float) ** 2)))
        return float(norm.sf((observed - 1.0 - middle) / spread))
    chances = np.zeros(int(ranks.sum()) + 1)
    chances[0] = 1.0
    for rank in ranks:
        chances[rank:] += chances[: len(chances) - rank].copy()
        chances *= 0.5
    return float(min(chances[observed:].sum(), 1.0))


def _differing(differences: ArrayLike) -> NDArray[np.float64]:
    every = np.asarray(differences, float)
    return every[np.abs(every) > _EQUAL]


def typical_change(*samples: ArrayLike) -> tuple[float, float, float]:
    """The Hodges-Lehmann estimate of the shift, and its interval (estimate, low, high).

    The means of any two differences of a sample are computed, without the pairs that are equal. The
    estimate is the median of these means, multiplied by the share of pairs that differ. Its sign
    agrees with `signed_rank`, and single large differences do not change it.

    Args:
        samples: Differences (n,) of pairs, one array per sample, n at least 1.

    Source: Hodges and Lehmann (1963).
    """
    some = [_differing(differences) for differences in samples]
    n = sum(map(len, some))
    if n == 0:
        return 0.0, 0.0, 0.0
    # For many pairs, quantiles are enough.
    few = [each if len(each) <= _COUNTED else np.quantile(each, _QUANTILES) for each in some]
    upper = [np.add.outer(each, each)[np.triu_indices(len(each))] for each in few]
    means = np.round(0.5 * np.concatenate(upper), 12)
    reach = float(norm.ppf(0.5 + 0.5 * CONFIDENCE)) / float(np.sqrt(3.0 * n))
    ends = (0.5 - reach, 0.5 + reach) if reach < 0.5 else ()
    low, high = map(float, np.quantile(means, ends)) if ends else (-np.inf, np.inf)
    share = n / sum(np.size(differences) for differences in samples)
    return share * float(np.median(means)), share * low, share * high


def mean_change(differences: ArrayLike) -> tuple[float, float, float]:
    """Mean of differences of pairs, and its interval by Student's t (mean, low, high).

    The interval is infinite for a single pair.

    Args:
        differences: (n,) differences of pairs, n at least 1.
    """
    every = np.asarray(differences, float)
    n, mean = len(every), float(np.mean(every))
    if n < 2:
        return mean, -np.inf, np.inf
    error = float(np.std(every, ddof=1)) / float(np.sqrt(n))
    reach = float(student_t.ppf(0.5 + 0.5 * CONFIDENCE, n - 1)) * error
    return mean, mean - reach, mean + reach


def noticeable_shift(churn: Sequence[ArrayLike], pairs: int, level: float = ALPHA) -> float:
    """The smallest shift of all pairs that the signed-rank test detects with power `POWER`.

    The sum of ranks is approximated by a normal distribution. Its mean follows from the probability
    that the mean of two differences is positive. Its variance follows from the probability that the
    means of one difference with two other differences are both positive.

    Args:
        churn: Differences (n,) of pairs without a real change, one array per sample.
        pairs: Number of pairs of all samples together.
        level: Largest p value that counts as a loss.

    Source: Lehmann (1975), "Nonparametrics", section 2.3.
    """
    n = pairs / len(churn)
    # Without an effect, both signs of a difference are equally likely.
    both = [np.concatenate([each, np.negative(each)]) for each in map(np.asarray, churn)]
    sums = [np.add.outer(each, each) for each in both]

    def short(shift: float) -> float:
        excess = variance = 0.0
        for each in sums:
            positive = np.mean(np.heaviside(each + 2.0 * shift, 0.5), axis=1)
            excess += 0.5 * n**2 * float(np.mean(positive) - 0.5)
            variance += n**3 * float(np.var(positive))
        called = norm.isf(level) * np.sqrt(len(churn) * n**3 / 12.0)
        return float(excess - called + norm.ppf(1.0 - POWER) * np.sqrt(variance))

    most = max(float(np.max(each)) for each in sums) + _EQUAL
    return np.inf if n < 2 or short(most) < 0.0 else float(brentq(short, 0.0, most, xtol=1e-6))


def falls_short(successes: int, n: int, rate: float) -> float:
    """Probability of at most this number of successes in n trials, for a success rate of 0 to 1."""
    return float(binomtest(successes, n, rate, alternative="less").pvalue) if n else 1.0


def holm(p_values: Mapping[K, float]) -> dict[K, float]:
    """P values adjusted for multiple tests. An adjusted value up to alpha is significant.

    Source: Holm (1979), step-down procedure.
    """
    ordered = sorted(p_values, key=lambda name: p_values[name])
    adjusted: dict[K, float] = {}
    largest = 0.0
    for i, name in enumerate(ordered):
        largest = max(largest, min(1.0, (len(ordered) - i) * p_values[name]))
        adjusted[name] = largest
    return {name: adjusted[name] for name in p_values}


def fewest_losses(level: float = ALPHA) -> int:
    """Smallest number of losses, without any win, that is significant.

    Args:
        level: Largest p value that counts as a loss: alpha, divided by the number of tests that are
            made together, as at the strictest step of Holm's procedure.
    """
    losses = 1
    while mcnemar(losses, 0) > level:
        losses += 1
    return losses


def power(pairs: int, loss: float, win: float = 0.0, level: float = ALPHA) -> float:
    """Probability that McNemar's test detects a loss.

    Args:
        pairs: Number of seeds that are run before and after.
        loss: Probability that a pair is lost.
        win: Probability that a pair is won.
        level: See `fewest_losses`.
    """
    differ = loss + win
    # SciPy's binomial distribution overflows at the smallest probabilities.
    if differ < 1e-12:
        return 0.0
    counts = np.arange(pairs + 1)
    called = binom.sf(_critical(pairs, level) - 1, counts, loss / differ)
    return float(np.sum(binom.pmf(counts, pairs, min(differ, 1.0)) * called))


def noticeable_drop(pairs: int, win: float = 0.0, level: float = ALPHA) -> float | None:
    """The noise floor: the smallest drop of success that is detected with power `POWER`.

    Args:
        pairs: Number of seeds that are run before and after.
        win: Probability that a pair is won. Won pairs hide losses.
        level: See `fewest_losses`.

    Returns:
        Success before minus success now, 0 to 1; None if not even a total loss is detected.
    """

    def short(drop: float) -> float:
        return power(pairs, win + drop, win, level) - POWER

    most = 1.0 - 2.0 * win
    if pairs == 0 or most <= 0.0 or short(most) < 0.0:
        return None
    return float(brentq(short, 0.0, most, xtol=1e-6))


@cache
def _critical_cached(pairs: int, level: float) -> tuple[int, ...]:
    critical = []
    for differ in range(pairs + 1):
        # The smallest number of losses whose p value is small enough.
        losses = int(binom.isf(level, differ, 0.5)) + 1
        while losses > 0 and mcnemar(losses - 1, differ - losses + 1) <= level:
            losses -= 1
        while losses <= differ and mcnemar(losses, differ - losses) > level:
            losses += 1
        critical.append(losses)
    return tuple(critical)


def _critical(pairs: int, level: float) -> NDArray[np.int64]:
    """(pairs + 1,): smallest significant number of losses for 0, 1, 2 ... pairs that differ."""
    return np.array(_critical_cached(pairs, level))
