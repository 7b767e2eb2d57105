"""Report of a run: success of every task, lost and won seeds, and whether the run passes."""

from __future__ import annotations

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from statistics import fmean, median
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple
from xml.etree import ElementTree

from models.message import counted
from sandbox.regress import statistics
from sandbox.regress.compared_measures import MEASURES, SUCCESS, TIME
from sandbox.regress.comparison import (
    Change,
    Comparison,
    compared,
    groups,
    lacking_measures,
    level_of,
)
from sandbox.regress.execute import CRASHED, Trial
from sandbox.regress.run_plan import HARD, RegressionPlan, arm_of, setting_of
from sandbox.system.files import write_whole

if TYPE_CHECKING:
    from sandbox.regress.baseline import Baseline

SCHEMA = 1
"""Version of the report's JSON."""
_MOST_MOVED = 10
"""Number of trials in the list of the largest changes."""


@dataclass(frozen=True)
class TaskResult:
    """Results of a task in an arm.

    Attributes:
        name: Name of the task in its arm, such as `stack` or `stack (hard)`.
        version: Version of the task.
        trials: Trials by seed.
    """

    name: str
    version: int
    trials: tuple[Trial, ...]

    @property
    def n(self) -> int:
        """Number of trials."""
        return len(self.trials)

    @property
    def successes(self) -> int:
        """Number of trials that succeeded."""
        return sum(t["success"] for t in self.trials)

    @property
    def failed(self) -> list[Trial]:
        """Trials that did not succeed, including crashed trials."""
        return [t for t in self.trials if not t["success"]]

    @property
    def crashed(self) -> list[Trial]:
        """Trials that have no result."""
        return [t for t in self.trials if t["status"] == CRASHED]

    @property
    def progress(self) -> float | None:
        """Mean progress at the trials' ends; None without trials."""
        return fmean(t["progress"] for t in self.trials) if self.trials else None

    @property
    def time_s(self) -> float | None:
        """Median time (s) of the trials that succeeded; None without such trials."""
        times = [t["time_s"] for t in self.trials if t["success"]]
        return median(times) if times else None

    def as_json(self) -> dict[str, Any]:
        """JSON values; rates are from 0 to 1."""
        low, high = statistics.wilson(self.successes, self.n)
        return {
            "version": self.version,
            "vary": setting_of(self.name),
            "n": self.n,
            "successes": self.successes,
            "wilson_low": low,
            "wilson_high": high,
            "progress": self.progress,
            "time_s": self.time_s,
            "crashed": [t["seed"] for t in self.crashed],
        }


@dataclass(frozen=True)
class Crashes:
    """Trials without a result: their code raised an error, or their process or machine was lost.

    Attributes:
        trials: The trials.
        allowed: Number of trials that may crash in a run that passes.
    """

    trials: Sequence[Trial]
    allowed: int = 0

    @property
    def too_many(self) -> bool:
        """True if more trials crashed than are allowed, so that the run fails."""
        return len(self.trials) > self.allowed

    def verdict(self) -> str:
        """One line; empty if no trial crashed."""
        n = len(self.trials)
        if not n:
            return ""
        crashed = f"{n} trial{'s' if n > 1 else ''} crashed"
        if self.too_many:
            return f"{crashed}, and --allow-crashes permits {self.allowed or 'none'}"
        return f"{crashed}; --allow-crashes permits {self.allowed}, and each counts as a failure"

    def as_json(self) -> dict[str, Any]:
        """JSON values; each trial has its seed and error."""
        names = ("task", "seed", "reason")
        return {
            "count": len(self.trials),
            "allowed": self.allowed,
            "trials": [{name: t[name] for name in names} for t in self.trials],
        }


class MovedTrial(NamedTuple):
    """A trial that contributes to a loss beyond chance, and its change.

    Attributes:
        name: Name of the task in its arm.
        seed: Seed of the trial.
        what: The measure now and before, in words.
        command: The command line that runs the trial again.
    """

    name: str
    seed: int
    what: str
    command: str

    def __str__(self) -> str:
        """The trial and its change, in words."""
        return f"{self.name} seed {self.seed}: {self.what}"


