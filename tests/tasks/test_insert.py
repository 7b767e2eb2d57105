"""Insert: every trial is a fair one, the clearance is what it says, and a person with eyes can do
it."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.rotations import exp, matrix_to_quaternion
from models.scene import Scene, SceneSpec
from models.surface import PRESETS, Surface
from tasks.insert import (
    BEFORE,
    BORDER,
    CLEARANCE,
    DEPTH,
    HELD,
    LENGTH,
    SKEW,
    WIDTH,
    Insert,
    peg,
    socket,
)
from tasks.variation import Variation, vary
from tests.support.simulation import run
from tests.support.task_scene import TaskScene

seeds = st.integers(0, 2**63 - 1)
TABLET = Surface().centred_at((0.0, 0.0, Insert.touch_height))


class Trial(TaskScene[Insert]):
    """A trial in its real scene, with the peg put where a test wants it."""

    def __init__(self, seed: int = 3) -> None:
        super().__init__(Insert.draw(seed, TABLET))

    def put(self, out: float = 0.0, yaw: float = 0.0, up: float = 0.0) -> None:
        """Puts the peg into its socket, m out of it and above it, and turned by rad."""
        goal = self.task.goals[0]
        along = np.array([np.cos(goal.yaw), np.sin(goal.yaw), 0.0])
        lying = self.data.joint("peg")
        lying.qpos[:3] = np.array(goal.position) - out * along + [0.0, 0.0, up]
        lying.qpos[3:] = matrix_to_quaternion(exp((goal.yaw + yaw) * np.array([0.0, 0.0, 1.0])))


def pushed(clearance: float, force: float = 0.3, aside: float = 0.0) -> float:
    """Depth in m to which a force, N, pushes a peg that lies before a socket."""
    lying = peg((-DEPTH - 0.005, aside), 0.0)
    scene = Scene(
        SceneSpec((), (lying, *socket((0.0, 0.0), 0.0, clearance).parts), own_friction=True)
    )
    data = mujoco.MjData(scene.model)
    body = scene.object_bodies["peg"]
    data.xfrc_applied[body, 0] = force
    run(scene, data, 2.0)
    return float(data.xpos[body, 0]) + DEPTH


@given(seed=seeds, surface=st.sampled_from([Surface(*s) for s in PRESETS.values() if s[1] > 5]))
def test_every_trial_has_a_peg_before_the_mouth_and_room_for_the_hand(
    seed: int, surface: Surface
) -> None:
    task = Insert.draw(seed, surface)
    lying, goal = task.objects[0], task.goals[0]
    along = np.array([np.cos(goal.yaw), np.sin(goal.yaw)])
    off = np.array(lying.position[:2]) - np.array(goal.position[:2])
    before = -float(off @ along) - DEPTH
    assert BEFORE[0] - 1e-9 <= before <= BEFORE[1] + 1e-9
    assert abs(lying.yaw - goal.yaw) <= SKEW + 1e-9
    turned = np.array([np.cos(lying.yaw), np.sin(lying.yaw)])
    held = [
        np.array(lying.position[:2]) - HELD * turned,
        np.array(goal.position[:2]) - HELD * along,
    ]
    on = surface.to_surface(np.column_stack([held, np.zeros(2)]))
    assert np.all(on >= BORDER - 1e-9) and np.all(on <= surface.size - BORDER + 1e-9)


def test_a_peg_looks_the_same_after_half_a_turn() -> None:
    trial = Trial()
    trial.put(yaw=np.pi)
    run(trial.scene, trial.data, 0.3)
    assert trial.measure().reached


def test_a_peg_that_is_not_all_in_or_lies_on_the_walls_is_not_there() -> None:
    trial = Trial()
    trial.put(out=0.004)
    assert trial.measure().reason == "the peg is 4 mm from the bottom of its socket"
    trial.put(up=0.015)
    assert trial.measure().reason == "the peg does not lie in its socket"


@pytest.mark.parametrize("clearance", [0.004, 0.002, 0.001, 0.0005, 0.0002])
def test_a_peg_goes_into_a_socket_that_is_wider_and_no_farther_than_its_bottom(
    clearance: float,
) -> None:
    assert pushed(clearance) == pytest.approx(DEPTH, abs=0.0005)


def test_a_peg_does_not_go_into_a_socket_that_is_narrower() -> None:
    assert pushed(-0.0002) < 0.005
    assert pushed(-0.0004) < 0.005


def test_the_rounded_mouth_leads_in_a_peg_that_is_aside() -> None:
    assert pushed(0.002, aside=0.002) == pytest.approx(DEPTH, abs=0.0005)


@pytest.mark.parametrize("factor", [2.0, 0.5, 0.25])
def test_room_is_the_clearance_and_nothing_else(factor: float) -> None:
    task = Insert.draw(5, TABLET)
    varied = vary(task, Variation(room=factor), TABLET)
    assert isinstance(varied, Insert) and varied.clearance == factor * CLEARANCE
    assert varied.objects[0] == task.objects[0] and varied.goals == task.goals
    middle = [[LENGTH / 2 - DEPTH + 0.0075, 0.0, 0.0075]]
    rooms = [
        float(each.objects[1].clearance(middle, np.zeros(3), np.eye(3))[0])
        for each in (task, varied)
    ]
    assert rooms[1] - rooms[0] == pytest.approx((factor - 1.0) * CLEARANCE / 2)
    assert rooms[0] == pytest.approx((WIDTH + CLEARANCE) / 2)
