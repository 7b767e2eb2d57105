"""Comparisons of conditions: pairs of levels, averaged over the other factors."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import nan, sqrt
from typing import TYPE_CHECKING, Protocol

import numpy as np

from sandbox.study.report.models.data import ObservedFactor, StudyData
from sandbox.study.report.models.intervals import Estimate, has_spread, t_quantile

if TYPE_CHECKING:
    from pandas import DataFrame


@dataclass(frozen=True)
class Pair:
    """Two levels of a factor: `second` compared with `first`.

    Attributes:
        factor: The factor.
        first, second: The levels; the first is the earlier one in the design.
        cells: Numbers of the conditions with the first and the second level, for each combination
            of the other factors in which both occur.
        at: Level of another factor, for a simple effect: the comparison at this level only.
    """

    factor: ObservedFactor
    first: str
    second: str
    cells: tuple[tuple[int, int], ...]
    at: str = ""

    @property
    def title(self) -> str:
        """Title for tables; see `titles_of` where there are pairs of several factors."""
        return f"{self.second} against {self.first}" + (f", {self.at}" if self.at else "")

    def weights(self, conditions: int) -> np.ndarray:
        """Weights (conditions,): the weighted sum of the conditions' means is the difference."""
        w = np.zeros(conditions)
        for first, second in self.cells:
            w[first] -= 1.0 / len(self.cells)
            w[second] += 1.0 / len(self.cells)
        return w


def pairs_of(data: StudyData, present: Collection[int] | None = None) -> list[Pair]:
    """All pairs of levels that occur with equal levels of the other factors.

    Args:
        data: Data of the study.
        present: Numbers of conditions that may be used; all by default.
    """
    names = [f.column for f in data.factors]
    seen = data.used[["cell", *names]].drop_duplicates("cell")
    pairs = []
    for factor in data.factors:
        others = [name for name in names if name != factor.column]
        where: dict[str, dict[tuple[str, ...], int]] = {}
        for row in seen.to_dict("records"):
            if present is None or row["cell"] in present:
                rest = tuple(row[name] for name in others)
                where.setdefault(row[factor.column], {})[rest] = int(row["cell"])
        for first, second in combinations(factor.levels, 2):
            one, two = where.get(first, {}), where.get(second, {})
            cells = tuple((one[rest], two[rest]) for rest in one if rest in two)
            if cells:
                pairs.append(Pair(factor, first, second, cells))
    return pairs


NEARLY_ALL = 0.8
"""Share of the people with one of two conditions who did both, from which on the standard deviation
of their differences follows from the error of the mean difference."""


@dataclass(frozen=True)
class Counts:
    """Numbers of people behind a comparison.

    Attributes:
        freedom: Degrees of freedom: those of a t test, paired or between people.
        effective: Number by which a squared standard deviation is divided to give the squared
            error: people of a paired comparison, n1 n2 / (n1 + n2) of two groups; nan where that
            is not known.
    """

    freedom: float
    effective: float


@dataclass(frozen=True)
class Difference:
    """Difference between a pair of levels.

    Attributes:
        pair: The levels.
        estimate: Second minus first, on the model's scale.
        error: Standard error.
        people: Numbers that the standard error depends on.
        p: P value of this pair alone; nan where it cannot be computed.
    """

    pair: Pair
    estimate: Estimate
    error: float
    people: Counts
    p: float

    @property
    def freedom(self) -> float:
        """Degrees of freedom of the t distribution."""
        return self.people.freedom

    @property
    def spread(self) -> float:
        """Standard deviation over people of the difference; of two groups, that within groups."""
        return self.error * sqrt(self.people.effective)

    @property
    def size(self) -> float:
        """Standardised effect: dz within people, Cohen's d between groups; nan if unknown."""
        return self.estimate.value / self.spread if self.spread > 0.0 else nan


class OfPair(Protocol):
    """What is about a pair of levels."""

    @property
    def pair(self) -> Pair: ...


def titles_of(some: Sequence[OfPair]) -> list[str]:
    """Titles of comparisons, with the factor where levels of two factors have the same names."""
    factors: dict[str, set[str]] = {}
    for one in some:
        factors.setdefault(one.pair.title, set()).add(one.pair.factor.name)
    return [
        f"{one.pair.factor.name}: {one.pair.title}"
        if len(factors[one.pair.title]) > 1
        else one.pair.title
        for one in some
    ]


def t_difference(
    pair: Pair, value: float, error: float, people: Counts, largest: float = 0.0
) -> Difference:
    """A difference whose estimate is t distributed.

    If all people have the same difference, but for rounding, the data do not tell its error.

    Args:
        pair: The levels.
        value: Second minus first.
        error: Its standard error.
        people: Numbers of people behind it.
        largest: Largest size of the compared values.
    """
    from scipy import stats

    known = np.isfinite(value) and np.isfinite(error) and has_spread(error, value, largest)
    if not (known and people.freedom > 0):
        return Difference(pair, Estimate(value, nan, nan), nan, people, nan)
    half = t_quantile(people.freedom) * error
    p = float(2 * stats.t.sf(abs(value) / error, people.freedom))
    return Difference(pair, Estimate(value, value - half, value + half), error, people, p)


def counts_of(pair: Pair, rows: DataFrame) -> Counts:
    """Numbers of people behind a comparison.

    Within people, the degrees of freedom are those of a paired t test of the people who did both
    conditions: who did one says little of differences, and nothing of how these vary. Where nobody
    did both, two groups are compared. The standard deviation of differences is known where nearly
    all did both: a mixed model also uses the others. Else the effective number is nan.

    Args:
        pair: The compared levels. A simple effect is of the people in its conditions only.
        rows: Rows of `data.used` that were compared.
    """
    sides = [set(rows["ppid"][rows["cell"].isin(cells)]) for cells in zip(*pair.cells, strict=True)]
    both, some = len(sides[0] & sides[1]), len(sides[0] | sides[1])
    if pair.factor.within:
        freedom = both - 1.0 if both else some - 2.0
        return Counts(freedom, float(both) if both >= NEARLY_ALL * some else nan)
    if pair.at:
        rows = rows[rows["ppid"].isin(sides[0] | sides[1])]
    levels = rows[["ppid", pair.factor.column]].drop_duplicates()
    count = rows["ppid"].nunique()
    groups = levels[pair.factor.column].value_counts()
    first, second = groups.get(pair.first, 0), groups.get(pair.second, 0)
    effective = first * second / (first + second) if first + second else nan
    return Counts(float(count - len(groups)), float(effective))