@dataclass(frozen=True)
class Report:
    """A run and its comparison with a baseline.

    Attributes:
        plan: The plan of the run.
        configuration: See `RegressionPlan.configuration`.
        tasks: Results of tasks, in order.
        complete: True if every trial was run.
        comparisons: Comparisons by task, for tasks in the baseline.
        together: Changes of success and time over all tasks of an arm, by the arm's name, for arms
            with several compared tasks.
        notes: Notes for the reader.
        reasons: Reasons why the run fails; empty if it passes.
        gains: Gains beyond chance.
        allow_crashes: Number of trials that may crash.
    """

    plan: RegressionPlan
    configuration: dict[str, Any]
    tasks: tuple[TaskResult, ...]
    complete: bool
    comparisons: dict[str, Comparison]
    notes: tuple[str, ...]
    reasons: tuple[str, ...]
    allow_crashes: int = 0
    together: Mapping[str, Mapping[str, Change]] = field(default_factory=dict)
    gains: tuple[str, ...] = ()

    @property
    def crashes(self) -> Crashes:
        """The crashed trials, and the allowed number of them."""
        return Crashes([t for task in self.tasks for t in task.crashed], self.allow_crashes)

    @property
    def trials(self) -> list[Trial]:
        """All trials, by task and seed."""
        return [t for task in self.tasks for t in task.trials]

    @property
    def passed(self) -> bool:
        """True if there is no reason to fail. An interrupted run is not judged, and passes."""
        return not self.reasons

    def command(self, trial: Trial) -> str:
        """The command line that runs a trial again, or replays its divergence."""
        if trial.get("dump"):
            return shlex.join(["sandbox", "replay", trial["dump"]])
        return self.plan.command(trial["task"], trial["seed"], trial["status"] == CRASHED)

    def moved_most(self) -> list[MovedTrial]:
        """The trials with the largest changes, for every loss beyond chance."""
        losses = [
            (name, measure)
            for name, comparison in self.comparisons.items()
            for measure, change in comparison.changes.items()
            if change.is_loss
        ]
        if not losses:
            # A loss of all tasks together may consist of small losses in each task.
            losses = [
                (name, measure)
                for group, own in groups(self.comparisons).items()
                for measure, change in self.together[group].items()
                for name in own
                if change.is_loss
            ]
        moved = [
            (MEASURES[measure].change(before, now), name, seed, measure, before, now)
            for name, measure in losses
            for seed, before, now in self.comparisons[name].changes[measure].most
        ]
        trials = {(t["task"], t["seed"]): t for t in self.trials}
        found: dict[tuple[str, int], MovedTrial] = {}
        for _, name, seed, measure, before, now in sorted(moved, reverse=True)[:_MOST_MOVED]:
            unit = " s" if measure == TIME else ""
            what = f"{measure} {now:.3g}{unit}, was {before:.3g}{unit}"
            again = self.command(trials[name, seed])
            found.setdefault((name, seed), MovedTrial(name, seed, what, again))
        return [*found.values()]

    def noise_floor(self) -> dict[str, Any]:
        """Smallest loss that a paired comparison with these tasks and seeds can detect."""
        pairs, level = len(self.plan.seeds), level_of(self.plan.names)
        return {
            "pairs": pairs,
            "level": level,
            "fewest_losses": statistics.fewest_losses(level),
            "drop": statistics.noticeable_drop(pairs, 0.0, level),
            "power": statistics.POWER,
        }

    def as_json(self) -> dict[str, Any]:
        """The whole report as JSON values."""
        level = level_of(self.comparisons)
        tasks = {}
        for task in self.tasks:
            tasks[task.name] = {
                **task.as_json(),
                "failed": [
                    {"seed": t["seed"], "reason": t["reason"], "command": self.command(t)}
                    for t in task.failed
                ],
            }
            if task.name in self.comparisons:
                tasks[task.name]["baseline"] = self.comparisons[task.name].as_json(level)
        return {
            "schema": SCHEMA,
            "complete": self.complete,
            "passed": self.passed if self.complete else None,
            "reasons": list(self.reasons),
            "gains": list(self.gains),
            "together": {
                name: {m: change.as_json() for m, change in changes.items()}
                for name, changes in self.together.items()
            },
            "notes": list(self.notes),
            "configuration": {**self.configuration, "seeds": list(self.plan.seeds)},
            "noise_floor": self.noise_floor(),
            "crashes": self.crashes.as_json(),
            "tasks": tasks,
            "trials": self.trials,
        }


