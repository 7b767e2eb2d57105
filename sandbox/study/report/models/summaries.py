"""Means of a measure over people, by condition and by level, with two kinds of interval.

All people have equal weights, whatever their number of trials: values are averaged within a person
and condition, then over conditions, then over people.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, nan

import numpy as np

from sandbox.study.report.models.data import ObservedFactor, StudyData
from sandbox.study.report.models.intervals import (
    Estimate,
    Share,
    design_effect,
    mean_interval,
    share,
    within_intervals,
    within_spread,
)
from sandbox.study.report.models.quantities import SHARE, Quantity, rows_with
from sandbox.study.report.models.success import rates


@dataclass(frozen=True)
class Summary:
    """Means of one condition or level.

    Attributes:
        name: Name of the condition or level.
        people, trials: Numbers of people and trials.
        mean: Mean with its interval over people.
        within: Mean with the interval for comparisons, without differences between people.
    """

    name: str
    people: int
    trials: int
    mean: Estimate
    within: Estimate


def person_means(data: StudyData, what: Quantity) -> np.ndarray:
    """Means (people, conditions) on the scale of the measure; nan without values."""
    rows, y = rows_with(data, what)
    people = {ppid: i for i, ppid in enumerate(data.ppids)}
    total = np.zeros((len(people), len(data.conditions)))
    count = np.zeros_like(total)
    where = (rows["ppid"].map(people).to_numpy(int), rows["cell"].to_numpy(int))
    np.add.at(total, where, y)
    np.add.at(count, where, 1.0)
    return np.divide(total, count, out=np.full_like(total, nan), where=count > 0)


def trials_of(data: StudyData, what: Quantity) -> np.ndarray:
    """Number of trials that have the measure, (conditions,)."""
    rows, _ = rows_with(data, what)
    return np.bincount(rows["cell"].to_numpy(int), minlength=len(data.conditions))


def cells_of(data: StudyData, factor: ObservedFactor) -> list[tuple[str, list[int]]]:
    """Levels of a factor, each with the numbers of its conditions."""
    seen = data.used[["cell", factor.column]].drop_duplicates()
    return [
        (level, [int(c) for c in seen.loc[seen[factor.column] == level, "cell"]])
        for level in factor.levels
        if (seen[factor.column] == level).any()
    ]


def summaries(
    data: StudyData, what: Quantity, factor: ObservedFactor | None = None
) -> list[Summary]:
    """Means by condition, or by level of a factor.

    Args:
        data: Data of the study.
        what: The measure.
        factor: The factor; None uses all conditions.
    """
    if not len(data.used):
        return []
    groups = (
        [(name, [i]) for i, name in enumerate(data.conditions)]
        if factor is None
        else cells_of(data, factor)
    )
    own, trials = person_means(data, what), trials_of(data, what)
    table = np.column_stack([row_means(own[:, cells]) for _, cells in groups])
    people = np.isfinite(table).sum(axis=0)
    within = [e.mapped(what.back) for e in within_intervals(table)]
    if what.scale == SHARE:
        means = [Estimate(s.value, s.low, s.high) for s in _shares(data, what, groups, table)]
        within = _shares_within(data, what, groups, table, means)
    else:
        means = [mean_interval(list(column)).mapped(what.back) for column in table.T]
    return [
        Summary(name, int(n), int(trials[cells].sum()), mean, inner)
        for (name, cells), n, mean, inner in zip(groups, people, means, within, strict=True)
    ]


def row_means(values: np.ndarray) -> np.ndarray:
    """Mean of the finite values in each row; nan if there is none."""
    known = np.isfinite(values)
    total = np.where(known, values, 0.0).sum(axis=1)
    count = known.sum(axis=1)
    return np.divide(total, count, out=np.full(len(values), nan), where=count > 0)


def _shares(
    data: StudyData,
    what: Quantity,
    groups: list[tuple[str, list[int]]],
    table: np.ndarray,
    spread: np.ndarray | None = None,
) -> list[Share]:
    """Shares with Wilson's intervals, for the people's own spread or for the given one."""
    _, own, done = rates(data, what.name)
    who = done.any(axis=1)
    usual = design_effect(list(row_means(own)[who]), [int(n) for n in done[who].sum(axis=1)])
    shares = []
    for i, ((_, cells), column) in enumerate(zip(groups, table.T, strict=True)):
        known = np.isfinite(column)
        trials = [int(n) for n in done[:, cells].sum(axis=1)[known]]
        deviation = None if spread is None or np.isnan(spread[i]) else float(spread[i])
        shares.append(share(list(column[known]), trials, usual, deviation))
    return shares


def _shares_within(
    data: StudyData,
    what: Quantity,
    groups: list[tuple[str, list[int]]],
    table: np.ndarray,
    means: list[Estimate],
) -> list[Estimate]:
    """Shares with intervals for comparisons, of the conditions of `within_intervals`."""
    spread, people = within_spread(table)
    found = []
    for s, mean, count in zip(
        _shares(data, what, groups, table, spread), means, people.tolist(), strict=True
    ):
        one = Estimate(s.value, s.low, s.high) if count > 1 else Estimate(s.value, nan, nan)
        found.append(mean if count == 0 else one)
    return found


def median_with_unseen(data: StudyData, cell: int) -> float:
    """Median time of the trials of a condition; trials without success count as infinitely long.

    The median is infinite if half of the trials or more had no success.
    """
    rows = data.used[data.used["cell"] == cell]
    if not len(rows):
        return nan
    times = np.where(rows["censored"], inf, rows["time_s"])
    ordered = np.sort(times)
    middle = len(ordered) // 2
    if len(ordered) % 2:
        return float(ordered[middle])
    return float((ordered[middle - 1] + ordered[middle]) / 2)
