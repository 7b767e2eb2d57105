"""Confidence intervals of means over people and of shares of trials.

People are the independent units: all intervals allow for the dependence of one person's trials.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf, nan, sqrt

import numpy as np

LEVEL = 0.95
"""Probability that an interval covers the truth."""
ROUNDING = 2e-6
"""Spread that equal values can have: tables have six decimals, so that two equal differences of
their values can be so far apart."""
PRECISION = 1e-6
"""The same by computation, relative to the largest value: models add up squares, in which half of
the digits are lost."""


def has_spread(spread: float, *values: float) -> bool:
    """True if a spread, or an error, is larger than rounding makes it of equal values.

    Args:
        spread: The spread; nan has none.
        values: The values, or the largest of them.
    """
    largest = max(map(abs, values), default=0.0)
    return bool(spread > max(ROUNDING, PRECISION * largest))


@dataclass(frozen=True)
class Estimate:
    """A number with its interval; nan if it cannot be computed."""

    value: float
    low: float
    high: float

    def bounded(self, low: float, high: float) -> Estimate:
        """Ends that are outside of the possible values become the lowest or highest of them."""
        return Estimate(self.value, max(self.low, low), min(self.high, high))

    def mapped(self, function: Callable[[float], float]) -> Estimate:
        """Applies a function to the number and to both ends."""
        return Estimate(function(self.value), function(self.low), function(self.high))


def t_quantile(freedom: float) -> float:
    """Two-sided quantile of Student's t for `LEVEL`; infinite without degrees of freedom."""
    from scipy import stats

    return float(stats.t.ppf(0.5 + LEVEL / 2, freedom)) if freedom > 0 else inf


def mean_interval(values: Sequence[float]) -> Estimate:
    """A mean over people with Student's interval; the interval of a single person is nan, and so is
    that of equal values, which do not tell how much others would differ."""
    x = np.asarray(values, dtype=float)
    x = x[np.isfinite(x)]
    if not len(x):
        return Estimate(nan, nan, nan)
    if len(x) < 2 or not has_spread(float(np.ptp(x)), *x):
        return Estimate(float(x[0]), nan, nan)
    half = t_quantile(len(x) - 1) * float(x.std(ddof=1)) / sqrt(len(x))
    return Estimate(float(x.mean()), float(x.mean()) - half, float(x.mean()) + half)


def within_intervals(table: np.ndarray) -> list[Estimate]:
    """Means of conditions with intervals for comparisons, without differences between people.

    Cousineau 2005, corrected as in Morey 2008, for each set of conditions that the same people
    have. People who lack one of these are left out of the half-widths, not of the means. A
    condition whose people have no other one has the interval of its mean.

    Args:
        table: (people, conditions); nan if missing.
    """
    means = [mean_interval(column[np.isfinite(column)]) for column in table.T]
    spread, people = within_spread(table)
    largest = max(map(abs, table[np.isfinite(table)].tolist()), default=0.0)
    found = []
    for mean, deviation, count in zip(means, spread.tolist(), people.tolist(), strict=True):
        if count == 0:
            found.append(mean)
            continue
        known = has_spread(deviation, largest)
        half = t_quantile(count - 1) * deviation / sqrt(count) if known else nan
        found.append(Estimate(mean.value, mean.value - half, mean.value + half))
    return found


