"""Comparisons of conditions: pairs of levels, averaged over the other factors."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from itertools import combinations
from math import nan

import numpy as np

from sandbox.study.report.models.data import ObservedFactor, StudyData
from sandbox.study.report.models.intervals import Estimate, t_quantile


@dataclass(frozen=True)
class Pair:
    """Two levels of a factor: `second` compared with `first`.

    Attributes:
        factor: The factor.
        first, second: The levels; the first is the earlier one in the design.
        cells: Numbers of the conditions with the first and the second level, for each combination
            of the other factors in which both occur.
    """

    factor: ObservedFactor
    first: str
    second: str
    cells: tuple[tuple[int, int], ...]

    @property
    def title(self) -> str:
        """Title for tables."""
        return f"{self.second} against {self.first}"

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
class Difference:
    """Difference between a pair of levels.

    Attributes:
        pair: The levels.
        estimate: Second minus first, on the model's scale.
        error: Standard error.
        freedom: Degrees of freedom of the t distribution.
        p: P value of this pair alone; nan where it cannot be computed.
    """

    pair: Pair
    estimate: Estimate
    error: float
    freedom: float
    p: float


def t_difference(pair: Pair, value: float, error: float, freedom: float) -> Difference:
    """A difference whose estimate is t distributed."""
    from scipy import stats

    if not (np.isfinite(value) and np.isfinite(error) and freedom > 0):
        return Difference(pair, Estimate(value, nan, nan), nan, freedom, nan)
    half = t_quantile(freedom) * error
    p = nan if error <= 0 else float(2 * stats.t.sf(abs(value) / error, freedom))
    return Difference(pair, Estimate(value, value - half, value + half), error, freedom, p)


def freedom_of(factor: ObservedFactor, people: Iterable[tuple[str, str]]) -> float:
    """Degrees of freedom of a comparison: those of a t test, paired or between people.

    Args:
        factor: The compared factor.
        people: Pseudonym and level of all people; repetitions are allowed.
    """
    seen = set(people)
    count = len({ppid for ppid, _ in seen})
    return count - 1.0 if factor.within else float(count - len({level for _, level in seen}))