def make_report(
    plan: RegressionPlan,
    trials: Sequence[Trial],
    baseline: Baseline | None = None,
    exact: bool = False,
    across_encoders: bool = False,
    allow_crashes: int = 0,
    margins: Mapping[str, float] = MappingProxyType({}),
) -> Report:
    """Sorts the trials of a run and compares them with a baseline.

    Args:
        plan: The plan.
        trials: The finished trials; fewer than planned after an interruption.
        baseline: The baseline.
        exact: True requires equal states for equal fingerprints. It raises an error if `STATES` or
            models differ.
        across_encoders: True allows a baseline of another encoder.
        allow_crashes: Number of trials of the whole run that may crash.
        margins: For success and time, the largest change, as a share, that is not reported as a
            loss or gain.

    Raises:
        InputError: The baseline cannot be compared with this run.
    """
    configuration, versions = plan.configuration(), plan.versions()
    tasks = tuple(
        TaskResult(
            name,
            version,
            tuple(sorted((t for t in trials if t["task"] == name), key=lambda t: t["seed"])),
        )
        for name, version in versions.items()
    )
    complete = len(trials) == len(plan.jobs())
    comparisons: dict[str, Comparison] = {}
    together: Mapping[str, Mapping[str, Change]] = {}
    notes: list[str] = []
    reasons: list[str] = []
    gains: list[str] = []
    if baseline is not None:
        origin = plan.origin()
        baseline.check(origin, versions, across_encoders, exact)
        differing = baseline.differing_program(origin)
        if differing:
            notes.append(f"{differing}: states are not compared")
        if changed := baseline.changed_defaults(origin):
            notes.append(changed)
        trials_by_task = {task.name: task.trials for task in tasks}
        comparisons, together = compared(
            trials_by_task, baseline, plan.time_limits(), margins, states=not differing
        )
        if lacking_measures(trials_by_task, baseline, comparisons):
            notes.append(
                "the baseline has only success, time and progress, so other measures are not "
                "compared"
            )
        hard = [task.name for task in tasks if arm_of(task.name) == HARD]
        alone = bool(hard) and not set(hard) & set(comparisons)
        if alone:
            notes.append(
                "the baseline has no trials of the current hard arm, so only the plain arm is "
                "compared. --update-baseline adds the hard arm"
            )
        for task in tasks:
            if task.name not in comparisons:
                if not (alone and task.name in hard):
                    notes.append(f"{task.name}: the baseline has none of these trials")
            elif lacking := comparisons[task.name].unpaired:
                notes.append(
                    f"{task.name}: {without_baseline(lacking)}. To add them, run all seeds with "
                    "--update-baseline"
                )
        baseline.check_seeds(plan.names, plan.seeds)
        if not complete:
            notes.append("the run broke off: nothing is judged")
        else:
            by_place = {name: c.changes for name, c in comparisons.items()} | {**together}
            changes = [
                (name, change) for name, some in by_place.items() for change in some.values()
            ]
            reasons = [
                f"{name}: {change.text()}, a loss beyond chance"
                for name, change in changes
                if change.is_loss
            ]
            gains = [f"{name}: {change.text()}" for name, change in changes if change.is_gain]
        if exact:
            verdicts, said = _exact(comparisons)
            notes += said
            reasons += verdicts if complete else []
    crashes = Crashes([t for task in tasks for t in task.crashed], allow_crashes)
    if crashes.trials:
        (reasons if complete and crashes.too_many else notes).append(crashes.verdict())
    return Report(
        plan,
        configuration,
        tasks,
        complete,
        comparisons,
        tuple(notes),
        tuple(reasons),
        allow_crashes,
        together,
        tuple(gains),
    )