def within_spread(table: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Standard deviations without differences between people.

    Args:
        table: (people, conditions); people who lack a condition that others of their set have are
            left out.

    Returns:
        (conditions,) deviations, nan where fewer than two people have all conditions of the set;
        and (conditions,) numbers of these people, 0 where people have no other condition, and
        otherwise at least 1.
    """
    spread, people = np.full(table.shape[1], nan), np.zeros(table.shape[1], int)
    for some in shared_conditions(table):
        if len(some) < 2:
            continue
        whole = table[:, some]
        whole = whole[np.isfinite(whole).all(axis=1)]
        people[some] = max(len(whole), 1)
        if len(whole) > 1:
            centred = whole - whole.mean(axis=1, keepdims=True)
            spread[some] = centred.std(axis=0, ddof=1) * sqrt(len(some) / (len(some) - 1))
    return spread, people


def shared_conditions(table: np.ndarray) -> list[list[int]]:
    """Sets of conditions, by index, such that nobody has conditions of two: those of each group.

    Args:
        table: (people, conditions); nan if missing.
    """
    sets: list[set[int]] = [{i} for i in range(table.shape[1])]
    for row in np.isfinite(table):
        mine = set(np.flatnonzero(row).tolist())
        joined = [each for each in sets if each & mine]
        if len(joined) > 1:
            sets = [each for each in sets if not each & mine] + [set().union(*joined)]
    return sorted(sorted(each) for each in sets)


@dataclass(frozen=True)
class Share:
    """A share of trials.

    Attributes:
        value: Mean over people of their own shares.
        low, high: Wilson's interval with `effective` trials.
        effective: Effective number of independent trials.
    """

    value: float
    low: float
    high: float
    effective: float


def share(
    rates: Sequence[float],
    trials: Sequence[int],
    effect: float = 1.0,
    deviation: float | None = None,
) -> Share:
    """A share of trials of several people, with Wilson's interval for clustered trials.

    The number of trials is divided by the design effect, as in Saha, Miller and Wang 2016; the
    quantile is Student's, as people are few.

    Args:
        rates: Share of each person.
        trials: Number of trials of each person.
        effect: Design effect to be assumed if the rates do not determine it: all 0 or all 1.
        deviation: Standard deviation over people of their rates, if another one than that of the
            rates themselves is meant, such as one without differences between people.
    """
    x, n = np.asarray(rates, dtype=float), np.asarray(trials, dtype=float)
    people, total = len(x), float(n.sum())
    if not people:
        return Share(nan, nan, nan, 0.0)
    p = float(x.mean())
    if people < 2:
        # The interval of a single person is about that person only.
        low, high = _wilson(p, total, t_quantile(1e6))
        return Share(p, low, high, total)
    spread = (float(x.var(ddof=1)) if deviation is None else deviation**2) / people
    effective = total / max(effect, 1.0)
    if has_spread(sqrt(spread)) and 0.0 < p < 1.0:
        effective = min(total, p * (1.0 - p) / spread)
    low, high = _wilson(p, effective, t_quantile(people - 1))
    return Share(p, low, high, effective)


def design_effect(rates: Sequence[float], trials: Sequence[int]) -> float:
    """Variance of a share, divided by that of as many independent trials; at least 1."""
    x, n = np.asarray(rates, dtype=float), np.asarray(trials, dtype=float)
    if len(x) < 2:
        return 1.0
    p = float(x.mean())
    if not 0.0 < p < 1.0:
        return 1.0
    return max(1.0, float(x.var(ddof=1)) / len(x) * float(n.sum()) / (p * (1.0 - p)))


def _wilson(p: float, n: float, z: float) -> tuple[float, float]:
    if n <= 0:
        return 0.0, 1.0
    middle = (p + z * z / (2 * n)) / (1 + z * z / n)
    half = z * sqrt(p * (1 - p) / n + z * z / (4 * n * n)) / (1 + z * z / n)
    # Rounding must not put the share itself outside.
    return min(max(0.0, middle - half), p), max(min(1.0, middle + half), p)


def correlation_of(a: np.ndarray, b: np.ndarray) -> float:
    """Correlation of two values of the same people, each (people,); 0 where one has no spread."""
    known = len(a) > 1 and has_spread(float(np.ptp(a)), *a) and has_spread(float(np.ptp(b)), *b)
    return float(np.corrcoef(a, b)[0, 1]) if known else 0.0


def difference(
    a: Share | Estimate, b: Share | Estimate, correlation: float = 0.0, most: float = 1.0
) -> Estimate:
    """Difference `a` minus `b`, with combined limits of both: Newcombe 1998, Zou and Donner 2008.

    Its interval never has width zero, even if all trials succeeded.

    Args:
        a, b: Shares, or differences of shares.
        correlation: Correlation of people's values; 0 for different people.
        most: Largest possible difference: 1 of shares, 2 of their differences.
    """
    d = a.value - b.value

    def reach(x: float, y: float) -> float:
        return sqrt(max(0.0, x * x + y * y - 2.0 * correlation * x * y))

    low = d - reach(a.value - a.low, b.high - b.value)
    high = d + reach(a.high - a.value, b.value - b.low)
    return Estimate(d, max(-most, low), min(most, high))


def holm(ps: Sequence[float]) -> list[float]:
    """P values adjusted for their number (Holm 1979); nan stays nan."""
    known = sorted((p, i) for i, p in enumerate(ps) if np.isfinite(p))
    out = [nan] * len(ps)
    worst = 0.0
    for rank, (p, i) in enumerate(known):
        worst = max(worst, min(1.0, p * (len(known) - rank)))
        out[i] = worst
    return out
