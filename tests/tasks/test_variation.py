"""Varied trials: what is changed is changed by just that much, and nothing else is."""

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
from models.objects import Wrench
from models.scene import CONTROL_PERIOD
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.wrappers.degraded import (
    FIRST_GHOST,
    GHOST_LENGTH,
    LENGTH,
    DegradedDevice,
)
from sandbox.recording.recording import load_recording
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.driver import play_trial
from sandbox.trial.replay import replay
from sandbox.trial.settings import Settings, decoded, encoded, recorded_settings
from sandbox.trial.trial_options import TrialOptions, parse_variation, trial_settings
from tasks.box_to_goal import BoxToGoal
from tasks.stack import Stack, StackThree
from tasks.task import Task, place, place_surface
from tasks.variation import RANGES, Variation, vary
from tasks.wrench import WrenchSlide

FLAT = place_surface(Surface(), BoxToGoal)
STEP = CONTROL_PERIOD
seeds = st.integers(0, 10_000)


class Scripted(Device):
    """A device that gives the frame of every control period from a list, and then none."""

    name = "scripted"

    def __init__(self, frames: list[TouchFrame]) -> None:
        self.frames, self.next = frames, 0

    def poll(self, now: float) -> list[TouchFrame]:
        self.next += 1
        return [self.frames[self.next - 1]] if self.next <= len(self.frames) else []

    @property
    def finished(self) -> bool:
        return self.next >= len(self.frames)

    def close(self) -> None:
        pass


def frames_of(n: int, *contacts: Contact) -> list[TouchFrame]:
    return [TouchFrame(i * STEP, contacts) for i in range(n)]


def played(
    variation: Variation, frames: list[TouchFrame], seed: int = 0, more: int = 0
) -> list[TouchFrame | None]:
    """Frames that come out at every control period; None where there is none."""
    device = DegradedDevice(Scripted(frames), variation, FLAT, seed)
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
def test_objects_start_just_so_far_away_on_the_surface_and_none_nearer_to_another(
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
        TouchFrame(0.0, tuple(Contact(j, *rng.uniform(0, 0.1, 2)) for j in range(i % 4)), i % 3 / 2)
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


class Resting(Scripted):
    """A device that is silent while nothing changes, as most of them are."""

    finished = False

    def poll(self, now: float) -> list[TouchFrame]:
        due = [f for f in self.frames[self.next :] if f.time <= now]
        self.next += len(due)
        return due


def test_ghosts_and_drop_outs_keep_their_time_while_the_device_is_silent() -> None:
    touching = [TouchFrame(5.0, (Contact(3, 0.05, 0.05),)), TouchFrame(20.0)]
    device = DegradedDevice(Resting(touching), Variation(ghosts=4.0, dropped=1.0), FLAT, 0)
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


def test_a_varied_run_replays_to_the_bit_and_is_marked_in_recording_and_result(
    tmp_path: Path,
) -> None:
    text = "size=0.9,mass=2,friction=0.8,start=10,noise=0.5,dropped=1,ghosts=1,latency=30"
    chosen = trial_settings(TrialOptions(seed=6, vary=text + ",hand-size=1.05"))
    path = tmp_path / "varied.jsonl"
    result = play_trial(chosen, record=path)
    recording = load_recording(path)
    session, found = replay(recording)
    assert found.exact and found.complete and session.state_hash == result.state_hash
    box: Any = session.task.objects[0]
    assert box.half_size[0] == pytest.approx(0.9 * 0.025)
    again = recorded_settings(recording.header)
    assert again == chosen and again.hands[0].size == 1.05
    assert result.settings is not None
    assert again.variation.as_json() == result.settings["variation"]


@given(st.text(max_size=30))
def test_invalid_texts_are_never_parsed_as_a_variation(text: str) -> None:
    try:
        variation, hand = parse_variation(text)
    except InputError:
        return
    assert hand > 0 and all(low <= getattr(variation, n) <= up for n, (low, up) in RANGES.items())


@pytest.mark.parametrize(
    "text",
    [
        "size",
        "size=nan",
        "size=0",
        "size=1,size=2",
        "mass=inf",
        "latency=-1",
        "speed=2",
        "noise=99",
    ],
)
def test_an_invalid_variation_gives_one_clear_error(text: str) -> None:
    with pytest.raises(InputError, match="--vary"):
        parse_variation(text)


@pytest.mark.parametrize("values", [[], "size", {"speed": 1.0}, {"size": 99.0}])
def test_a_recording_with_another_variation_is_refused(values: Any) -> None:
    with pytest.raises(InputError):
        decoded({**encoded(Settings()), "variation": values})
