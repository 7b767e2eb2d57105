"""Success under increasing variations, until a task breaks.

The same seeds are run without variation and with every value, so that trials come in pairs. A value
breaks a task if success is significantly lower (exact one-sided McNemar test, alpha 0.05, each
value on its own). Without given values, each direction ends at the first value that breaks.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from models.errors import InputError
from sandbox.options.variations import Kind, find_kind, parse_value
from sandbox.regress import statistics
from sandbox.regress.execute import Trial
from sandbox.regress.plan import RegressionPlan
from sandbox.regress.report import Crashes, TaskResult

SCHEMA = 1
"""Version of the report's JSON."""

Runner = Callable[[RegressionPlan], list[Trial]]
"""Runs a plan's trials; returns fewer after an interruption."""


@dataclass(frozen=True)
class Wanted:
    """A requested variation.

    Attributes:
        kind: Kind of variation.
        values: Values in its unit; empty uses default values until it breaks.
    """

    kind: Kind
    values: tuple[float, ...] = ()

    @property
    def directions(self) -> tuple[tuple[float, ...], ...]:
        """Values to run one after the other, away from the neutral one."""
        if self.values:
            return (tuple(v for v in dict.fromkeys(self.values) if v != self.kind.neutral),)
        return self.kind.down, self.kind.up


def parse_wanted(words: Sequence[str]) -> tuple[Wanted, ...]:
    """`size`, `latency=50,100`: what to vary, each once.

    Raises:
        InputError: A name or a value is none.
    """
    wanted: list[Wanted] = []
    for word in words:
        name, equals, values = word.partition("=")
        kind = find_kind(name)
        if kind in (w.kind for w in wanted):
            raise InputError("it is varied twice", where="--vary", got=name)
        values_wanted = tuple(parse_value(kind, v) for v in values.split(",")) if equals else ()
        wanted.append(Wanted(kind, values_wanted))
    return tuple(wanted)


@dataclass(frozen=True)
class Point:
    """A task with one value.

    Attributes:
        value: In the unit of its kind.
        result: Its trials.
        lost, won: Seeds that only the trials with nothing varied succeeded in, and only these.
        refused: Why there are no trials, where the task cannot be varied like that.
    """

    value: float
    result: TaskResult
    lost: tuple[int, ...] = ()
    won: tuple[int, ...] = ()
    refused: str = ""

    @property
    def p(self) -> float:
        """P value of the exact one-sided McNemar test."""
        return statistics.mcnemar(len(self.lost), len(self.won))

    @property
    def breaks(self) -> bool:
        """True if success is significantly lower."""
        return self.p <= statistics.ALPHA

    def as_json(self) -> dict[str, Any]:
        """With every trial."""
        if self.refused:
            return {"value": self.value, "refused": self.refused}
        return {
            "value": self.value,
            **self.result.as_json(),
            "lost": list(self.lost),
            "won": list(self.won),
            "p": self.p,
            "breaks": self.breaks,
            "trials": list(self.result.trials),
        }


@dataclass(frozen=True)
class Curve:
    """Success of a task under one kind of variation.

    Attributes:
        task: Name of the task.
        kind: Kind of variation.
        points: From the lowest value to the highest, the neutral one among them.
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
        """The value below the neutral one, and nearest to it, that breaks; None: none did."""
        broken = [p.value for p in self.points if p.breaks and p.value < self.kind.neutral]
        return max(broken, default=None)

    @property
    def breaks_above(self) -> float | None:
        """The same, above."""
        broken = [p.value for p in self.points if p.breaks and p.value > self.kind.neutral]
        return min(broken, default=None)

    def as_json(self) -> dict[str, Any]:
        """With every trial."""
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
class Sweep:
    """Results of a run with variations.

    Attributes:
        plan: Plan of the unvaried trials.
        curves: Curves by task, then by kind of variation.
        complete: True if the run was not interrupted.
    """

    plan: RegressionPlan
    curves: tuple[Curve, ...]
    complete: bool

    def command(self, curve: Curve, point: Point, seed: int) -> str:
        """One line that runs a trial again."""
        crashed = any(t["seed"] == seed for t in point.result.crashed)
        return varied(self.plan, curve.kind, point.value).command(curve.task, seed, crashed)

    def crashes(self, allowed: int) -> Crashes:
        """Trials that crashed, each once."""
        points = {id(p.result): p for curve in self.curves for p in curve.points}
        return Crashes([t for p in points.values() for t in p.result.crashed], allowed)

    def as_json(self) -> dict[str, Any]:
        """With every trial; `configuration` is that of the trials with nothing varied."""
        pairs = len(self.plan.seeds)
        return {
            "kind": "variation of sandbox regress",
            "schema": SCHEMA,
            "simulated_user": True,
            "complete": self.complete,
            "configuration": self.plan.configuration(),
            "seeds": list(self.plan.seeds),
            "noticeable_drop": statistics.noticeable_drop(pairs),
            "curves": [curve.as_json() for curve in self.curves],
        }


def sweep(plan: RegressionPlan, wanted: Sequence[Wanted], run: Runner) -> Sweep:
    """Runs every task with nothing varied, and then with every value.

    A value that a task cannot have (a bolt has one place) is noted, and ends its direction.
    """
    curves: list[Curve] = []
    for task, name in zip(plan.tasks, plan.names, strict=True):
        own = replace(plan, tasks=(task,))
        nominal = _result(own, run(own))
        complete = nominal.n == len(plan.seeds)
        for each in wanted if complete else ():
            points = [Point(each.kind.neutral, nominal)]
            for direction in each.directions:
                for value in direction if complete else ():
                    points.append(_point(own, each.kind, value, nominal, run))
                    complete = bool(points[-1].refused) or points[-1].result.n == nominal.n
                    ends = points[-1].breaks or points[-1].refused
                    if not complete or (ends and not each.values):
                        break
            curves.append(Curve(name, each.kind, tuple(sorted(points, key=lambda p: p.value))))
            if not complete:
                break
        if not complete:
            return Sweep(plan, tuple(curves), False)
    return Sweep(plan, tuple(curves), True)


def varied(plan: RegressionPlan, kind: Kind, value: float) -> RegressionPlan:
    """The plan with one variation in addition to those of all its trials."""
    asked = [*filter(None, [plan.scene.get("vary", "")]), f"{kind.name}={value:.12g}"]
    return replace(plan, scene={**plan.scene, "vary": ",".join(asked)})


def _point(
    plan: RegressionPlan, kind: Kind, value: float, nominal: TaskResult, run: Runner
) -> Point:
    try:
        result = _result(plan, run(varied(plan, kind, value)))
    except InputError as error:
        return Point(value, TaskResult(nominal.name, nominal.version, ()), refused=str(error))
    before = {t["seed"]: t["success"] for t in nominal.trials}
    differ = [t for t in result.trials if t["success"] != before[t["seed"]]]
    return Point(
        value,
        result,
        tuple(t["seed"] for t in differ if not t["success"]),
        tuple(t["seed"] for t in differ if t["success"]),
    )


def _result(plan: RegressionPlan, trials: list[Trial]) -> TaskResult:
    ((name, version),) = plan.versions().items()
    return TaskResult(name, version, tuple(sorted(trials, key=lambda t: int(t["seed"]))))
