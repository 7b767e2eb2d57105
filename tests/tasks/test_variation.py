"""Varied trials: what is varied changes by just that much, goals fit, and nothing overlaps."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arithmetic import Array
from models.errors import InputError
from models.frames import Contact, TouchFrame
from models.mechanism import Part
from models.objects import Wrench
from models.scene import CONTROL_PERIOD
from models.surface import Surface
from sandbox.cli.main import main
from sandbox.devices.wrappers.degraded import (
    FIRST_GHOST,
    GHOST_LENGTH,
    LENGTH,
    DegradedDevice,
)
from sandbox.study.design.reading import DesignError
from sandbox.study.run.players import RunningAttempt, TrialRequest
from sandbox.trial.assembly import build, device_makers, drawn
from sandbox.trial.driver import open_trial
from sandbox.trial.settings import Settings, decoded, encoded
from sandbox.trial.trial_options import TrialOptions, parse_variation, trial_settings
from tasks.box_to_goal import BoxToGoal
from tasks.close_case import HEIGHT
from tasks.stack import Stack, StackThree
from tasks.task import Task, place, place_surface
from tasks.variation import RANGES, Variation, vary
from tasks.wrench import WrenchSlide
from tests.support.scripted import Played
from tests.support.study_files import design

FLAT = place_surface(Surface(), BoxToGoal)
STEP = CONTROL_PERIOD
seeds = st.integers(0, 10_000)


def frames_of(n: int, *contacts: Contact) -> list[TouchFrame]:
    return [TouchFrame(i * STEP, contacts) for i in range(n)]


def played(
    variation: Variation, frames: list[TouchFrame], seed: int = 0, more: int = 0
) -> list[TouchFrame | None]:
    """Frames that come out at every control period; None where there is none."""
    device = DegradedDevice(Played(frames), variation, FLAT, seed)
    out = []
    for i in range(len(frames) + more):
        polled = device.poll(i * STEP)
        out.append(polled[-1] if polled else None)
    return out


class Pose:
    def __init__(self, position: Array, rotation: Array) -> None:
        self.position, self.rotation = position, rotation


def standing(task: Task) -> dict[str, Pose]:
    """Poses of a task's boxes as they start."""
    return {box.name: Pose(np.array(box.position), np.eye(3)) for box in task.objects}


@given(seeds)
def test_a_neutral_variation_gives_the_very_same_trial(seed: int) -> None:
    task = BoxToGoal.draw(seed, FLAT)
    assert vary(task, Variation(), FLAT) is task
    assert vary(task, Variation(friction=0.5, latency=0.1, noise=1e-3), FLAT) is task


def test_a_run_with_a_neutral_variation_has_the_hash_of_one_without() -> None:
    def run(text: str) -> tuple[str, dict[str, Any]]:
        chosen = trial_settings(TrialOptions(seed=2, vary=text))
        session = build(chosen, device_makers(chosen))
        for _ in range(40):
            session.advance()
        return session.state_hash, encoded(chosen)

    plain = run("")
    assert run("size=1,mass=1,friction=1,hand-size=1,latency=0,noise=0,ghosts=0") == plain
    assert run("mass=2")[0] != plain[0]


@given(seeds, st.floats(0.05, 20.0))
@settings(max_examples=25)
def test_mass_times_k_gives_objects_k_times_as_heavy_and_nothing_else(seed: int, k: float) -> None:
    task = StackThree.draw(seed, FLAT)
    heavier = vary(task, Variation(mass=k), FLAT)
    pairs: Any = zip(heavier.objects, task.objects, strict=True)
    for box, was in pairs:
        assert box.mass == pytest.approx(k * was.mass)
        assert replace(box, mass=was.mass) == was
    assert heavier.goals == task.goals


@given(seeds, st.floats(0.3, 2.0))
def test_a_scaled_box_stands_on_the_table_at_its_start_and_at_its_goal(seed: int, k: float) -> None:
    task = BoxToGoal.draw(seed, FLAT)
    scaled = vary(task, Variation(size=k), FLAT)
    box: Any
    was: Any
    (box,), (was,) = scaled.objects, task.objects
    assert np.allclose(box.half_size, k * np.array(was.half_size))
    assert box.position[2] == pytest.approx(box.half_size[2])
    assert scaled.goals[0].position[2] == pytest.approx(box.half_size[2])
    assert box.position[:2] == was.position[:2]
    assert scaled.goals[0].position[:2] == task.goals[0].position[:2]
    assert (box.mass, box.yaw, scaled.goals[0].yaw) == (was.mass, was.yaw, task.goals[0].yaw)


