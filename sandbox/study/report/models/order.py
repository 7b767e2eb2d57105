"""Effects of order: positions of levels, and change of times with practice."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sandbox.study.report.models.data import ObservedFactor, StudyData
from sandbox.study.report.models.intervals import Estimate, mean_interval
from sandbox.study.report.models.quantities import Quantity, rows_with

POINTS = 24
"""Maximum points of a learning curve; more trials are averaged."""


@dataclass(frozen=True)
class LevelPlace:
    """A level at one position in the order.

    Attributes:
        factor, level: Names of the factor and its level.
        place: Position of the level in the order, from 1, within the outer factors.
        times: Number of times that the level was at this position.
        mean: Mean of the measure, without differences between other conditions.
    """

    factor: str
    level: str
    place: int
    times: int
    mean: Estimate


def places(data: StudyData, what: Quantity, factor: ObservedFactor) -> list[LevelPlace]:
    """Means of every level of a factor at each of its positions."""
    rows, y = rows_with(data, what)
    outer = [f.column for f in data.factors[: data.factors.index(factor)]]
    level = rows[factor.column].to_numpy()
    corrected = _corrected(data, rows["cell"].to_numpy(int), y, level)
    at = rows[factor.place].to_numpy(int)
    seen = data.used[["ppid", *outer, factor.round, factor.column, factor.place]].drop_duplicates()
    often = Counter(zip(seen[factor.column], seen[factor.place], strict=True))
    result = []
    for name in factor.levels:
        for number in sorted({p for x, p in often if x == name}):
            mine = (level == name) & (at == number)
            means = _by_person(rows["ppid"].to_numpy()[mine], corrected[mine])
            result.append(
                LevelPlace(
                    factor.name,
                    name,
                    int(number),
                    often[name, number],
                    mean_interval(means).mapped(what.back),
                )
            )
    return result


def balanced(places: list[LevelPlace], factor: ObservedFactor) -> bool:
    """Returns True if every level was equally often at every position."""
    counts = {(p.level, p.place): p.times for p in places}
    number = len(factor.levels)
    return len(counts) == number * number and len(set(counts.values())) == 1


def neighbours(data: StudyData, factor: ObservedFactor) -> dict[tuple[str, str], int]:
    """Number of times that one level directly followed another, by pair of levels."""
    count: Counter[tuple[str, str]] = Counter()
    for _, levels in data.used.groupby("ppid", sort=False)[factor.column]:
        runs = [x for i, x in enumerate(levels) if i == 0 or x != levels.iloc[i - 1]]
        count.update(pairwise(runs))
    return dict(count)


@dataclass(frozen=True)
class LearningPoint:
    """A point of a learning curve.

    Attributes:
        level: Level of the factor.
        first, last: First and last of the averaged trials with this level, counted from 1.
        mean: Mean of the measure, without differences between other conditions.
        people: Number of people.
    """

    level: str
    first: int
    last: int
    mean: Estimate
    people: int


def learning(data: StudyData, what: Quantity, factor: ObservedFactor | None) -> list[LearningPoint]:
    """Means of a measure from trial to trial, by level of a factor or over all trials."""
    rows, y = rows_with(data, what)
    if not len(rows):
        return []
    number = rows["position" if factor is None else factor.count]
    level = np.full(len(rows), "all") if factor is None else rows[factor.column].to_numpy()
    corrected = _corrected(data, rows["cell"].to_numpy(int), y, level)
    size = int(np.ceil(number.max() / POINTS))
    step = (number.to_numpy(int) - 1) // size
    result = []
    for name in factor.levels if factor else ("all",):
        for k in sorted(set(step[level == name])):
            mine = (level == name) & (step == k)
            means = _by_person(rows["ppid"].to_numpy()[mine], corrected[mine])
            result.append(
                LearningPoint(
                    name,
                    int(k) * size + 1,
                    (int(k) + 1) * size,
                    mean_interval(means).mapped(what.back),
                    len(means),
                )
            )
    return result


def _corrected(data: StudyData, cell: np.ndarray, y: np.ndarray, level: np.ndarray) -> np.ndarray:
    """Values without the differences between conditions of the same level."""
    out = np.zeros_like(y)
    cells = {c: float(y[cell == c].mean()) for c in set(cell)}
    for name in set(level):
        inside = [cells[c] for c in sorted(set(cell[level == name]))]
        mine = level == name
        out[mine] = y[mine] - np.array([cells[c] for c in cell[mine]]) + np.mean(inside)
    return out


def _by_person(ppids: np.ndarray, values: np.ndarray) -> list[float]:
    return [float(values[ppids == ppid].mean()) for ppid in dict.fromkeys(ppids)]
