"""Power of a comparison, before it is made: which changes so many seeds find, and what they cost.

A baseline has some of its trials a second time, with a change that makes nothing harder
(`REPEATED`). How far apart the times of such pairs are is the churn that any change of the last
digit brings about, and so the scatter in which a real change has to be found.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite, log, sqrt
from statistics import fmean
from typing import TYPE_CHECKING, Any

from sandbox.regress import statistics
from sandbox.regress.comparison import TOGETHER, level_of

if TYPE_CHECKING:
    from sandbox.regress.baseline import Baseline, BaselineTask

REPEATS = 10
"""Seeds of every task that a baseline has twice."""

REPEATED = "friction=1.0000001"
"""The variation of repeated trials: it changes their last digits, and nothing else."""

LEAST_SPREAD = 0.01
"""Least scatter of the logarithms of times that is assumed, where few pairs show none."""


@dataclass(frozen=True)
class Power:
    """What a comparison of a task finds with a probability of 80 %.

    Attributes:
        task: Its name.
        pairs: Number of seeds.
        success: Least drop of success, 0 to 1; None where not even a total loss is found.
        time: Least change of time, as a share; None for an unknown scatter.
        seconds: Simulated s of its trials.
    """

    task: str
    pairs: int
    success: float | None
    time: float | None
    seconds: float

    def as_json(self) -> dict[str, Any]:
        """JSON values."""
        return {
            "task": self.task,
            "pairs": self.pairs,
            "success": self.success,
            "time": self.time,
            "simulated_s": self.seconds,
        }


def power_of(
    baseline: Baseline, names: Sequence[str], seeds: Sequence[int], limits: Mapping[str, float]
) -> list[Power]:
    """Power of every task that the baseline has, and of all together.

    Args:
        baseline: The baseline.
        names: Tasks of the run.
        seeds: Seeds of the run; those that the baseline lacks count as if it had them.
        limits: s, time limits by task.
    """
    tasks = {name: baseline.tasks[name] for name in names if name in baseline.tasks}
    level = level_of(len(tasks))
    churn = {name: _churn(task, limits[name]) for name, task in tasks.items()}
    every = [difference for some in churn.values() for difference in some]
    rows, pairs, seconds = [], 0, 0.0
    for name, task in tasks.items():
        times = [t.time_s if t.success else limits[name] for t in task.trials.values()]
        spread = _spread(churn[name]) or _spread(every)
        rows.append(_power(name, len(seeds), spread, level, len(seeds) * fmean(times)))
        pairs, seconds = pairs + len(seeds), seconds + rows[-1].seconds
    if len(rows) > 1:
        rows.append(_power(TOGETHER, pairs, _spread(every), level, seconds))
    return rows


def _churn(task: BaselineTask, limit: float) -> list[float]:
    """Differences of the logarithms of times between trials and their repetitions."""
    found = []
    for seed, again in task.repeats.items():
        if seed in task.trials:
            before = task.trials[seed]
            times = [t.time_s if t.success else limit for t in (before, again)]
            found.append(log(times[1] / times[0]))
    return found


def _spread(differences: Sequence[float]) -> float | None:
    """Root mean square of differences, and some at least; None without any."""
    if not differences:
        return None
    return max(sqrt(fmean(d * d for d in differences)), LEAST_SPREAD)


def _power(name: str, pairs: int, spread: float | None, level: float, seconds: float) -> Power:
    shift = None if spread is None else statistics.noticeable_shift(spread, pairs, level)
    return Power(
        name,
        pairs,
        statistics.noticeable_drop(pairs, 0.0, level),
        None if shift is None or not isfinite(shift) else shift,
        seconds,
    )
