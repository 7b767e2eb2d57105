"""Results of a study in numbers: person means, and statistics of these by SciPy.

The person is the unit of analysis: a person's trials under one condition give one number, their
mean. Two levels of a factor are compared by the differences of these means within people, or
between groups of people. Models are fitted by `analysis.R`, not here.

With fewer than `FEWEST` people there is no interval and no p value. Intervals are cut at the limits
of the outcome.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from math import inf, isfinite, nan

import numpy as np

from models.arithmetic import Array
from sandbox.study.report.data import (
    SESSION,
    Measure,
    ObservedFactor,
    StudyData,
    Values,
    row_means,
    score_values,
    trial_values,
)

FEWEST = 6
"""Smallest number of people for an interval or a p value."""
ALPHA = 0.05
"""Largest probability that a study without any real difference has a false finding."""
LEVEL = 0.95
"""Coverage of intervals."""
EXACT = 13
"""Largest number of people for whom all 2^n flips of signs are tried."""
DRAWN = 9_999
"""Number of random flips of signs for more people."""
LARGE = 50
"""Size of the larger group from which on the Mann-Whitney test uses the normal distribution, even
without ties."""
EQUAL = 1e-6
"""Values that differ by at most this share of the largest value differ only by rounding."""
CONFIRMATORY, EXPLORATORY = "confirmatory", "exploratory"
MAIN = ("time_s", "success")
"""Outcomes that are compared in every study."""


@dataclass(frozen=True)
class Estimate:
    """A value with its 95 % interval from `low` to `high`; nan for unknown numbers."""

    value: float = nan
    low: float = nan
    high: float = nan

    @property
    def is_known(self) -> bool:
        """True if the interval is known."""
        return isfinite(self.low) and isfinite(self.high)


@dataclass(frozen=True)
class Mean:
    """The mean over people of an outcome under one condition.

    Attributes:
        name: The condition, or the level of a factor.
        people, trials: Numbers of people and of trials.
        mean: Mean over people, each counted once; a geometric mean for a logarithmic outcome.
    """

    name: str
    people: int
    trials: int
    mean: Estimate


@dataclass(frozen=True)
class Pair:
    """The comparison of two levels of a factor.

    Attributes:
        factor: Name of the factor.
        first, second: The levels. The second level is compared with the first.
        kind: `difference` (second minus first) or `ratio` (second divided by first).
        people: Number of people who did both levels; for two groups, of all people.
        estimate: Mean difference or ratio, with its interval.
        sd: Standard deviation over people of the difference, or, for ratios, of its logarithm. For
            two groups, the standard deviation within groups.
        dz: Difference divided by `sd`; for two groups, Cohen's d.
        median: Median over people of the difference or ratio; for two groups, the difference of
            their medians.
        test: Name of the test.
        p: P value of the test; nan if it cannot be computed.
        p_holm: P value adjusted for all tests of the study; nan for an exploratory comparison.
        why: Reason for a missing estimate; empty with an estimate.
    """

    factor: str
    first: str
    second: str
    kind: str
    people: int = 0
    estimate: Estimate = field(default_factory=Estimate)
    sd: float = nan
    dz: float = nan
    median: float = nan
    test: str = ""
    p: float = nan
    p_holm: float = nan
    why: str = ""

    @property
    def title(self) -> str:
        """The two levels as text, such as `soft against hard`."""
        return f"{self.second} against {self.first}"


@dataclass(frozen=True)
class Compared:
    """An outcome and its comparisons.

    Attributes:
        what: The outcome.
        values: Person means; see `Values`.
        cells: Means by condition.
        levels: Means by level of each factor with several levels.
        pairs: Comparisons of all pairs of levels.
        interactions: Differences of differences for the first two factors, each with its name and
            number of people; they are exploratory.
        role: `CONFIRMATORY` if the pairs are tested, else `EXPLORATORY`.
    """

    what: Measure
    values: Values
    cells: tuple[Mean, ...]
    levels: dict[str, tuple[Mean, ...]]
    pairs: tuple[Pair, ...]
    interactions: tuple[tuple[str, Estimate, int], ...] = ()
    role: str = EXPLORATORY


@dataclass(frozen=True)
class Results:
    """All results of a study.

    Attributes:
        data: The study.
        compared: Outcomes that are compared; tested outcomes come first.
        missing: Primary outcomes that these data cannot compare.
        tests: Number of tests for which p values are adjusted.
    """

    data: StudyData
    compared: tuple[Compared, ...]
    missing: tuple[str, ...]
    tests: int

    def of(self, name: str) -> Compared | None:
        """The comparisons of an outcome; None if it is not compared."""
        return next((c for c in self.compared if c.what.name == name), None)


def results(data: StudyData, asked: Sequence[str] = ()) -> Results:
    """Compares the outcomes of a study.

    The primary outcomes of the design are tested. Without primary outcomes, time, success, the
    requested measures and one score of every questionnaire are tested. All tests are one family:
    their p values are adjusted together (Holm 1979). A pair with an estimate but too few people for
    a test also counts in the family, so that missing data do not make other differences more
    certain.

    Args:
        data: The study.
        asked: Names of further measures to compare.

    Raises:
        StudyError: A measure does not exist, or has no numbers.
    """
    every = {what.name: (what, values) for what, values in _outcomes(data, asked)}
    planned = data.primary or tuple(every)
    order = [*(name for name in planned if name in every), *(n for n in every if n not in planned)]
    compared = [_compare(data, *every[name]) for name in order]
    # Sessions are a factor of the report, not of the design: their differences are not tested.
    tested = [
        (i, j)
        for i, one in enumerate(compared)
        for j, pair in enumerate(one.pairs)
        if one.what.name in planned and not (pair.factor == SESSION and data.by_session)
    ]
    pairs = [compared[i].pairs[j] for i, j in tested]
    untested = sum(not pair.why and not isfinite(pair.p) for pair in pairs)
    adjusted = holm([pair.p for pair in pairs], untested)
    by_pair = dict(zip(tested, adjusted, strict=True))
    compared = [
        replace(
            one,
            role=CONFIRMATORY if one.what.name in planned else EXPLORATORY,
            pairs=tuple(
                replace(pair, p_holm=by_pair[i, j]) if (i, j) in by_pair else replace(pair, p=nan)
                for j, pair in enumerate(one.pairs)
            ),
        )
        for i, one in enumerate(compared)
    ]
    found = {one.what.name for one in compared if one.pairs}
    missing = tuple(name for name in data.primary if name not in found)
    return Results(data, tuple(compared), missing, sum(isfinite(p) for p in adjusted))


def _outcomes(data: StudyData, asked: Sequence[str]) -> list[tuple[Measure, Values]]:
    """Outcomes that are compared, with their person means."""
    scores = score_values(data)
    names = [*MAIN, *(n for n in data.primary if n in data.used.columns), *asked]
    found = []
    for name in dict.fromkeys(names):
        what = data.measure(name, must=name in asked)
        if what is not None:
            found.append((what, trial_values(data, what)))
    return [*found, *scores]


def _compare(data: StudyData, what: Measure, values: Values) -> Compared:
    factors = [f for f in values.factors if len(f.levels) > 1]
    pairs = [
        _pair(what, values, factor, first, second)
        for factor in factors
        for first, second in combinations(factor.levels, 2)
    ]
    return Compared(
        what,
        values,
        tuple(mean_of(what, values, name, [i]) for i, name in enumerate(values.names)),
        {
            f.name: tuple(mean_of(what, values, x, values.cells_of(f, x)) for x in f.levels)
            for f in factors
        },
        tuple(pair for pair in pairs if pair.people or pair.why),
        tuple(_interactions(what, values, factors)),
    )


def mean_of(what: Measure, values: Values, name: str, cells: Sequence[int]) -> Mean:
    """The mean over people of an outcome under some conditions together.

    Args:
        what: The outcome.
        values: Person means of the outcome.
        name: Name of the result: the condition, or the level that these conditions have.
        cells: Indices of the conditions.
    """
    own = row_means(values.means[:, list(cells)])
    own = own[np.isfinite(own)]
    trials = int(values.trials[:, list(cells)].sum())
    estimate = interval(own, *what.forward_limits)
    return Mean(name, len(own), trials, what.in_unit(estimate))


def interval(values: Array, low: float = -inf, high: float = inf) -> Estimate:
    """Mean of the values of people, with Student's interval cut at the possible values.

    Args:
        values: (n,) values.
        low, high: Smallest and largest possible value.
    """
    from scipy import stats

    if not len(values):
        return Estimate()
    mean = float(np.mean(values))
    if len(values) < FEWEST or _equal(values):
        return Estimate(mean)
    found = stats.ttest_1samp(values, 0.0).confidence_interval(LEVEL)
    return Estimate(mean, max(float(found.low), low), min(float(found.high), high))


def _equal(values: Array) -> bool:
    """True if values differ only by rounding, so that their spread has no meaning."""
    return float(np.ptp(values)) <= EQUAL * max(float(np.abs(values).max()), 2.0 * EQUAL)


def _pair(what: Measure, values: Values, factor: ObservedFactor, first: str, second: str) -> Pair:
    """Compares two levels within the people who did both, or, if there are none, between groups."""
    pair = Pair(factor.name, first, second, "ratio" if what.scale == "log" else "difference")
    matched = values.matched(factor, first, second)
    own = paired_differences(values, factor, first, second)
    own = own[np.isfinite(own)]
    if any(values.limit(a) != values.limit(b) for a, b in matched) and what.scale == "limit":
        return replace(pair, why="their time limits differ")
    if len(own):
        return _paired(what, pair, own)
    sides = [row_means(values.means[:, values.cells_of(factor, x)]) for x in (first, second)]
    groups = [side[np.isfinite(side)] for side in sides]
    if min(map(len, groups)) == 0 or (np.isfinite(sides[0]) & np.isfinite(sides[1])).any():
        return pair
    return _between(what, pair, *groups)


def paired_differences(values: Values, factor: ObservedFactor, first: str, second: str) -> Array:
    """Each person's difference (people,) between two levels; nan for people without both levels.

    If there are pairs of conditions that differ only in these levels, the difference is the mean
    over these pairs. Otherwise it is the difference of the means over all conditions.
    """
    matched = values.matched(factor, first, second)
    if matched:
        one, other = ([values.means[:, pair[i]] for pair in matched] for i in (0, 1))
        return row_means(np.column_stack(other) - np.column_stack(one))
    sides = [row_means(values.means[:, values.cells_of(factor, x)]) for x in (first, second)]
    return sides[1] - sides[0]


def _paired(what: Measure, pair: Pair, own: Array) -> Pair:
    """Compares two levels by the differences (n,) of people who did both."""
    low, high = what.forward_limits
    pair = replace(
        pair,
        people=len(own),
        estimate=what.in_unit(interval(own, low - high, high - low)),
        median=what.in_unit(Estimate(float(np.median(own)))).value,
    )
    if len(own) < 2 or _equal(own):
        return pair
    sd = float(np.std(own, ddof=1))
    pair = replace(pair, sd=sd, dz=float(np.mean(own)) / sd)
    if len(own) < FEWEST:
        return pair
    if what.scale == "score":
        return replace(pair, test="Wilcoxon", p=wilcoxon(own))
    if what.scale in ("share", "count"):
        return replace(pair, test="sign flips", p=sign_flips(own))
    return replace(pair, test="paired t", p=paired_t(own))


def _between(what: Measure, pair: Pair, one: Array, other: Array) -> Pair:
    """Compares two groups of people."""
    difference = float(np.mean(other) - np.mean(one))
    pair = replace(
        pair,
        people=len(one) + len(other),
        estimate=what.in_unit(Estimate(difference)),
        median=what.in_unit(Estimate(float(np.median(other) - np.median(one)))).value,
    )
    if min(len(one), len(other)) < 2 or (_equal(one) and _equal(other)):
        return pair
    squares = ((one - one.mean()) ** 2).sum() + ((other - other.mean()) ** 2).sum()
    sd = float(np.sqrt(squares / (pair.people - 2)))
    pair = replace(pair, sd=sd, dz=difference / sd)
    if min(len(one), len(other)) < FEWEST:
        return pair
    found, p = welch(one, other)
    low, high = what.forward_limits
    estimate = Estimate(difference, max(found.low, low - high), min(found.high, high - low))
    pair = replace(pair, estimate=what.in_unit(estimate))
    if what.scale == "score":
        return replace(pair, test="Mann-Whitney", p=mann_whitney(one, other))
    return replace(pair, test="Welch", p=p)


def paired_t(own: Array) -> float:
    """P value of Student's t test of differences (n,)."""
    from scipy import stats

    return float(stats.ttest_1samp(own, 0.0).pvalue)


