"""Varied trials start as they would be set up: nothing in another thing, goals where they fit."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.errors import InputError
from models.mechanisms.mechanism import Part
from sandbox.cli.main import main
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.recording.recording import load_recording
from sandbox.trial.assembly import build, drawn
from sandbox.trial.headless import run_trial
from sandbox.trial.replay import replay
from sandbox.trial.settings import RunSettings
from tasks.mechanisms.case import HEIGHT
from tasks.task import Task


def varied(task: str, vary: str, seed: int = 1, rules: int = 2) -> Task:
    """A trial of a task as `--vary` makes it, by the number of its rules."""
    settings = plan(SceneOptions(task=task, seed=seed, vary=vary)).settings
    return drawn(replace(settings, vary_rules=rules))[0]


@pytest.mark.parametrize(
    ("task", "seed", "vary", "first", "second"),
    [
        ("stack", 2, "size=1.6", "base", "second"),
        ("stack-three", 3, "size=1.6", "base", "third"),
        ("stack-vertical", 2, "size=2", "base", "second"),
        ("slalom", 1, "size=2", "box", "pin2"),
        ("slalom", 3, "room=0.25", "box", "pin1"),
        ("gather", 1, "size=1.6", "die3", "die6"),
        ("books", 1, "size=2", "box", "book1"),
        ("insert", 1, "size=3", "peg", "socket"),
    ],
)
def test_things_that_would_start_in_each_other_are_both_named_before_the_trial(
    task: str, seed: int, vary: str, first: str, second: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", task, "--seed", str(seed), "--vary", vary]) == 2
    said = capsys.readouterr()
    assert not said.out and said.err.count("\n") == 1
    assert f"{task}, seed {seed}" in said.err
    assert f"{first} and {second} overlap at the start" in said.err


@pytest.mark.parametrize("task", ["stack", "slalom", "gather", "books", "insert", "close-case"])
@pytest.mark.parametrize("vary", ["size=0.8", "size=1.1", "mass=3"])
def test_values_that_leave_things_apart_are_played(task: str, vary: str) -> None:
    assert varied(task, vary).name == task


@pytest.mark.parametrize("size", [0.4, 0.7, 1.2, 2.0])
def test_a_case_of_another_size_lies_on_the_table(size: float) -> None:
    case, cap = varied("close-case", f"size={size}").objects
    assert isinstance(case, Part) and isinstance(cap, Part)
    assert case.position[2] == pytest.approx(size * HEIGHT / 2)
    assert case.lowest == pytest.approx(0.0, abs=1e-9) == cap.lowest
    # Nothing falls or is thrown when the trial begins.
    chosen = plan(SceneOptions(task="close-case", user="idle", seed=1, vary=f"size={size}"))
    session = build(chosen.settings, chosen.makers)
    for _ in range(20):
        session.advance()
    now, _ = session.scene.object_pose(session.data, "case")
    assert np.linalg.norm(now - case.position) < 2e-4
    session.close()


def test_a_recording_of_a_case_above_the_table_replays_to_the_bit(tmp_path: Path) -> None:
    vary = "size=0.7"
    chosen = plan(SceneOptions(task="close-case", seed=1, vary=vary, user="idle"))
    path = tmp_path / "earlier.jsonl"
    earlier = replace(chosen.settings, vary_rules=1)
    run_trial(earlier, chosen.makers, record=path, about=chosen.about)
    session, found = replay(load_recording(path))
    assert found.exact and found.complete
    assert session.task.objects[0].position[2] == pytest.approx(HEIGHT / 2)


def test_a_recording_of_things_that_overlap_still_replays_to_the_bit(tmp_path: Path) -> None:
    chosen = plan(SceneOptions(task="stack", seed=2, vary="size=1.6", user="idle"))
    earlier = replace(chosen.settings, vary_rules=1)
    path = tmp_path / "earlier.jsonl"
    run_trial(earlier, chosen.makers, record=path, about=chosen.about)
    recording = load_recording(path)
    assert "vary_rules" not in recording.header["settings"]
    _, found = replay(recording)
    assert found.exact and found.complete
    # As a device its touches play under the rules that it was made with.
    again = plan(SceneOptions(device=str(path)))
    assert again.settings.vary_rules == 1 and drawn(again.settings)[0].seed == 2


def test_rules_of_variation_are_in_the_header_of_a_varied_trial_alone() -> None:
    plain, changed = (
        plan(SceneOptions(task="stack", vary=vary)).settings for vary in ("", "size=0.9")
    )
    assert "vary_rules" not in plain.as_json() and changed.as_json()["vary_rules"] == 2
    for settings in (plain, changed, replace(changed, vary_rules=1)):
        assert RunSettings.from_json(settings.as_json()) == settings
    with pytest.raises(InputError, match="no such rules"):
        RunSettings(vary_rules=3)
