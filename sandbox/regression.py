"""A pytest plugin with the fixture `regression`, for tests of a lab's own task or encoder.

Enable it with `pytest_plugins = ["sandbox.regression"]` in a test file. If this line is in the
conftest.py of pytest's root folder, or with `pytest -p sandbox.regression`, the plugin also adds
the options `--sandbox-update-baseline` and `--sandbox-workers N`.

    def test_our_encoder_is_no_worse(regression):
        regression("box-to-goal", seeds="0:60", encoder="ours.npz", baseline="base.json")
"""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import pytest

from encoders.regression.model_registry import DEFAULT_MODEL
from encoders.regression.trained import TrainedModel
from encoders.regression.training import save_model
from models.errors import InputError
from models.message import counted
from sandbox.regress import statistics
from sandbox.regress.baseline import Baseline, load_baseline, replaceable, update
from sandbox.regress.comparison import level_of
from sandbox.regress.execute import CRASHED, Processes, Serial
from sandbox.regress.run_plan import ARMS, RegressionPlan, find_tasks, parse_seeds
from sandbox.regress.run_report import Report, make_report, without_baseline
from sandbox.system.files import check_whole
from tasks.task import Task

UPDATE = "--sandbox-update-baseline"
WORKERS = "--sandbox-workers"
MOST_NAMED = 5
"""Largest number of failed trials in the message of a failed test."""


class Regression:
    """Runs a task over many seeds and asserts that there is no loss against a baseline.

    Args:
        folder: Folder of the test. Paths of baselines are relative to it.
        scratch: Folder for temporary files.
        update: True writes baselines instead of comparing with them.
        workers: Number of processes; 1 runs all trials in the process of the test.
    """

    def __init__(self, folder: Path, scratch: Path, update: bool = False, workers: int = 1) -> None:
        self.folder, self.scratch = folder, scratch
        self.update, self.workers = update, workers

    def __call__(
        self,
        task: str | type[Task] = "box-to-goal",
        seeds: str = "0:30",
        encoder: str | Path | TrainedModel = DEFAULT_MODEL,
        baseline: str | Path | None = None,
        *,
        at_least: float | None = None,
        exact: bool = False,
        across_encoders: bool = False,
        allow_crashes: int = 0,
        arm: Literal["plain", "hard", "both"] = "plain",
        **scene: Any,
    ) -> Report:
        """Runs the trials.

        Args:
            task: A name, a place `FILE.py:Class`, or a task class, which need not be registered.
                Files are searched in the test's folder, then in the current folder.
            seeds: Seeds, such as `0:60`.
            encoder: A name, a file, or a trained model. Files are searched as for tasks.
            baseline: Baseline file, relative to the test's folder. `--sandbox-update-baseline`
                writes it.
            at_least: Success rate, 0 to 1. The test fails if success is significantly lower.
            exact: True requires equal states on machines with the baseline's fingerprint.
            across_encoders: True allows a baseline of another encoder.
            allow_crashes: Number of trials that may crash; the test fails if more trials crash.
            arm: `plain`, `hard` (the task with its hard variation), or `both`.
            scene: Options of `sandbox run` with underscores: `fingers=5`, `bare=True`.

        Returns:
            The report, for further assertions.

        Raises:
            AssertionError: A loss beyond chance, or too many trials crashed.
            InputError: The trials cannot be run or compared.
        """
        __tracebackhide__ = True  # pytest then shows the line of the test and the message
        plan = RegressionPlan(
            find_tasks([self._resolved(task)]) if isinstance(task, str) else (task,),
            parse_seeds(seeds),
            {"encoder": self._encoder(encoder), **scene},
            arms=ARMS[arm],
        )
        try:
            plan.check_drawn()
            old = self._baseline(baseline, plan, across_encoders, exact)
        except InputError as error:
            raise error.with_traceback(None) from None
        executor = Processes(self.workers) if self.workers > 1 else Serial()
        trials = list(executor.run(plan.jobs()))
        if baseline is not None and self.update and not across_encoders:
            report = make_report(plan, trials)
            update(self.folder / baseline, plan.origin(), plan.versions(), trials)
        else:
            report = make_report(plan, trials, old, exact, across_encoders, allow_crashes)
            for name, comparison in report.comparisons.items():
                if comparison.unpaired:
                    warnings.warn(
                        f"{name}: {without_baseline(comparison.unpaired)}. "
                        f"`pytest -p sandbox.regression {UPDATE}` adds them",
                        stacklevel=2,
                    )
        for warning in _toothless(report, at_least):
            warnings.warn(warning, stacklevel=2)
        _assert(report, at_least)
        return report

    def _encoder(self, encoder: str | Path | TrainedModel) -> str:
        if isinstance(encoder, TrainedModel):
            path = self.scratch / f"{encoder.digest}.npz"
            if not path.exists():
                save_model(encoder, path)
            return str(path)
        return self._resolved(str(encoder))

    def _resolved(self, place: str) -> str:
        """A place such as FILE.py:Class, with the file in the test's folder if it exists there.

        If the file is inside the current folder, its path is relative to that folder, so that
        printed commands are short and can be run there.
        """
        file, colon, name = place.partition(":")
        here = self.folder / file
        if not here.is_file():
            return place
        if here.is_relative_to(Path.cwd()):
            here = here.relative_to(Path.cwd())
        return f"{here}{colon}{name}"

    def _baseline(
        self, name: str | Path | None, plan: RegressionPlan, across_encoders: bool, exact: bool
    ) -> Baseline | None:
        if name is None:
            return None
        path = self.folder / name
        # With `across_encoders`, another test, that of the baseline's encoder, writes the baseline.
        if self.update and not across_encoders:
            check_whole(path, "baseline")
            # If the file is not a baseline, report this before the run.
            if replaceable(path) is None and path.exists():
                warnings.warn(f"{path} cannot be read, and is replaced as a whole", stacklevel=3)
            return None
        if not path.exists():
            raise InputError(
                "no such baseline",
                where=str(path),
                remedy=f"`pytest -p sandbox.regression {UPDATE}` writes it",
            )
        old = load_baseline(path)
        # Check before the run, not after it.
        old.check(plan.origin(), plan.versions(), across_encoders, exact)
        return old


