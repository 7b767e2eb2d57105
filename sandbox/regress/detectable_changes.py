"""Power of a future comparison: the changes that it can detect, and its cost.

A baseline has some of its trials twice. The second trial has a harmless change (`repeated`). The
differences in these pairs are called churn: any change of a last digit causes them. A real change
must be distinguished from this scatter.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import expm1, inf, isfinite, log
from statistics import fmean
from typing import TYPE_CHECKING, Any

from sandbox.regress import statistics
from sandbox.regress.comparison import level_of, together_name
from sandbox.regress.run_plan import TrialJob, arm_of

if TYPE_CHECKING:
    from sandbox.regress.baseline import Baseline, BaselineTask, BaselineTrial

REPEATS = 10
"""Number of seeds of every task whose trials a baseline has twice."""

LEAST_CHANGE = 0.005
"""Smallest change of time that is reported as detectable, as a share. If a baseline has few
repeated trials, and their times do not differ, the computed change would be smaller."""


def repeated(job: TrialJob) -> TrialJob:
    """The trial with a harmless change: another last digit of the friction."""
    before = job.settings.variation
    varied = replace(before, friction=1.0000001 * before.friction)
    return replace(job, settings=job.settings.changed(variation=varied), record=None)


@dataclass(frozen=True)
class Power:
    """Smallest changes that a comparison of a task detects with a probability of 80 %.

    Attributes:
        task: Its name.
        pairs: Number of seeds.
        success: Smallest drop of success, 0 to 1; None if not even a total loss is detected.
        time: Smallest change of time, as a share; None if the scatter is unknown.
        seconds: Simulated time of its trials, s.
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
    """Power of every task in the baseline, and of all tasks of an arm together.

    Args:
        baseline: The baseline.
        names: Names of the run's rows, each a task in an arm, such as `stack (hard)`.
        seeds: Seeds of the run; seeds that are missing in the baseline count as present.
        limits: s, time limits by task.
    """
    tasks = {name: baseline.tasks[name] for name in names if name in baseline.tasks}
    level, rows = level_of(tasks), []
    for arm in {arm_of(name): None for name in tasks}:
        own = [name for name in tasks if arm_of(name) == arm]
        pairs = {name: _pairs(tasks[name]) for name in own}
        # A task has few repeated trials. The frequency with which success changes is therefore
        # computed over the whole arm.
        some = [pair for name in own for pair in pairs[name]]
        won = sum(a.success != b.success for a, b in some) / (2.0 * max(len(some), 1))
        churn = {
            name: [log(_time(b, limits[name]) / _time(a, limits[name])) for a, b in found]
            for name, found in pairs.items()
        }
        every = [each for each in churn.values() if each]
        for name in own:
            mean = fmean(_time(t, limits[name]) for t in tasks[name].trials.values())
            shown = [churn[name]] if churn[name] else every
            rows.append(_power(name, len(seeds), won, shown, level, len(seeds) * mean))
        if len(own) > 1:
            seconds = sum(row.seconds for row in rows[-len(own) :])
            all_pairs = len(own) * len(seeds)
            rows.append(_power(together_name(own[0]), all_pairs, won, every, level, seconds))
    return rows


def _pairs(task: BaselineTask) -> list[tuple[BaselineTrial, BaselineTrial]]:
    """Trials and their repetitions."""
    return [(task.trials[seed], b) for seed, b in task.repeats.items() if seed in task.trials]


def _time(trial: BaselineTrial, limit: float) -> float:
    return trial.time_s if trial.success else limit


def _power(
    name: str, pairs: int, won: float, churn: Sequence[list[float]], level: float, seconds: float
) -> Power:
    shift = statistics.noticeable_shift(churn, pairs, level) if churn else inf
    return Power(
        name,
        pairs,
        statistics.noticeable_drop(pairs, won, level),
        max(expm1(shift), LEAST_CHANGE) if isfinite(shift) else None,
        seconds,
    )