def without_baseline(seeds: Sequence[int]) -> str:
    """A clause that names the seeds of the run that are not in the baseline."""
    have = "seed has no baseline and is" if len(seeds) == 1 else "seeds have no baseline and are"
    return f"{len(seeds)} {have} not compared: {_some(seeds)}"


def _some(seeds: Sequence[int]) -> str:
    return ", ".join(map(str, seeds[:8])) + (" ..." if len(seeds) > 8 else "")


def _exact(comparisons: dict[str, Comparison]) -> tuple[list[str], list[str]]:
    """Pair (reasons why the run fails, notes) for a run whose states must be equal."""
    reasons, notes = [], []
    for name, c in comparisons.items():
        if c.changed:
            reasons.append(
                f"{name}: states differ in {len(c.changed)} of {counted(c.same_machine, 'trial')}, "
                f"seeds {_some(c.changed)}"
            )
        elif c.same_machine:
            notes.append(f"{name}: states of {counted(c.same_machine, 'trial')} equal to the bit")
        elsewhere = c.pairs - c.same_machine - c.crashed
        if elsewhere:
            what = " and ".join(c.elsewhere) or "a part that the baseline does not name"
            notes.append(
                f"{name}: states of {elsewhere} of {counted(c.pairs, 'trial')} are not compared, "
                f"since states depend on a part that differs from the baseline's: {what}"
            )
    return reasons, notes