def _toothless(report: Report, at_least: float | None) -> Iterator[str]:
    """Warnings about checks that cannot fail, because the test has too few seeds."""
    needed = statistics.fewest_losses(level_of(report.comparisons))
    for name, comparison in report.comparisons.items():
        if comparison.pairs < needed:
            yield (
                f"{name}: with {counted(comparison.pairs, 'seed')}, no loss can be significant, so "
                f"the baseline cannot make this test fail: give at least {needed} seeds"
            )
    for task in report.tasks if at_least else ():
        if statistics.falls_short(0, task.n, float(at_least or 0.0)) > statistics.ALPHA:
            yield (
                f"{task.name}: with {counted(task.n, 'seed')}, even 0 successes would not be "
                f"significantly fewer than {at_least:.0%}, so at_least cannot make this test fail: "
                "give more seeds"
            )


def _assert(report: Report, at_least: float | None) -> None:
    __tracebackhide__ = True
    reasons = list(report.reasons)
    for task in report.tasks if at_least is not None else ():
        p = statistics.falls_short(task.successes, task.n, float(at_least or 0.0))
        if p <= statistics.ALPHA:
            reasons.append(
                f"{task.name}: {task.successes} of {task.n} succeeded, significantly fewer than "
                f"{at_least:.0%} (p = {p:.2g})"
            )
    if not reasons:
        return
    lost = {(name, seed) for name, c in report.comparisons.items() for seed in c.lost}
    failed = [t for task in report.tasks for t in task.failed]
    crashed = report.crashes.too_many
    failed.sort(
        key=lambda t: (not (crashed and t["status"] == CRASHED), (t["task"], t["seed"]) not in lost)
    )
    lines = [f"seed {t['seed']}: {t['reason']}\n  {report.command(t)}" for t in failed[:MOST_NAMED]]
    lines += [f"{trial}\n  {trial.command}" for trial in report.moved_most()[:MOST_NAMED]]
    raise AssertionError("\n".join([*reasons, *lines]))


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds the options; pytest calls this only if the plugin is loaded early enough."""
    group = parser.getgroup("sandbox", "regression runs of Hand Sandbox")
    group.addoption(UPDATE, action="store_true", help="write baselines instead of comparing")
    group.addoption(WORKERS, type=int, default=1, metavar="N", help="processes for trials")


@pytest.fixture
def regression(request: pytest.FixtureRequest, tmp_path: Path) -> Regression:
    """Fixture of this plugin; see `Regression`."""
    # `pytest_plugins` in a test module is too late for options; their defaults apply then.
    return Regression(
        request.path.parent,
        tmp_path,
        bool(request.config.getoption(UPDATE, default=False)),
        int(request.config.getoption(WORKERS, default=1)),
    )
