"""A single key counts once five fingers have rested, and by its own finger alone."""

from __future__ import annotations

from typing import Literal

import mujoco
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.hand import Hand
from models.scene import Scene, SceneSpec
from models.surface import Surface
from sandbox.trial.driver import play_trial
from sandbox.trial.result import TrialResult
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.chords import KEYS, key_name
from tasks.guarded import draw_task
from tasks.sensing import Sensing
from tasks.single_keys import SingleKeys
from tasks.task import place_surface

SURFACE = place_surface(Surface(), SingleKeys)
seeds = st.integers(0, 2**63 - 1)


def played(
    seed: int, solid: Literal["fingertips", "hand"] = "hand", **options: object
) -> TrialResult:
    chosen = trial_settings(TrialOptions(task="single-keys", seed=seed, solid=solid, **options))  # type: ignore[arg-type]
    return play_trial(chosen)


@settings(max_examples=20, deadline=None)
@given(seed=seeds)
def test_a_trial_asks_for_one_of_five_keys(seed: int) -> None:
    task = draw_task(SingleKeys, seed, SURFACE)
    assert sum(goal.shown for goal in task.goals) == 1
    assert len(task.goals) == KEYS and task == draw_task(SingleKeys, seed, SURFACE)


def test_five_keys_that_are_down_are_a_rest_and_four_are_none() -> None:
    task = draw_task(SingleKeys, 3, SURFACE)
    scene = Scene(SceneSpec((Hand(),), task.objects, task.table_friction))
    data = mujoco.MjData(scene.model)
    data.qpos[scene.qpos_slice(0)][2] = 0.4
    sensing = Sensing(scene, data)
    for key in range(KEYS):
        first = task.measure(sensing).first
        assert first is not None and not first.reached
        assert ("little" if key < 4 else "not down yet, the key of: little") in first.reason
        data.joint(key_name(key)).qpos[:] = 0.008
        mujoco.mj_forward(scene.model, data)
    first = task.measure(sensing).first
    assert first is not None and first.reached


@pytest.mark.parametrize("solid", ["fingertips", "hand"])
def test_the_simulated_user_rests_five_fingers_and_presses_the_key(
    solid: Literal["fingertips", "hand"],
) -> None:
    assert played(6_001, solid).success
