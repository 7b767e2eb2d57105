"""Success under increasing variations, until a task breaks.

The same seeds are run without variation and with every value, so that trials come in pairs. A value
breaks a task if success is significantly lower (exact one-sided McNemar test, alpha 0.05, without
an adjustment for several values). If no values are given, the default values of each direction are
run until one breaks the task.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from models.errors import InputError
from models.message import counted
from sandbox.regress import statistics
from sandbox.regress.execute import Trial, is_own_fault
from sandbox.regress.run_plan import RegressionPlan, registered
from sandbox.regress.run_report import Crashes, TaskResult
from sandbox.trial.assembly import drawn
from sandbox.trial.trial_options import Kind, find_kind, parse_value

SCHEMA = 1
"""Version of the report's JSON."""

Runner = Callable[[RegressionPlan], list[Trial]]
"""Runs a plan's trials; returns fewer after an interruption."""


@dataclass(frozen=True)
class RequestedVariation:
    """A requested variation.

    Attributes:
        kind: Kind of variation.
        values: Values in its unit. If there are none, default values are used until one breaks the
            task.
    """

    kind: Kind
    values: tuple[float, ...] = ()

    @property
    def directions(self) -> tuple[tuple[float, ...], ...]:
        """Sequences of values, each to be run in its order. Default values give two sequences: from
        the neutral value down, and from the neutral value up."""
        if self.values:
            return (tuple(v for v in dict.fromkeys(self.values) if v != self.kind.neutral),)
        return self.kind.down, self.kind.up


def parse_variations(words: Sequence[str]) -> tuple[RequestedVariation, ...]:
    """Parses variations such as `size` or `latency=50,100`.

    Raises:
        InputError: A name or a value is invalid, or a name is given twice.
    """
    wanted: list[RequestedVariation] = []
    for word in words:
        name, equals, values = word.partition("=")
        kind = find_kind(name)
        if kind in (w.kind for w in wanted):
            raise InputError("this quantity is given twice", where="--vary", got=name)
        values_wanted = tuple(parse_value(kind, v) for v in values.split(",")) if equals else ()
        wanted.append(RequestedVariation(kind, values_wanted))
    return tuple(wanted)


@dataclass(frozen=True)
class Point:
    """The results of a task with one value of a variation.

    Attributes:
        value: The value, in the unit of its kind.
        result: Results of the trials with this value.
        lost: Seeds that succeeded without the variation and fail with it.
        won: Seeds that failed without the variation and succeed with it.
        refused: Reason why the task cannot have this value; empty if there are trials.
        partial: True if the run was stopped before all trials had ended. A partial point is not
            judged.
    """

    value: float
    result: TaskResult
    lost: tuple[int, ...] = ()
    won: tuple[int, ...] = ()
    refused: str = ""
    partial: bool = False

    @property
    def p(self) -> float:
        """P value of the exact one-sided McNemar test."""
        return statistics.mcnemar(len(self.lost), len(self.won))

    @property
    def breaks(self) -> bool:
        """True if success is significantly lower."""
        return not self.partial and self.p <= statistics.ALPHA

    def as_json(self) -> dict[str, Any]:
        """JSON values with every trial."""
        if self.refused:
            return {"value": self.value, "refused": self.refused}
        return {
            "value": self.value,
            **self.result.as_json(),
            "lost": list(self.lost),
            "won": list(self.won),
            "p": self.p,
            "breaks": self.breaks,
            "complete": not self.partial,
            "trials": list(self.result.trials),
        }


@dataclass(frozen=True)
class Curve:
    """Success of a task under one kind of variation.

    Attributes:
        task: Name of the task.
        kind: Kind of variation.
        points: Points from the lowest to the highest value, including the neutral value.
    """

    task: str
    kind: Kind
    points: tuple[Point, ...]

    @property
    def run(self) -> tuple[Point, ...]:
        """Points that have trials."""
        return tuple(p for p in self.points if not p.refused)

    @property
    def breaks_below(self) -> float | None:
        """The largest value below the neutral value that breaks the task; None if no value does."""
        broken = [p.value for p in self.points if p.breaks and p.value < self.kind.neutral]
        return max(broken, default=None)

    @property
    def breaks_above(self) -> float | None:
        """The smallest value above the neutral value that breaks the task; None if none does."""
        broken = [p.value for p in self.points if p.breaks and p.value > self.kind.neutral]
        return min(broken, default=None)

    def as_json(self) -> dict[str, Any]:
        """JSON values with every trial."""
        return {
            "task": self.task,
            "varied": self.kind.name,
            "unit": self.kind.unit or "factor",
            "neutral": self.kind.neutral,
            "breaks_below": self.breaks_below,
            "breaks_above": self.breaks_above,
            "points": [point.as_json() for point in self.points],
        }


