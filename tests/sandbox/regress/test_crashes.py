"""A trial that crashed fails a regression run, unless so many may crash."""

from __future__ import annotations

import json
import math
import pickle
from dataclasses import replace
from pathlib import Path
from typing import ClassVar
from xml.etree import ElementTree

import pytest

from models.errors import InputError, SurfaceTooSmallError
from models.surface import Surface
from sandbox.cli.main import main
from sandbox.regress.execute import CRASHED, Executor, Processes, Serial
from sandbox.regress.run_plan import RegressionPlan, registered
from sandbox.regression import Regression
from sandbox.study.design.reading import DesignError, Mistake
from tasks.box_to_goal import BoxToGoal
from tasks.sensing import Sensing
from tasks.task import Measure
from tests.support.regress_tasks import Exiting, NoPlace, Quick, Raising


def regress(task: type[Quick], *words: str | Path) -> int:
    more = ["--tasks", task.name, "--seeds", "0:12", "--executor", "serial", *map(str, words)]
    with registered(task):
        return main(["regress", *more])


def test_one_crash_among_twelve_fails_the_run_and_is_named_with_its_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, xml = tmp_path / "out.json", tmp_path / "out.xml"
    assert regress(Raising, "--json", out, "--junit", xml) == 1
    shown = capsys.readouterr().out
    (line,) = [line for line in shown.splitlines() if line.startswith("crashed ")]
    assert line.startswith("crashed raising seed 1: ")
    found = json.loads(out.read_text())
    assert found["complete"] and found["passed"] is False
    assert (found["crashes"]["count"], found["crashes"]["allowed"]) == (1, 0)
    suite = ElementTree.parse(xml).getroot()[0]
    counts = {name: suite.get(name) for name in ("tests", "errors", "failures", "skipped")}
    assert counts == {"tests": "1", "errors": "1", "failures": "0", "skipped": "0"}
    error = suite.find("testcase/error")
    assert error is not None
    assert "ZeroDivisionError: a lab's own bug" in error.get("message", "")
    assert (error.text or "").splitlines()[-1] == "sandbox run raising --seed 1"


def test_no_baseline_is_made_from_crashes_even_if_they_are_allowed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    base = tmp_path / "base.json"
    for allowed in ("0", "1"):
        words = ("--baseline", base, "--update-baseline", "--allow-crashes", allowed)
        assert regress(Raising, *words) == 1
        assert "no baseline is made" in capsys.readouterr().out
    assert not base.exists()


def test_a_crash_is_no_state_of_another_machine(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    base, out = tmp_path / "base.json", tmp_path / "out.json"
    assert regress(Quick, "--baseline", base, "--update-baseline") == 0
    base.write_text(base.read_text().replace('"quick"', '"raising"'))
    capsys.readouterr()
    assert regress(Raising, "--baseline", base, "--exact", "--json", out) == 1
    shown = capsys.readouterr().out
    assert "states of 11 trials equal to the bit" in shown and "another kind" not in shown
    assert json.loads(out.read_text())["tasks"]["raising"]["baseline"]["lost"] == [1]


@pytest.mark.parametrize("executor", [Serial(), Processes(1)])
def test_a_trial_that_ends_the_program_is_a_crash(executor: Executor) -> None:
    trials = list(executor.run(RegressionPlan((Exiting,), (1, 4)).jobs()))
    assert [t["status"] == CRASHED for t in trials] == [True, False]
    assert "SystemExit" in trials[0]["reason"]


def test_a_lab_s_own_test_fails_by_a_crash_and_may_allow_it(tmp_path: Path) -> None:
    regression = Regression(tmp_path, tmp_path)
    with pytest.raises(AssertionError, match=r"1 trial crashed(.|\n)*seed 1: .*ZeroDivisionError"):
        regression(Raising, "0:2")
    assert len(regression(Raising, "0:2", allow_crashes=1).crashes.trials) == 1


def test_an_error_of_any_class_comes_whole_from_another_process(
    capsys: pytest.CaptureFixture[str],
) -> None:
    words = ["regress", "--tasks", "box-to-goal", "--surface", "50x40mm", "--seeds", "0:1"]
    assert main([*words, "--workers", "1"]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "the surface is too small for this task" in line
    small = SurfaceTooSmallError("box-to-goal", (2.0, 1.5), "a box", (7.8, 5.8))
    wrong = DesignError("design.toml", [Mistake(3, "seed", "got -1", "Write 0 or more")])
    for error in (small, wrong, InputError("wrong", where="here", got=3)):
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is type(error) and str(again) == str(error)
        assert vars(again) == vars(error)


class NoNumber(Quick):
    """The progress of seed 2 is no number."""

    name: ClassVar[str] = "no-number"

    def measure(self, sensing: Sensing) -> Measure:
        found = super().measure(sensing)
        return replace(found, progress=math.nan) if self.seed == 2 else found


@pytest.mark.parametrize(
    ("task", "says"), [(NoPlace, "no room for the box"), (NoNumber, "not a finite number")]
)
@pytest.mark.parametrize("seeds", ["0:4", "2,0,1,3"])
def test_a_seed_that_cannot_be_drawn_or_measured_crashes_and_the_others_are_judged(
    task: type[Quick], says: str, seeds: str, tmp_path: Path
) -> None:
    out = tmp_path / "out.json"
    assert regress(task, "--seeds", seeds, "--json", out) == 1
    found = json.loads(out.read_text())
    assert found["complete"]
    status = {t["seed"]: t["status"] == CRASHED for t in found["trials"]}
    assert status == {0: False, 1: False, 2: True, 3: False}
    (crash,) = found["crashes"]["trials"]
    assert crash["seed"] == 2 and says in crash["reason"]
    (report,) = Regression(tmp_path, tmp_path)(task, "0:4", allow_crashes=1).tasks
    assert len(report.crashed) == 1


class NeverPlaced(Quick):
    """A task that can be drawn for no seed."""

    name: ClassVar[str] = "never-placed"

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> BoxToGoal:
        raise ValueError(f"no room for the box of seed {seed}")


def test_a_task_that_can_be_drawn_for_no_seed_ends_the_run_before_anything_is_played(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert regress(NeverPlaced, "--json", tmp_path / "out.json") == 2
    (line,) = capsys.readouterr().err.strip().splitlines()
    assert "no room for the box of seed 0" in line and not list(tmp_path.iterdir())
