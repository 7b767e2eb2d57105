"""A run plays every task as it is and made hard, and compares each arm with its own trials."""

from __future__ import annotations

import json
import shlex
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from models.errors import InputError
from sandbox.cli.main import main
from sandbox.cli.regress import main as regress
from sandbox.regress.baseline import load_baseline
from sandbox.regress.comparison import level_of
from sandbox.regress.execute import Serial
from sandbox.regress.run_plan import (
    ARMS,
    HARD_SETTINGS,
    RegressionPlan,
    arm_of,
    registered,
    row_name,
    setting_of,
)
from sandbox.trial.assembly import drawn
from tasks.registry import TASKS, is_built_in
from tests.support.processes import ROOT
from tests.support.regress_tasks import Quick

BOTH = ["quick", "quick (hard)"]


@pytest.fixture(autouse=True)
def hard_quick(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The task `quick`, with a hard arm."""
    monkeypatch.setitem(HARD_SETTINGS, "quick", "friction=0.5,noise=1")
    with registered(Quick):
        yield


def run(folder: Path, *words: str) -> int:
    common = ["--tasks", "quick", "--seeds", "0:12", "--executor", "serial"]
    report = ["--json", str(folder / "report.json"), "--baseline", str(folder / "base.json")]
    return regress([*common, *report, *words])


def test_both_arms_are_played_stored_and_compared(tmp_path: Path) -> None:
    assert run(tmp_path, "--update-baseline") == 0
    made = load_baseline(tmp_path / "base.json")
    assert [*made.tasks] == BOTH
    assert [task.vary for task in made.tasks.values()] == ["", "friction=0.5,noise=1"]
    assert all(len(task.repeats) == 10 for task in made.tasks.values())
    hashes = [[t.state_hash for t in task.trials.values()] for task in made.tasks.values()]
    assert not set(hashes[0]) & set(hashes[1])
    assert run(tmp_path, "--exact") == 0
    report = json.loads((tmp_path / "report.json").read_text())
    assert [*report["tasks"]] == BOTH and report["notes"]
    for name in BOTH:
        task = report["tasks"][name]
        assert task["vary"] == setting_of(name) and task["baseline"]["same_machine"] == 12


@pytest.mark.parametrize(("arm", "names"), [("plain", BOTH[:1]), ("hard", BOTH[1:])])
def test_an_option_plays_one_arm(tmp_path: Path, arm: str, names: list[str]) -> None:
    assert run(tmp_path, "--update-baseline", "--arm", arm) == 0
    assert [*load_baseline(tmp_path / "base.json").tasks] == names


def test_a_baseline_without_the_hard_arm_is_compared_in_the_plain_one_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert run(tmp_path, "--update-baseline", "--arm", "plain") == 0
    assert run(tmp_path) == 0
    report = json.loads((tmp_path / "report.json").read_text())
    assert "baseline" in report["tasks"]["quick"]
    assert "baseline" not in report["tasks"]["quick (hard)"]
    (note,) = [note for note in report["notes"] if "hard arm" in note]
    # Trials of another setting are as incomparable as none.
    assert run(tmp_path, "--update-baseline") == 0
    monkeypatch.setitem(HARD_SETTINGS, "quick", "friction=0.4")
    assert run(tmp_path) == 0
    assert note in json.loads((tmp_path / "report.json").read_text())["notes"]


def test_the_line_that_runs_a_hard_trial_again_gives_its_state(tmp_path: Path) -> None:
    plan = RegressionPlan(("quick",), (3,), arms=ARMS["both"])
    plain, hard = Serial().run(plan.jobs())
    assert [plain["task"], hard["task"]] == BOTH
    words = shlex.split(plan.command("quick (hard)", 3).partition(" && ")[0])
    assert words[-1] == "quick-hard-3.jsonl"
    assert main([*words[1:-2], "--json", str(tmp_path / "again.json")]) == 0
    again = json.loads((tmp_path / "again.json").read_text())
    assert again["state_hash"] == hard["state_hash"] != plain["state_hash"]


def test_the_hard_settings_can_be_drawn_and_are_on_the_page() -> None:
    page = (ROOT / "docs" / "results.md").read_text()
    built_in = {name for name, task in TASKS.items() if is_built_in(task)}
    assert {*HARD_SETTINGS} - {"quick"} == built_in
    for task, setting in HARD_SETTINGS.items():
        if task != "quick":
            assert f"| {task} | `{setting}` |" in page
        (job,) = RegressionPlan((task,), (0,), arms=ARMS["hard"]).jobs()
        assert not job.settings.variation.neutral
        drawn(job.settings)


def test_a_task_without_a_hard_arm_is_played_plain_and_refused_alone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.delitem(HARD_SETTINGS, "quick")
    plan = RegressionPlan(("quick",), (0,), arms=ARMS["both"])
    assert plan.names == ("quick",)
    with pytest.raises(InputError, match="none of these tasks has a hard arm"):
        replace(plan, arms=ARMS["hard"])


def test_a_hard_arm_has_no_other_variation() -> None:
    with pytest.raises(InputError, match="has its own variation"):
        RegressionPlan(("quick",), (0,), {"vary": "noise=1"}, arms=ARMS["both"])


def test_holm_spans_the_tasks_of_both_arms_and_each_arm_together() -> None:
    names = [row_name(task, arm) for arm in ARMS["both"] for task in ("stack", "dial")]
    assert [arm_of(name) for name in names] == ["plain", "plain", "hard", "hard"]
    # Two measures of four rows and two arms.
    assert level_of(names) == pytest.approx(0.02 / 12)
    assert level_of(names[:1]) == pytest.approx(0.02 / 2)