@dataclass(frozen=True)
class Unfinished:
    """The unfinished part of a stopped run.

    Attributes:
        task: Name of the task.
        kind: Kind of variation; None if the task's trials without variation are unfinished; all its
            later trials are then unfinished, too.
        values: Remaining values in its unit, in the order in which they would be run; empty if no
            values were given.
        ended: Number of trials that have ended.
    """

    task: str
    kind: Kind | None = None
    values: tuple[float, ...] = ()
    ended: int = 0

    def text(self, of: int) -> str:
        """Text for people: `dial, size=0.8,0.6`.

        Args:
            of: Planned number of trials per value.
        """
        parts = [self.task]
        if self.kind is not None:
            values = ",".join(f"{value:g}" for value in self.values)
            parts.append(f"{self.kind.name}={values}" if values else self.kind.name)
        elif self.ended:
            parts.append("nothing varied")
        ended = f" ({self.ended} of {counted(of, 'trial')})" if self.ended else ""
        return ", ".join(parts) + ended

    def as_json(self) -> dict[str, Any]:
        """JSON values of all fields."""
        return {
            "task": self.task,
            "varied": None if self.kind is None else self.kind.name,
            "values": list(self.values),
            "ended": self.ended,
        }


@dataclass(frozen=True)
class Sweep:
    """Results of a run with variations.

    Attributes:
        plan: Plan of the unvaried trials.
        curves: Curves by task, then by kind of variation.
        unfinished: Parts that were not run because the run was stopped.
    """

    plan: RegressionPlan
    curves: tuple[Curve, ...]
    unfinished: tuple[Unfinished, ...] = ()

    @property
    def complete(self) -> bool:
        """True if the run was not stopped."""
        return not self.unfinished

    def command(self, curve: Curve, point: Point, seed: int) -> str:
        """The command line that runs a trial again."""
        crashed = any(t["seed"] == seed for t in point.result.crashed)
        return varied(self.plan, curve.kind, point.value).command(curve.task, seed, crashed)

    def crashes(self, allowed: int) -> Crashes:
        """Trials that crashed, each once."""
        points = {id(p.result): p for curve in self.curves for p in curve.points}
        return Crashes([t for p in points.values() for t in p.result.crashed], allowed)

    def as_json(self) -> dict[str, Any]:
        """JSON values with every trial; `configuration` is that of the unvaried trials."""
        pairs = len(self.plan.seeds)
        return {
            "kind": "variation of sandbox regress",
            "schema": SCHEMA,
            "simulated_user": True,
            "complete": self.complete,
            "not_finished": [each.as_json() for each in self.unfinished],
            "configuration": self.plan.configuration(),
            "seeds": list(self.plan.seeds),
            "noticeable_drop": statistics.noticeable_drop(pairs),
            "curves": [curve.as_json() for curve in self.curves],
        }


def sweep(plan: RegressionPlan, wanted: Sequence[RequestedVariation], run: Runner) -> Sweep:
    """Runs every task without variation, and then with every value.

    Some tasks cannot have some values: for example, the start of a bolt cannot be shifted. Such a
    value is noted as refused. If it is a default value, no further values in its direction are run.
    """
    curves: list[Curve] = []
    missing: list[Unfinished] = []
    for task, name in zip(plan.tasks, plan.names, strict=True):
        if missing:
            missing.append(Unfinished(name))
            continue
        own = replace(plan, tasks=(task,))
        nominal = _result(own, run(own))
        stopped = nominal.n < len(plan.seeds)
        if stopped:
            missing.append(Unfinished(name, ended=nominal.n))
        for each in wanted:
            neutral = Point(each.kind.neutral, nominal, partial=stopped)
            if not missing:
                points, missing = _points(own, name, each, nominal, run)
                curves.append(_curve(name, each.kind, [neutral, *points]))
            elif not stopped:
                missing.append(Unfinished(name, each.kind, _differing(each)))
            elif nominal.n:
                # Every ended trial is counted once.
                if each is wanted[0]:
                    curves.append(_curve(name, each.kind, [neutral]))
                missing.append(Unfinished(name, each.kind, _differing(each)))
    return Sweep(plan, tuple(curves), tuple(missing))


