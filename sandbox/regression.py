"""A pytest fixture for a lab's own task or encoder: `pytest_plugins = ["sandbox.regression"]`.

In a conftest.py of the test folder's root, or as `pytest -p sandbox.regression`, it also has the
options `--sandbox-update-baseline` and `--sandbox-workers N`.

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
"""Failed trials in the message of a test that fails."""


class Regression:
    """Runs a task over seeds and asserts that nothing was lost.

    Args:
        folder: Folder of the test, from which baselines are searched.
        scratch: Folder for what has to be a file.
        update: Baselines are made rather than compared with.
        workers: Processes; one runs everything in the test's own.
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
            task: A name, a place `FILE.py:Class`, or a class of one's own that the registry need
                not know. Files are searched from the test's folder, then from the current one.
            seeds: Such as `0:60`.
            encoder: A name, a file, or a trained model; files as for tasks.
            baseline: File to compare with, from the test's folder; made by
                `--sandbox-update-baseline`.
            at_least: Success rate 0 to 1; fewer successes than chance explains fail the test.
            exact: States must be equal where MuJoCo, architecture and libm are the baseline's.
            across_encoders: The baseline may be another encoder's.
            allow_crashes: Number of trials that may crash; more fail the test.
            arm: Which arms are played: the task as it is, the task made hard, or both.
            scene: Options of `sandbox run` with underscores: `fingers=5`, `bare=True`.

        Returns:
            The report, for assertions of one's own.

        Raises:
            AssertionError: A loss beyond chance, or trials that crashed.
            InputError: What is asked for cannot be run or compared.
        """
        __tracebackhide__ = True  # pytest then shows the line of the test, and what was lost
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
        """A place such as FILE.py:Class from the test's folder where the file is there, as given
        otherwise. It is seen from the current folder, so that printed commands hold elsewhere."""
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
        # The baseline of another encoder is made where that encoder is tested.
        if self.update and not across_encoders:
            check_whole(path, "baseline")
            # What is no baseline is told before the run.
            if replaceable(path) is None and path.exists():
                warnings.warn(f"{path} is replaced as a whole: it cannot be read", stacklevel=3)
            return None
        if not path.exists():
            raise InputError(
                "no such baseline",
                where=str(path),
                remedy=f"`pytest -p sandbox.regression {UPDATE}` makes it",
            )
        old = load_baseline(path)
        # Before the run rather than after it.
        old.check(plan.origin(), plan.versions(), across_encoders, exact)
        return old


def _toothless(report: Report, at_least: float | None) -> Iterator[str]:
    """Sentences on what cannot fail with so few seeds, whatever is lost."""
    needed = statistics.fewest_losses(level_of(report.comparisons))
    for name, comparison in report.comparisons.items():
        if comparison.pairs < needed:
            yield (
                f"{name}: of {counted(comparison.pairs, 'seed')}, no loss is beyond chance, so "
                f"this test cannot fail by its baseline: give {needed} seeds or more"
            )
    for task in report.tasks if at_least else ():
        if statistics.falls_short(0, task.n, float(at_least or 0.0)) > statistics.ALPHA:
            yield (
                f"{task.name}: of {counted(task.n, 'seed')}, no number of successes falls short "
                f"of {at_least:.0%} beyond chance, so this test cannot fail by at_least: give more "
                "seeds"
            )


def _assert(report: Report, at_least: float | None) -> None:
    __tracebackhide__ = True
    reasons = list(report.reasons)
    for task in report.tasks if at_least is not None else ():
        p = statistics.falls_short(task.successes, task.n, float(at_least or 0.0))
        if p <= statistics.ALPHA:
            reasons.append(
                f"{task.name}: {task.successes} of {task.n} succeeded, fewer than {at_least:.0%} "
                f"beyond chance (p = {p:.2g})"
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
    """Adds the options, where pytest asks early enough."""
    group = parser.getgroup("sandbox", "regression runs of Hand Sandbox")
    group.addoption(UPDATE, action="store_true", help="make baselines rather than compare")
    group.addoption(WORKERS, type=int, default=1, metavar="N", help="processes for trials")


@pytest.fixture
def regression(request: pytest.FixtureRequest, tmp_path: Path) -> Regression:
    """See `Regression`."""
    # A module's own `pytest_plugins` comes too late for options; their defaults hold then.
    return Regression(
        request.path.parent,
        tmp_path,
        bool(request.config.getoption(UPDATE, default=False)),
        int(request.config.getoption(WORKERS, default=1)),
    )