def markdown(report: Report) -> str:
    """The report as Markdown, for the summary page of a CI server."""
    verdict = "the run broke off: nothing is judged"
    if report.complete:
        verdict = "no loss beyond chance" if report.passed else "**a loss beyond chance**"
        if not report.comparisons:
            verdict = "without a baseline, nothing is judged"
    lines = [f"### sandbox regress: {verdict}", ""]
    lines += [f"- loss: {_in_markdown(reason)}" for reason in report.reasons]
    lines += [f"- gain: {_in_markdown(gain)}" for gain in report.gains]
    lines += [f"- {_in_markdown(note)}" for note in report.notes]
    names = "| task | success | median time | lost | won | time | p, success | p, time |"
    lines += ["", names, "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    for task in report.tasks:
        time = "" if task.time_s is None else f"{task.time_s:.2f} s"
        cells = [_in_markdown(task.name), f"{task.successes}/{task.n}", time]
        if task.name in report.comparisons:
            c = report.comparisons[task.name]
            cells += [str(len(c.lost)), str(len(c.won)), *_changes(c.changes)]
        lines.append(f"| {' | '.join([*cells, *[''] * (8 - len(cells))])} |")
    for name, changes in report.together.items():
        lines.append(f"| {name} |  |  |  |  | {' | '.join(_changes(changes))} |")
    moved = report.moved_most()
    if moved:
        lines += ["", "Trials that moved most:", ""]
        lines += [f"- {_in_markdown(str(trial))}: `{trial.command}`" for trial in moved]
    return "\n".join(lines) + "\n"


def _changes(changes: Mapping[str, Change]) -> list[str]:
    time, success = changes[TIME], changes[SUCCESS]
    p = [f"{min(change.p_loss, change.p_gain):.2g}" for change in (success, time)]
    return [f"{100 * time.change:+.1f} %", *p]


def _in_markdown(text: str) -> str:
    """Text in one line, with the special characters of Markdown and HTML escaped."""
    return re.sub(r"([\\`*_{}\[\]<>|#])", r"\\\1", " ".join(_legal(text).split()))


_ILLEGAL = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 cannot contain, not even escaped."""


def junit(report: Report) -> str:
    """JUnit XML with a test for every task, and for every arm with several compared tasks.

    A loss beyond chance is a failure, and crashed trials are an error. If a test has both, it is an
    error that names both. Allowed crashes are only reported. The output names failed seeds and the
    commands that run them again. Tests have no `time`, since a trial has only simulated time.
    """
    suite = ElementTree.Element("testsuite", name="sandbox regress")
    outcomes = [_add_test(suite, report, task) for task in report.tasks]
    outcomes += [_add_together(suite, report, name) for name in report.together]
    for attribute, outcome in (
        ("tests", None),
        ("failures", "failure"),
        ("errors", "error"),
        ("skipped", "skipped"),
    ):
        suite.set(attribute, str(len(outcomes) if outcome is None else outcomes.count(outcome)))
    suites = ElementTree.Element("testsuites")
    suites.append(suite)
    ElementTree.indent(suites)
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n' + ElementTree.tostring(suites, "unicode") + "\n"
    )


def save_junit(report: Report, path: Path) -> None:
    """Writes the JUnit XML.

    Raises:
        InputError: The file cannot be written.
    """
    write_whole(path, junit(report), "--junit")


def _add_test(suite: ElementTree.Element, report: Report, task: TaskResult) -> str | None:
    """Adds a task's test; returns the tag of its outcome, None if it passed."""
    case = ElementTree.SubElement(
        suite, "testcase", classname="sandbox.regress", name=_legal(task.name)
    )
    properties = ElementTree.SubElement(case, "properties")
    for name, value in task.as_json().items():
        if isinstance(value, list):
            value = ",".join(map(str, value))
        if value not in (None, ""):
            ElementTree.SubElement(properties, "property", name=name, value=_legal(str(value)))
    broken = [r for r in report.reasons if r.startswith(f"{task.name}: ")]
    crashed = task.crashed if report.crashes.too_many else []
    outcome = None
    if not report.complete:
        outcome = "skipped"
        ElementTree.SubElement(case, outcome, message="the run broke off: nothing is judged")
    elif broken or crashed:
        outcome = "error" if crashed else "failure"
        said = [f"seed {t['seed']} crashed: {t['reason']}" for t in crashed] + broken
        wrong = ElementTree.SubElement(case, outcome, message=_legal("; ".join(said)))
        again = [report.command(t) for t in crashed]
        wrong.text = _legal("\n".join([*said, *again]))
    ElementTree.SubElement(case, "system-out").text = _legal(_failed_text(report, task))
    return outcome


def _add_together(suite: ElementTree.Element, report: Report, name: str) -> str | None:
    """Adds the test of an arm's tasks together; returns the tag of its outcome, None if it
    passed."""
    case = ElementTree.SubElement(suite, "testcase", classname="sandbox.regress", name=name)
    if not report.complete:
        ElementTree.SubElement(case, "skipped", message="the run broke off: nothing is judged")
        return "skipped"
    broken = [r for r in report.reasons if r.startswith(f"{name}: ")]
    if not broken:
        return None
    wrong = ElementTree.SubElement(case, "failure", message="; ".join(broken))
    moved = [f"{trial}\n  {trial.command}" for trial in report.moved_most()]
    wrong.text = _legal("\n".join([*broken, *moved]))
    return "failure"


def _failed_text(report: Report, task: TaskResult) -> str:
    lines = [f"{task.successes} of {counted(task.n, 'trial')} succeeded"]
    lines += [
        f"seed {t['seed']}: {t['status']}, {t['reason']}\n  {report.command(t)}"
        for t in task.failed
    ]
    return "\n".join(lines)


def _legal(text: str) -> str:
    return _ILLEGAL.sub("�", text)