def welch(one: Array, other: Array) -> tuple[Estimate, float]:
    """Difference of the means of two groups (n,), (m,), with Welch's interval and p value."""
    from scipy import stats

    test = stats.ttest_ind(other, one, equal_var=False)
    ends = test.confidence_interval(LEVEL)
    difference = float(np.mean(other) - np.mean(one))
    return Estimate(difference, float(ends.low), float(ends.high)), float(test.pvalue)


def mann_whitney(one: Array, other: Array) -> float:
    """P value of the Mann-Whitney test of two groups (n,), (m,).

    It is exact for groups below `LARGE` without ties.
    """
    from scipy import stats

    every = np.concatenate([one, other])
    exact = len(set(every.tolist())) == len(every) and max(len(one), len(other)) < LARGE
    method = "exact" if exact else "asymptotic"
    return float(stats.mannwhitneyu(other, one, method=method).pvalue)


def sign_flips(own: Array) -> float:
    """P value of a permutation test of the mean of differences (n,), which flips their signs.

    For at most `EXACT` people, all 2^n flips are tried. For more people, `DRAWN` random flips are
    tried, always with the same seed.
    """
    from scipy import stats

    drawn = inf if len(own) <= EXACT else DRAWN
    found = stats.permutation_test(
        (own,),
        np.mean,
        permutation_type="samples",
        vectorized=True,
        n_resamples=drawn,
        rng=np.random.default_rng(0),
    )
    return float(found.pvalue)


