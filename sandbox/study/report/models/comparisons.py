"""Comparisons of conditions: pairs of levels, averaged over the other factors."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from itertools import combinations
from math import nan, sqrt
from typing import TYPE_CHECKING

import numpy as np

from sandbox.study.report.models.data import ObservedFactor, StudyData
from sandbox.study.report.models.intervals import Estimate, t_quantile

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
        """Title for tables."""
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


@dataclass(frozen=True)
class Counts:
    """Numbers of people behind a comparison.

    Attributes:
        freedom: Degrees of freedom: those of a t test, paired or between people.
        effective: Number by which a squared standard deviation is divided to give the squared
            error: people of a paired comparison, n1 n2 / (n1 + n2) of two groups.
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


def t_difference(pair: Pair, value: float, error: float, people: Counts) -> Difference:
    """A difference whose estimate is t distributed.

    If all people have the same difference, the data do not tell its error.
    """
    from scipy import stats

    if not (np.isfinite(value) and np.isfinite(error) and error > 0 and people.freedom > 0):
        return Difference(pair, Estimate(value, nan, nan), nan, people, nan)
    half = t_quantile(people.freedom) * error
    p = float(2 * stats.t.sf(abs(value) / error, people.freedom))
    return Difference(pair, Estimate(value, value - half, value + half), error, people, p)


def counts_of(pair: Pair, rows: DataFrame) -> Counts:
    """Numbers of people behind a comparison.

    Args:
        pair: The compared levels.
        rows: Rows of `data.used`.
    """
    levels = rows[["ppid", pair.factor.column]].drop_duplicates()
    count = rows["ppid"].nunique()
    if pair.factor.within:
        return Counts(count - 1.0, float(count))
    groups = levels[pair.factor.column].value_counts()
    first, second = groups.get(pair.first, 0), groups.get(pair.second, 0)
    effective = first * second / (first + second) if first + second else nan
    return Counts(float(count - len(groups)), float(effective))