@given(seeds, st.floats(0.3, 2.0))
@settings(max_examples=25)
def test_goals_of_scaled_stacks_lie_face_on_face(seed: int, k: float) -> None:
    scaled = vary(StackThree.draw(seed, FLAT), Variation(size=k), FLAT)
    boxes: Any = scaled.objects
    top = 2 * boxes[0].half_size[2]
    for goal, box in zip(place(scaled.goals, standing(scaled)), boxes[1:], strict=True):
        assert goal.position[2] == pytest.approx(top + box.half_size[2])
        top += 2 * box.half_size[2]


@given(seeds, st.floats(0.001, 0.030), st.sampled_from([BoxToGoal, Stack, WrenchSlide]))
def test_objects_start_just_so_far_away_on_the_surface_and_none_nearer_to_another_or_its_goal(
    seed: int, way: float, kind: type[Task]
) -> None:
    surface = place_surface(Surface(), kind)
    task = kind.draw(seed, surface)
    moved = vary(task, Variation(start=way), surface)
    new, old = (np.array([t.position for t in x.objects]) for x in (moved, task))
    assert np.allclose(np.linalg.norm(new - old, axis=1), way)
    assert np.allclose(new[:, 2], old[:, 2])
    on = surface.to_surface(new)
    assert np.all(on >= 0) and np.all(on <= surface.size)
    for i in range(len(new)):
        for j in range(i):
            assert np.linalg.norm(new[i] - new[j]) >= np.linalg.norm(old[i] - old[j])
    if not task.goals[0].on:
        goal = task.goals[0].position
        assert np.linalg.norm(new[0] - goal) >= np.linalg.norm(old[0] - goal)
    assert moved.goals == task.goals
    assert vary(task, Variation(start=way), surface) == moved


class OneSize(Wrench):
    """A thing that nobody has said how to scale."""

    scaled = None


def test_an_object_with_a_fixed_size_is_refused() -> None:
    task = WrenchSlide.draw(0, FLAT)
    task = replace(task, objects=(OneSize(**vars(task.objects[0])),))
    with pytest.raises(InputError, match="one size only"):
        vary(task, Variation(size=0.9), FLAT)
    assert vary(task, Variation(mass=2.0), FLAT).objects[0].mass == 2.0 * task.objects[0].mass


def test_a_task_without_room_is_refused_a_variation_of_it() -> None:
    with pytest.raises(InputError, match="has no room that can be varied"):
        vary(BoxToGoal.draw(1, FLAT), Variation(room=1.1), FLAT)


@pytest.mark.parametrize("values", [[], "size", {"speed": 1.0}, {"size": 99.0}])
def test_a_recording_with_a_variation_that_is_none_is_refused(values: Any) -> None:
    with pytest.raises(InputError):
        decoded({**encoded(Settings()), "variation": values})


def test_friction_times_k_is_every_sliding_friction_times_k_and_no_other() -> None:
    def model(text: str) -> mujoco.MjModel:
        chosen = trial_settings(TrialOptions(vary=text))
        return build(chosen, device_makers(chosen)).scene.model

    plain, slippery = model(""), model("friction=0.25")
    assert np.array_equal(slippery.geom_friction[:, 0], 0.25 * plain.geom_friction[:, 0])
    assert np.array_equal(slippery.geom_friction[:, 1:], plain.geom_friction[:, 1:])
    assert np.array_equal(slippery.body_mass, plain.body_mass)


