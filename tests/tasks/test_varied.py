"""Varied trials start as they would be set up: nothing in another thing, goals where they fit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from models.errors import InputError
from models.mechanisms.mechanism import Part
from sandbox.cli.main import main
from sandbox.study.design.reading import DesignError
from sandbox.study.run.players import RunningAttempt, TrialRequest
from sandbox.trial.assembly import build, device_makers, drawn
from sandbox.trial.driver import open_trial
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.mechanisms.close_case import HEIGHT
from tasks.task import Task
from tests.support.study_files import design

TASKS = """
schema = 1
name = "larger"
title = "Larger things"
seed = 3
participants = 2
languages = ["en"]
[settings]
surface = "ipad2"
vary = "{vary}"
[[factors]]
name = "task"
order = "random"
levels = []
[trials]
repetitions = 1
expected_s = 15
"""


def varied(task: str, vary: str, seed: int = 1) -> Task:
    """A trial of a task as `--vary` makes it."""
    return drawn(trial_settings(TrialOptions(task=task, seed=seed, vary=vary)))[0]


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


@pytest.mark.parametrize("size", [0.4, 0.7, 1.2, 2.0])
def test_a_case_of_another_size_lies_on_the_table(size: float) -> None:
    case, cap = varied("close-case", f"size={size}").objects
    assert isinstance(case, Part) and isinstance(cap, Part)
    assert case.position[2] == pytest.approx(size * HEIGHT / 2)
    assert case.lowest == pytest.approx(0.0, abs=1e-9) == cap.lowest
    # Nothing falls or is thrown when the trial begins.
    chosen = trial_settings(
        TrialOptions(task="close-case", user="idle", seed=1, vary=f"size={size}")
    )
    session = build(chosen, device_makers(chosen))
    for _ in range(20):
        session.advance()
    now, _ = session.scene.object_pose(session.data, "case")
    assert np.linalg.norm(now - case.position) < 2e-4
    session.close()


@pytest.mark.parametrize("size", [0.5, 0.85, 1.3])
@pytest.mark.parametrize("seed", [1, 2, 3])
@pytest.mark.parametrize("task", ["chords", "single-keys", "dial", "close-case"])
def test_goals_of_a_resized_mechanism_are_where_its_joints_take_its_parts(
    task: str, seed: int, size: float
) -> None:
    plain, changed = varied(task, "", seed), varied(task, f"size={size}", seed)
    parts = {part.name: part for part in changed.objects if isinstance(part, Part)}
    for goal, old in zip(changed.goals, plain.goals, strict=True):
        part, was = parts[goal.object], next(p for p in plain.objects if p.name == goal.object)
        assert isinstance(was, Part) and was.joint and part.joint and was.joint.range
        # The value of the joint at the goal, found from the ends of its range.
        ends = [np.array(was.placed(v)[0]) for v in was.joint.range]
        if was.joint.kind == "hinge":
            value = plain.mark  # type: ignore[attr-defined]
        else:
            way = ends[1] - ends[0]
            value = size * was.joint.range[1] * float(np.dot(old.position - ends[0], way))
            value /= float(np.dot(way, way))
        position, yaw = part.placed(value)
        assert goal.position == pytest.approx(position, abs=1e-9)
        assert goal.yaw == pytest.approx(yaw)


@pytest.mark.parametrize(
    ("task", "carried"), [("slalom", "box"), ("books", "box"), ("insert", "peg")]
)
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("mm", [5, 20])
def test_only_what_is_to_be_carried_starts_elsewhere(
    task: str, carried: str, seed: int, mm: int
) -> None:
    plain, moved = varied(task, "", seed), varied(task, f"start={mm}", seed)
    for old, new in zip(plain.objects, moved.objects, strict=True):
        way = np.subtract(new.position, old.position)
        far = mm / 1000 if old.name == carried else 0.0
        assert np.linalg.norm(way) == pytest.approx(far, abs=1e-12) and way[2] == 0.0
    assert moved.goals == plain.goals


@pytest.mark.parametrize("task", ["box-to-goal", "slalom", "books", "insert"])
@pytest.mark.parametrize("seed", range(6))
def test_a_shifted_start_is_no_nearer_to_the_goal(task: str, seed: int) -> None:
    plain, moved = varied(task, "", seed), varied(task, "start=40", seed)
    goal = {goal.object: goal.position for goal in plain.goals}
    pairs = zip(plain.objects, moved.objects, strict=True)
    for old, new in ((old, new) for old, new in pairs if old.name in goal):
        before, after = (np.linalg.norm(np.subtract(o.position, goal[o.name])) for o in (old, new))
        assert after >= before


def test_a_larger_ring_that_holds_dice_already_is_refused() -> None:
    assert varied("gather", "room=1.2", 8).painted[0].radius == pytest.approx(0.048)
    with pytest.raises(InputError, match="start inside of the ring"):
        varied("gather", "room=2", 8)


def test_a_task_of_ones_own_says_what_is_shifted(tmp_path: Path) -> None:
    text = """
from models import Box
from tasks import CustomTask, Goal, judge

class Own(CustomTask):
    name = "NAME"

    @classmethod
    def place(cls, rng, surface):
        boxes = [Box(n, (.01,) * 3, .1, (x, 0, .01)) for n, x in (("red", -.03), ("blue", .03))]
        return boxes, [Goal("red", (0, .03, .01), 0.0)]

    def measure(self, sensing):
        return judge(0.0, (True, "not yet"))
"""

    def moved(name: str, more: str = "") -> set[str]:
        path = tmp_path / f"{name}.py"
        path.write_text(text.replace("NAME", name) + more)
        plain, changed = varied(str(path), ""), varied(str(path), "start=10")
        pairs = zip(plain.objects, changed.objects, strict=True)
        return {old.name for old, new in pairs if old.position != new.position}

    assert moved("lab-all") == {"red", "blue"}
    assert moved("lab-one", "\n    def shifted(self): return ['red']\n") == {"red"}
    with pytest.raises(InputError, match=r"`shifted` does not name.*green.*red, blue"):
        moved("lab-wrong", "\n    def shifted(self): return ['green']\n")


def test_a_design_is_refused_for_any_of_many_seeds_and_a_participant_is_never_stopped(
    tmp_path: Path,
) -> None:
    # Of the first 20 seeds only 10 has boxes that overlap; the design's own is another.
    text = TASKS.replace("[]", '["stack", "box-to-goal"]').format(vary="size=1.3")
    with pytest.raises(DesignError, match=r"stack, seed 10, varied.*overlap at the start"):
        design(text)
    chosen = trial_settings(TrialOptions(task="stack", seed=10, vary="size=1.3", user="idle"))
    with pytest.raises(InputError, match="overlap"), open_trial(chosen):
        pass
    request = TrialRequest(
        *(chosen, device_makers(chosen), tmp_path / "t.jsonl", {}),
        time_limit=5.0,
        watch=lambda: "",
        paused=lambda: False,
    )
    with RunningAttempt(request).open() as trial:
        assert trial.session.task.seed == 10
