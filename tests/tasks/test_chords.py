"""Chords count when their keys are down by their own fingers, and by names alone they can fail."""

from __future__ import annotations

from typing import Literal

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.arithmetic import Array
from models.errors import InputError
from models.hand import Hand
from models.scene import Scene, SceneSpec
from models.single_pose import SinglePose
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.trial.driver import play_trial
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks import chords
from tasks.chords import (
    DIP,
    HEAVIEST,
    KEYS,
    LIGHTEST,
    PITCH,
    TOP,
    Chords,
    key_name,
)
from tasks.guarded import draw_task
from tasks.sensing import Sensing
from tasks.task import Measure, place_surface
from tasks.variation import Variation, vary
from tests.support.simulation import run

SURFACE = place_surface(Surface(), Chords)
seeds = st.integers(0, 2**63 - 1)


class Trial:
    """A trial in its real scene, whose keys a test moves, without a hand near them."""

    def __init__(self, seed: int = 6_000) -> None:
        self.task = draw_task(Chords, seed, SURFACE)
        self.scene = Scene(SceneSpec((Hand(),), self.task.objects, self.task.table_friction))
        self.data = mujoco.MjData(self.scene.model)
        self.data.qpos[self.scene.qpos_slice(0)][2] = 0.4
        self.sensing = Sensing(self.scene, self.data)
        self.asked = {goal.object for goal in self.task.goals if goal.shown}

    def measure(self, down: dict[str, float]) -> Measure:
        """What the task says with some keys so far down, m, and all others up."""
        for key in range(KEYS):
            self.data.joint(key_name(key)).qpos[:] = down.get(key_name(key), 0.0)
        mujoco.mj_forward(self.scene.model, self.data)
        return self.task.measure(self.sensing)


@settings(max_examples=30, deadline=None)
@given(seed=seeds)
def test_a_trial_has_a_pair_or_a_triple_on_a_row_that_fits(seed: int) -> None:
    task = draw_task(Chords, seed, SURFACE)
    assert 2 <= sum(goal.shown for goal in task.goals) <= 3
    assert len(task.goals) == KEYS
    keys = task.objects[1:]
    places = SURFACE.to_surface(np.array([key.position for key in keys]))
    assert len(keys) == KEYS
    apart = np.linalg.norm(np.diff(places, axis=0), axis=1) / PITCH
    assert np.all(apart >= chords.SIZE[0] - 1e-6) and np.all(apart <= chords.SIZE[1] + 1e-6)
    assert np.all(places > 0.01) and np.all(places < SURFACE.size - 0.01)
    assert task == draw_task(Chords, seed, SURFACE)


def test_keys_that_no_finger_presses_are_not_a_chord() -> None:
    trial = Trial()
    assert trial.measure({}).progress == 0.0
    assert "not down yet" in trial.measure({}).reason
    pressed = dict.fromkeys(trial.asked, 0.008)
    # Held down by nobody.
    assert not trial.measure(pressed).reached
    assert trial.measure(pressed).progress == 0.0


def test_a_key_sinks_under_a_piano_s_weight_and_stays_up_under_less() -> None:
    for force, share in ((0.9 * LIGHTEST, (0.0, 0.02)), (1.1 * HEAVIEST, (0.98, 1.02))):
        trial = Trial()
        scene, data = Scene(SceneSpec((), trial.task.objects)), None
        data = mujoco.MjData(scene.model)
        body = scene.object_bodies[key_name(2)]
        data.xfrc_applied[body, 2] = -force
        run(scene, data, 1.0)
        at = Sensing(scene, data).joint(key_name(2))
        assert share[0] - 0.01 <= at.share <= share[1] and abs(at.speed) < 1e-3
    assert DIP == 0.010


def pressing(finger: int, key: int) -> tuple[Trial, Measure]:
    """A trial after one solid fingertip was put down on a key from above."""
    trial = Trial()
    scene, data = trial.scene, trial.data
    tips = SinglePose(ADULT)
    q = np.zeros(48)
    q[:3] = (0.0, 0.0, 0.1)
    key_at = np.array(trial.task.objects[1 + key].position)
    aim: Array = np.array([key_at[0], key_at[1], Chords.touch_height + 0.006])
    q[:3] += aim - tips.tips(q)[finger]
    scene.set_solid(0, frozenset({finger}))
    for height in np.linspace(0.05, 0.0, 30):
        raised = q.copy()
        raised[2] += height
        data.ctrl[scene.control_slice(0)] = raised
        if height == 0.05:
            data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, raised)
        run(scene, data, 0.016)
    run(scene, data, 0.3)
    return trial, trial.task.measure(trial.sensing)


@pytest.mark.parametrize(("finger", "key"), [(1, 1), (3, 3), (2, 1)])
def test_a_finger_that_is_put_down_presses_its_key_and_is_known(finger: int, key: int) -> None:
    trial, _ = pressing(finger, key)
    assert trial.sensing.joint(key_name(key)).share > chords.POINT
    assert trial.sensing.fingers(key_name(key)) == {("right", finger)}


def test_another_finger_s_press_does_not_count() -> None:
    trial, measured = pressing(2, 1)
    assert key_name(1) in trial.asked
    assert not measured.reached and measured.progress == 0.0
    assert pressing(1, 1)[1].progress == pytest.approx(1 / len(trial.asked))


def played(
    seed: int, solid: Literal["fingertips", "hand"] = "fingertips", **options: object
) -> bool:
    chosen = trial_settings(TrialOptions(task="chords", seed=seed, solid=solid, **options))  # type: ignore[arg-type]
    return play_trial(chosen).success


@pytest.mark.parametrize("solid", ["fingertips", "hand"])
def test_the_simulated_user_presses_a_chord_whatever_is_solid(
    solid: Literal["fingertips", "hand"],
) -> None:
    assert played(6_002, solid)


def test_a_left_hand_plays_as_well() -> None:
    assert played(6_003, hand="left")


def test_with_the_paper_s_names_the_same_user_fails_where_true_names_succeed() -> None:
    assert played(6_011, labels="device")
    assert not played(6_011, labels="paper")


def test_keys_can_be_varied_in_size_and_resistance_and_not_moved() -> None:
    task = draw_task(Chords, 3, SURFACE)
    varied = vary(task, Variation(size=0.8, resistance=2.0), SURFACE)
    first, last = (np.array(varied.objects[k].position) for k in (1, KEYS))
    was = np.array(task.objects[1].position) - task.objects[KEYS].position
    np.testing.assert_allclose((first - last)[:2], 0.8 * was[:2], atol=1e-9)
    assert all(key.position[2] == TOP for key in varied.objects)
    assert played(6_002, vary="size=0.85")
    with pytest.raises(InputError, match="start of this object cannot be varied"):
        vary(task, Variation(start=0.02), SURFACE)