def _curve(task: str, kind: Kind, points: Sequence[Point]) -> Curve:
    return Curve(task, kind, tuple(sorted(points, key=lambda p: p.value)))


def _differing(wanted: RequestedVariation) -> tuple[float, ...]:
    """The requested values; empty if values are tried until the task breaks."""
    return tuple(v for values in wanted.directions for v in values) if wanted.values else ()


def _points(
    plan: RegressionPlan, name: str, wanted: RequestedVariation, nominal: TaskResult, run: Runner
) -> tuple[list[Point], list[Unfinished]]:
    """Points of one task under one kind of variation, and their unfinished part."""
    points: list[Point] = []
    begun: list[Unfinished] = []
    left: list[float] = []
    stopped = False
    for direction in wanted.directions:
        for i, value in enumerate(direction):
            if stopped:
                left += direction
                break
            point = _point(plan, wanted.kind, value, nominal, run)
            if not point.partial or point.result.n:
                points.append(point)
            if point.partial:
                stopped = True
                ended = point.result.n
                begun = [Unfinished(name, wanted.kind, (value,), ended)] if ended else []
                left += direction[i + (1 if ended else 0) :]
                break
            if (point.breaks or point.refused) and not wanted.values:
                break
    rest = [Unfinished(name, wanted.kind, tuple(left))] if left else []
    return points, begun + rest


def varied(plan: RegressionPlan, kind: Kind, value: float) -> RegressionPlan:
    """The plan with one further variation in all its trials."""
    asked = [*filter(None, [plan.scene.get("vary", "")]), f"{kind.name}={value:.12g}"]
    return replace(plan, scene={**plan.scene, "vary": ",".join(asked)})


def _point(
    plan: RegressionPlan, kind: Kind, value: float, nominal: TaskResult, run: Runner
) -> Point:
    changed = varied(plan, kind, value)
    refused = refusal(changed)
    if refused:
        return Point(value, TaskResult(nominal.name, nominal.version, ()), refused=refused)
    # Errors while trials run, such as a full disk, are not caught: they do not depend on the value.
    result = _result(plan, run(changed))
    before = {t["seed"]: t["success"] for t in nominal.trials}
    differ = [t for t in result.trials if t["success"] != before[t["seed"]]]
    return Point(
        value,
        result,
        tuple(t["seed"] for t in differ if not t["success"]),
        tuple(t["seed"] for t in differ if t["success"]),
        partial=result.n < nominal.n,
    )


def refusal(plan: RegressionPlan) -> str:
    """Reason why a trial of a plan cannot be drawn; empty if all trials can be drawn.

    No trial is played. A trial for which the task's own code fails is not a refusal: it crashes
    when it is run.
    """
    try:
        jobs = plan.jobs()
    except InputError as error:
        return str(error)
    for job in jobs:
        with registered(job.own_task):
            try:
                drawn(job.settings)
            except InputError as error:
                if not is_own_fault(error, job):
                    return str(error)
    return ""


def check_possible(plan: RegressionPlan, wanted: Sequence[RequestedVariation]) -> None:
    """Checks, before the run, that each kind of variation has a value that some task can have.

    For every task, only the trial of the first seed is drawn.

    Raises:
        InputError: No task can have any value of a kind; the error has the reason for the first
            task.
    """
    for each in wanted:
        # Among default values, a direction ends at its first value if this value is refused.
        tried = [d for d in each.directions if d]
        values = [v for d in tried for v in (d if each.values else d[:1])]
        reasons = []
        for task in plan.tasks:
            one = replace(plan, tasks=(task,), seeds=plan.seeds[:1])
            for value in values:
                reasons.append(refusal(varied(one, each.kind, value)))
                if not reasons[-1]:
                    break
            if reasons and not reasons[-1]:
                break
        if reasons and all(reasons):
            raise InputError(
                f"no chosen task can be varied like that; {reasons[0]}",
                where=f"--vary {each.kind.name}",
            )


def _result(plan: RegressionPlan, trials: list[Trial]) -> TaskResult:
    ((name, version),) = plan.versions().items()
    return TaskResult(name, version, tuple(sorted(trials, key=lambda t: int(t["seed"]))))