def wilcoxon(own: Array) -> float:
    """P value of Wilcoxon's signed-rank test of differences (n,); nan if all are 0.

    With ties, it comes from `sign_flips` of the signed ranks. Tables have six decimals, so
    differences that agree in five decimals are ties.
    """
    from scipy import stats

    own = np.round(own, 5)
    own = own[own != 0.0]
    if not len(own):
        return nan
    ranks = stats.rankdata(np.abs(own))
    if len(set(ranks.tolist())) == len(ranks):
        return float(stats.wilcoxon(own, method="exact" if len(own) <= 50 else "approx").pvalue)
    return sign_flips(np.sign(own) * ranks)


def _interactions(
    what: Measure, values: Values, factors: Sequence[ObservedFactor]
) -> list[tuple[str, Estimate, int]]:
    """Name, estimate and number of people of each difference of differences of the first two
    factors."""
    if len(factors) < 2:
        return []
    one, other = factors[:2]
    found = []
    for first, second in combinations(one.levels, 2):
        for at, against in combinations(other.levels, 2):
            sides = []
            for level in (at, against):
                inside = set(values.cells_of(other, level))
                matched = [(a, b) for a, b in values.matched(one, first, second) if a in inside]
                differences = [values.means[:, b] - values.means[:, a] for a, b in matched]
                sides.append(row_means(np.column_stack(differences)) if matched else None)
            if sides[0] is None or sides[1] is None:
                continue
            own = sides[1] - sides[0]
            own = own[np.isfinite(own)]
            if len(own):
                name = f"{second} against {first}: {against} against {at}"
                most = 2.0 * (what.forward_limits[1] - what.forward_limits[0])
                estimate = what.in_unit(interval(own, -most, most))
                found.append((name, estimate, len(own)))
    return found


def holm(p: Sequence[float], untested: int = 0) -> list[float]:
    """P values adjusted by Holm's method; nan stays nan.

    Args:
        p: P values; nan for a test that was not made.
        untested: Number of tests of the family that were not made. Each counts as p = 1.
    """
    known = sorted((value, i) for i, value in enumerate(p) if isfinite(value))
    adjusted = [nan] * len(p)
    largest = 0.0
    for rank, (value, i) in enumerate(known):
        largest = max(largest, min(1.0, (len(known) + untested - rank) * value))
        adjusted[i] = largest
    return adjusted