@given(st.integers(0, 30), seeds)
def test_latency_gives_the_same_touches_so_many_steps_later(steps: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    frames = [
        TouchFrame(
            i * STEP, tuple(Contact(j, *rng.uniform(0, 0.1, 2)) for j in range(i % 4)), i % 3 / 2
        )
        for i in range(20)
    ]
    out = played(Variation(latency=steps * STEP), frames, more=steps)
    assert out[:steps] == [None] * steps
    for sent, arrived in zip(frames, out[steps:], strict=True):
        assert arrived.contacts == sent.contacts and arrived.lift == sent.lift


def test_noise_has_the_deviation_asked_for_about_the_true_place_and_keeps_everything_else() -> None:
    contact = Contact(7, 0.05, 0.06, size=0.01, label=2)
    out = played(Variation(noise=2e-3), frames_of(3000, contact))
    xy = np.array([[f.contacts[0].x, f.contacts[0].y] for f in out])
    assert np.allclose(xy.mean(axis=0), [0.05, 0.06], atol=2e-4)
    assert np.allclose(xy.std(axis=0), 2e-3, rtol=0.06)
    assert abs(np.corrcoef(xy[1:, 0], xy[:-1, 0])[0, 1]) < 0.06
    assert {(c.id, c.size, c.label) for f in out for c in f.contacts} == {(7, 0.01, 2)}


@given(st.lists(st.integers(0, 2**31 - 1), max_size=5, unique=True), seeds, st.floats(1.0, 20.0))
@settings(max_examples=40)
def test_ghosts_share_no_id_and_real_touches_stay_as_they_are(
    ids: list[int], seed: int, rate: float
) -> None:
    contacts = tuple(Contact(i, 0.01 * n, 0.02) for n, i in enumerate(ids))
    seen = set()
    # Frames refuse two contacts of one id by themselves.
    for frame in played(Variation(ghosts=rate), frames_of(100, *contacts), seed):
        assert frame.contacts[: len(contacts)] == contacts
        for ghost in frame.contacts[len(contacts) :]:
            assert ghost.id >= FIRST_GHOST and ghost.id not in ids
            assert 0 <= ghost.x <= FLAT.size[0] and 0 <= ghost.y <= FLAT.size[1]
            seen.add((ghost.id, ghost.x, ghost.y))
    assert len({i for i, _, _ in seen}) == len(seen)


def test_ghosts_and_drop_outs_keep_their_time_while_the_device_is_silent() -> None:
    touching = [TouchFrame(5.0, (Contact(3, 0.05, 0.05),)), TouchFrame(20.0)]
    device = DegradedDevice(Played(touching), Variation(ghosts=4.0, dropped=1.0), FLAT, 0)
    out = [frame for i in range(int(25.0 / STEP)) for frame in device.poll(i * STEP)]
    stays: dict[int, list[float]] = {}
    for frame in out:
        for contact in frame.contacts:
            stays.setdefault(contact.id, []).append(frame.time)
    ghosts = [times for i, times in stays.items() if i >= FIRST_GHOST]
    assert len(ghosts) / 25.0 == pytest.approx(4.0, rel=0.3)
    assert max(times[-1] - times[0] for times in ghosts) < GHOST_LENGTH
    real = [f for f in out if 5.0 <= f.time < 20.0]
    gone = [all(c.id >= FIRST_GHOST for c in f.contacts) for f in real]
    losses = sum(b and not a for a, b in pairwise(gone))
    assert losses == pytest.approx(15.0, rel=0.6)
    assert sum(gone) == pytest.approx(losses * LENGTH / STEP, rel=0.3)
    assert not [c for f in out if f.time > 20.2 for c in f.contacts if c.id < FIRST_GHOST]


def test_dropped_touches_never_share_an_id() -> None:
    touches = Contact(3, 0.05, 0.05), Contact(4, 0.09, 0.05)
    out = played(Variation(dropped=1.0), frames_of(1000, *touches))
    ids = [{c.id for f in out for c in f.contacts if c.x == touch.x} for touch in touches]
    assert min(map(len, ids)) > 5 and not ids[0] & ids[1]


def test_a_dropped_touch_comes_back_under_another_id_at_its_place() -> None:
    out = played(Variation(dropped=1.0), frames_of(2000, Contact(3, 0.05, 0.05)))
    gone = [not f.contacts for f in out]
    ids = list(dict.fromkeys(c.id for f in out for c in f.contacts))
    losses = sum(b and not a for a, b in pairwise(gone))
    assert losses == pytest.approx(2000 * STEP * 1.0, rel=0.5) and len(ids) in (losses, losses + 1)
    assert sum(gone) == pytest.approx(losses * LENGTH / STEP, rel=0.2)
    assert {(c.x, c.y) for f in out for c in f.contacts} == {(0.05, 0.05)}


def test_a_touch_that_came_back_is_cancelled_under_the_id_it_came_back_with() -> None:
    frames = frames_of(2000, Contact(3, 0.05, 0.05))
    frames.append(TouchFrame(2000 * STEP, cancelled=frozenset({3})))
    out = played(Variation(dropped=1.0), frames)
    last = [c.id for f in out for c in f.contacts][-1]
    assert last != 3 and out[-1].cancelled == {last}


def test_degraded_touches_follow_from_the_seed() -> None:
    bad = Variation(noise=1e-3, dropped=1.0, ghosts=3.0, latency=0.05)
    frames = frames_of(300, Contact(1, 0.05, 0.05), Contact(2, 0.08, 0.05))
    assert played(bad, frames, 4) == played(bad, frames, 4) != played(bad, frames, 5)
    assert played(Variation(), frames) == [replace(f, time=f.time) for f in frames]


@given(st.text(max_size=30))
def test_invalid_texts_are_never_parsed_as_a_variation(text: str) -> None:
    try:
        variation, hand = parse_variation(text)
    except InputError:
        return
    assert hand > 0 and all(low <= getattr(variation, n) <= up for n, (low, up) in RANGES.items())


@pytest.mark.parametrize("text", ["size", "size=nan", "size=1,size=2", "latency=-1", "speed=2"])
def test_an_invalid_variation_gives_one_clear_error(text: str) -> None:
    with pytest.raises(InputError, match="--vary"):
        parse_variation(text)


DESIGN = """
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
    text = DESIGN.replace("[]", '["stack", "box-to-goal"]').format(vary="size=1.3")
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
