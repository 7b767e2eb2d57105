"""Close case: every trial is a fair one, two hands can do it, and one alone cannot."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.surface import Surface
from sandbox.trial.driver import open_trial
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.close_case import BORDER, CAP, CASE, GRIP, HELD, SEAM, TRAVEL, CloseCase
from tasks.task import Measure
from tests.support.simulation import run
from tests.support.task_scene import TaskScene

BOTH = Surface(15.52, 5.82).centred_at((0.0, 0.0, CloseCase.touch_height))


@given(seed=st.integers(0, 2**63 - 1))
def test_every_trial_has_a_half_for_either_hand(seed: int) -> None:
    task, again = CloseCase.draw(seed, BOTH), CloseCase.draw(seed, BOTH)
    assert task.goals == again.goals and task.objects[0].position == again.objects[0].position
    half, cap = task.objects
    along = np.array([np.cos(half.yaw), np.sin(half.yaw)])
    left = np.array(half.position[:2]) - HELD * along
    right = np.array(cap.position[:2]) + HELD * along
    assert left[0] <= -SEAM + 1e-9 and right[0] - TRAVEL * along[0] >= SEAM - 1e-9
    on = BOTH.to_surface(np.column_stack([[left, right], np.zeros(2)]))
    assert np.all(on >= BORDER - 1e-9) and np.all(on <= BOTH.size - BORDER + 1e-9)


def test_a_closed_case_is_there_and_an_open_one_is_not() -> None:
    trial = TaskScene(CloseCase.draw(3, BOTH))
    assert trial.measure() == Measure(False, 0.0, "the case is open by 20 mm")
    trial.data.joint(CAP).qpos[0] = 0.01
    assert trial.measure().reason == "the case is open by 10 mm"
    assert 0.4 < trial.measure().progress < 0.7
    trial.data.joint(CAP).qpos[0] = 0.0
    run(trial.scene, trial.data, 0.3)
    assert trial.measure() == Measure(True, 1.0, "")


@pytest.mark.parametrize("push", [0.3, 1.0, 1.4])
def test_a_push_at_one_half_alone_moves_the_case_and_does_not_close_it(push: float) -> None:
    trial = TaskScene(CloseCase.draw(3, BOTH))
    assert push < GRIP[0] and not trial.measure().reached
    along = trial.scene.object_pose(trial.data, CASE)[1][:, 0]
    before = trial.data.body(CASE).xpos.copy()
    trial.data.body(CAP).xfrc_applied[:3] = -push * along
    run(trial.scene, trial.data, 0.1)
    moved = (before - trial.data.body(CASE).xpos) @ along
    assert moved > 0.01
    assert trial.data.joint(CAP).qpos[0] > 0.019


@pytest.mark.parametrize(
    "alone", [{"second_user": "idle"}, {"user": "idle", "second_user": "skilled"}]
)
def test_one_simulated_user_alone_does_not_in_twice_the_time(alone: dict[str, Any]) -> None:
    two_need = 6.0
    chosen = trial_settings(TrialOptions(task="close-case", seed=6400, **alone))
    with open_trial(chosen) as trial:
        trial.run(stop=lambda: trial.session.time > 2.0 * two_need)
        score = trial.session.scorer.score
        assert not score.instant and score.progress < 0.2
