"""A run plays every task as it is and made hard, and compares each arm with its own trials."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from sandbox.cli.regress import main as regress
from sandbox.regress.baseline import load_baseline
from sandbox.regress.comparison import level_of
from sandbox.regress.run_plan import (
    ARMS,
    HARD_SETTINGS,
    arm_of,
    registered,
    row_name,
    setting_of,
)
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


def test_holm_spans_the_tasks_of_both_arms_and_each_arm_together() -> None:
    names = [row_name(task, arm) for arm in ARMS["both"] for task in ("stack", "dial")]
    assert [arm_of(name) for name in names] == ["plain", "plain", "hard", "hard"]
    # Two measures of four rows and two arms.
    assert level_of(names) == pytest.approx(0.02 / 12)
    assert level_of(names[:1]) == pytest.approx(0.02 / 2)
