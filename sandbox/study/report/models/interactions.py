"""Simple effects and interactions: how a difference between two levels depends on another factor.

A simple effect is the difference between two levels of a factor at one level of another. An
interaction is the difference between two simple effects. Both are exploratory. Their errors are
from the people's own values (jackknife, or shares of single people), so that they allow for an
effect that differs between people at every level.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import combinations
from math import nan
from typing import TYPE_CHECKING

import numpy as np

from sandbox.study.report.models.censored import Censored, bounded_difference
from sandbox.study.report.models.comparisons import Counts, Pair, pairs_of, t_difference
from sandbox.study.report.models.data import ObservedFactor, StudyData
from sandbox.study.report.models.intervals import Estimate, correlation_of, difference
from sandbox.study.report.models.success import rates, success_differences

if TYPE_CHECKING:
    from pandas import DataFrame

SIMPLE, INTERACTION = "simple effect", "interaction"


@dataclass(frozen=True)
class Dependence:
    """A simple effect or an interaction.

    Attributes:
        kind: `SIMPLE` or `INTERACTION`.
        pair: The compared levels; `pair.at` is the level of the other factor.
        other: The other factor.
        against: For an interaction, the level of the other factor whose simple effect is
            subtracted; otherwise empty.
        estimate: Estimate on the model's scale.
    """

    kind: str
    pair: Pair
    other: ObservedFactor
    against: str
    estimate: Estimate

    @property
    def title(self) -> str:
        """Title for tables."""
        return f"{self.pair.title} against {self.against}" if self.against else self.pair.title


@dataclass(frozen=True)
class _Crossing:
    """A pair of levels at two levels of another factor, under equal circumstances."""

    other: ObservedFactor
    first: Pair
    second: Pair


def model_dependences(data: StudyData, model: Censored, factor: ObservedFactor) -> list[Dependence]:
    """Simple effects and interactions of a factor by a model of conditions."""
    dependences = [
        Dependence(SIMPLE, pair, other, "", bounded_difference(data, model, pair).estimate)
        for pair, other in _simple_pairs(data, factor, set(model.present))
    ]
    for one in _crossings(data, factor, set(model.present)):
        count = len(data.conditions)
        weights = model.weights(one.second, count) - model.weights(one.first, count)
        value = float(weights @ model.coefficients)
        told = t_difference(
            one.second, value, model.error(weights), _counts(model.rows, factor, one)
        )
        dependences.append(
            Dependence(INTERACTION, one.second, one.other, one.first.at, told.estimate)
        )
    return dependences


def share_dependences(data: StudyData, name: str, factor: ObservedFactor) -> list[Dependence]:
    """Simple effects and interactions of a factor in success, or another measure of 0 and 1."""
    simple = _simple_pairs(data, factor)
    told = success_differences(data, name, [pair for pair, _ in simple])
    dependences = [
        Dependence(SIMPLE, pair, other, "", d.estimate)
        for (pair, other), d in zip(simple, told, strict=True)
    ]
    _, own, _ = rates(data, name)
    for one in _crossings(data, factor):
        first, second = success_differences(data, name, [one.first, one.second])
        tied = _correlation(own, one) if factor.within and one.other.within else 0.0
        both = difference(second.estimate, first.estimate, tied, most=2.0)
        dependences.append(Dependence(INTERACTION, one.second, one.other, one.first.at, both))
    return dependences


def _simple_pairs(
    data: StudyData, factor: ObservedFactor, present: set[int] | None = None
) -> list[tuple[Pair, ObservedFactor]]:
    """Pairs of levels of a factor at every level of every other factor that is crossed with it."""
    pairs = []
    for pair, other, level in _pairs(data, factor, present):
        for at in other.levels:
            cells = tuple(c for c in pair.cells if level[c[0]] == at)
            if cells:
                pairs.append((replace(pair, cells=cells, at=at), other))
    return pairs


def _crossings(
    data: StudyData, factor: ObservedFactor, present: set[int] | None = None
) -> list[_Crossing]:
    """Pairs of levels of a factor at two levels of another, with equal levels of all others."""
    crossings = []
    names = [f.column for f in data.factors]
    seen = data.used[["cell", *names]].drop_duplicates("cell").set_index("cell")
    for pair, other, level in _pairs(data, factor, present):
        rest = [n for n in names if n not in (factor.column, other.column)]
        around = {c: tuple(seen.loc[c[0], rest]) for c in pair.cells}
        for first, second in combinations(other.levels, 2):
            one, two = (
                {around[c]: c for c in pair.cells if level[c[0]] == at} for at in (first, second)
            )
            both = [key for key in one if key in two]
            if both:
                cells = (tuple(some[key] for key in both) for some in (one, two))
                pairs = (
                    replace(pair, cells=some, at=at)
                    for some, at in zip(cells, (first, second), strict=True)
                )
                crossings.append(_Crossing(other, *pairs))
    return crossings


def _pairs(
    data: StudyData, factor: ObservedFactor, present: set[int] | None
) -> list[tuple[Pair, ObservedFactor, dict[int, str]]]:
    """Pairs of levels of a factor, each with another factor and its level in every condition."""
    pairs = []
    for other in data.factors:
        if other.name == factor.name or len(other.levels) < 2:
            continue
        level = dict(zip(data.used["cell"], data.used[other.column], strict=True))
        pairs += [
            (pair, other, level)
            for pair in pairs_of(data, present)
            # A nested factor has no level in common.
            if pair.factor.name == factor.name and len({level[c] for c, _ in pair.cells}) > 1
        ]
    return pairs


def _counts(rows: DataFrame, factor: ObservedFactor, crossing: _Crossing) -> Counts:
    """Numbers of people behind an interaction: those with rows in its conditions."""
    between = [f.column for f in (factor, crossing.other) if not f.within]
    cells = {c for pair in (crossing.first, crossing.second) for both in pair.cells for c in both}
    rows = rows[rows["cell"].isin(cells)]
    people = rows["ppid"].nunique()
    groups = len(rows[between].drop_duplicates()) if between else 1
    return Counts(float(people - groups), nan if between else float(people))


def _correlation(own: np.ndarray, crossing: _Crossing) -> float:
    """Correlation of people's own differences at the two levels of the other factor."""
    a, b = (
        np.mean([own[:, second] - own[:, first] for first, second in pair.cells], axis=0)
        for pair in (crossing.first, crossing.second)
    )
    both = np.isfinite(a) & np.isfinite(b)
    a, b = a[both], b[both]
    return correlation_of(a, b)
