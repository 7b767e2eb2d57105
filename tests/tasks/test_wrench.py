"""Wrenches: every trial is in reach, the bolt is a bolt, and nothing counts that is not done."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from models.arithmetic import Array
from models.hand import Hand
from models.objects import HANDLE, JAW, THICKNESS, Wrench, bolt_place
from models.rotations import exp, matrix_to_quaternion
from models.scene import Scene, SceneSpec
from models.surface import PRESETS, Surface
from tasks.task import Measure
from tasks.variation import Variation, vary
from tasks.wrench import (
    BOLT_TURN,
    DISTANCE,
    FRICTION,
    GRIP,
    GRIP_BORDER,
    MASS,
    SLIDE_TURN,
    WrenchSlide,
    WrenchTask,
    WrenchTurn,
    wrapped,
)
from tests.support.simulation import run
from tests.support.task_scene import TaskScene

seeds = st.integers(0, 2**63 - 1)
tablets = st.sampled_from([Surface(*PRESETS[n]) for n in ("ipad2", "ipad-11", "ipad-13")])
"""A smaller one has no room for the way of a handle."""
both = pytest.mark.parametrize("kind", [WrenchTurn, WrenchSlide])
TABLET = Surface().centred_at((0.0, 0.0, WrenchTurn.touch_height))


def turned(degrees: float, axis: int = 2) -> np.ndarray:
    return exp(np.deg2rad(degrees) * np.eye(3)[axis])


class Trial(TaskScene[WrenchTask]):
    """A trial in its real scene, with the wrench put where a test wants it."""

    def __init__(self, kind: type[WrenchTask], seed: int = 4, size: float = 1.0) -> None:
        task = vary(kind.draw(seed, TABLET), Variation(size=size), TABLET)
        assert isinstance(task, WrenchTask)
        super().__init__(task)
        mujoco.mj_forward(self.scene.model, self.data)
        self.goal = self.task.goals[0]
        self.joint = self.data.joint("wrench")

    def place(
        self,
        shift: Sequence[float] | Array = (0.0, 0.0, 0.0),
        turn: float = 0.0,
        rotation: Array | None = None,
    ) -> None:
        """The wrench at rest at its goal, but for a shift (m), a turn (degrees) and a rotation."""
        self.joint.qvel[:] = 0.0
        yaw = self.goal.yaw + np.deg2rad(turn)
        if isinstance(self.task, WrenchTurn):
            self.joint.qpos[:] = yaw - self.task.objects[0].yaw
            return
        matrix = turned(np.rad2deg(yaw))
        self.joint.qpos[:3] = np.asarray(self.goal.position) + np.asarray(shift)
        self.joint.qpos[3:] = matrix_to_quaternion(
            matrix if rotation is None else matrix @ rotation
        )


@settings(max_examples=40)
@given(seed=seeds, surface=tablets)
def test_a_wrench_to_turn_is_within_its_ranges_and_its_handle_within_reach(
    seed: int, surface: Surface
) -> None:
    task = WrenchTurn.draw(seed, surface)
    (wrench,), (goal,) = task.objects, task.goals
    low, high = BOLT_TURN
    assert low - 1e-9 <= abs(goal.yaw - wrench.yaw) <= high + 1e-9
    assert MASS[0] <= wrench.mass <= MASS[1]
    assert FRICTION[0] <= wrench.bolt <= FRICTION[1]
    bolt = np.array(bolt_place(wrench.position[:2], wrench.yaw))
    np.testing.assert_allclose(bolt_place(goal.position[:2], goal.yaw), bolt, atol=1e-12)
    for share in np.linspace(0.0, 1.0, 50):
        yaw = wrench.yaw + share * (goal.yaw - wrench.yaw)
        along = np.array([np.cos(yaw), np.sin(yaw)])
        for place, border in (
            (GRIP, GRIP_BORDER),
            (JAW, WrenchTurn.border),
        ):
            xy = surface.to_surface(np.append(bolt + (place - JAW) * along, 0.0))
            # Between two of the looked-at places of an arc there is a sagitta of 0.1 mm.
            assert np.all(xy > border - 2e-4)
            assert np.all(xy < surface.size - border + 2e-4)


@settings(max_examples=40)
@given(seed=seeds, surface=tablets)
def test_a_wrench_to_slide_is_within_its_ranges_and_on_the_surface(
    seed: int, surface: Surface
) -> None:
    task = WrenchSlide.draw(seed, surface)
    (wrench,), (goal,) = task.objects, task.goals
    assert wrench.bolt is None
    low, high = SLIDE_TURN
    assert low - 1e-9 <= abs(goal.yaw - wrench.yaw) <= high + 1e-9
    way = np.linalg.norm(np.subtract(goal.position, wrench.position))
    assert DISTANCE[0] - 1e-9 <= way <= DISTANCE[1] + 1e-9
    assert MASS[0] <= wrench.mass <= MASS[1]
    for place, yaw in ((wrench.position, wrench.yaw), (goal.position, goal.yaw)):
        assert place[2] == THICKNESS / 2
        middle = surface.to_surface(place)
        assert np.all(middle >= WrenchSlide.border - 1e-9)
        assert np.all(middle <= surface.size - WrenchSlide.border + 1e-9)
        for along in (JAW, *HANDLE):
            end = np.array(place) + along * np.array([np.cos(yaw), np.sin(yaw), 0.0])
            assert np.all(surface.to_surface(end) > 0.0)
            assert np.all(surface.to_surface(end) < surface.size)


@both
@settings(max_examples=40)
@given(seed=seeds, x=st.floats(-1, 1), y=st.floats(-1, 1))
def test_the_same_seed_is_the_same_trial_wherever_the_surface_is(
    kind: type[WrenchTask], seed: int, x: float, y: float
) -> None:
    here, there = kind.draw(seed, Surface()), kind.draw(seed, Surface(origin=(x, y, 0.01)))
    assert kind.draw(seed, Surface()) == here
    assert there.objects[0].yaw == here.objects[0].yaw
    shift = np.array([x, y, 0.0])
    for a, b in ((here.objects[0], there.objects[0]), (here.goals[0], there.goals[0])):
        np.testing.assert_allclose(np.add(a.position, shift), b.position, atol=1e-12)


@both
def test_a_wrench_at_its_goal_is_there_and_one_turned_round_is_not(kind: type[WrenchTask]) -> None:
    trial = Trial(kind)
    trial.place(shift=(0.0, 0.0, -1e-5))
    assert trial.measure() == Measure(True, 1.0, "")
    trial.place(turn=180.0, shift=(0.0, 0.0, -1e-5))
    assert "180 degrees" in trial.measure().reason


@pytest.mark.parametrize(("kind", "limit"), [(WrenchTurn, 5.0), (WrenchSlide, 8.0)])
@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_a_turn_counts_up_to_its_tolerance(
    kind: type[WrenchTask], limit: float, way: float
) -> None:
    trial = Trial(kind)
    trial.place(turn=way * (limit - 0.05), shift=(0.0, 0.0, -1e-5))
    assert trial.measure().reached
    trial.place(turn=way * (limit + 0.05), shift=(0.0, 0.0, -1e-5))
    assert not trial.measure().reached


@pytest.mark.parametrize("angle", np.linspace(0.0, 2 * np.pi, 7))
def test_a_slide_counts_up_to_its_tolerance(angle: float) -> None:
    trial = Trial(WrenchSlide)
    way = np.array([np.cos(angle), np.sin(angle), 0.0])
    trial.place(shift=0.0099 * way - [0, 0, 1e-5])
    assert trial.measure().reached
    trial.place(shift=0.0101 * way - [0, 0, 1e-5])
    assert "10 mm from the goal" in trial.measure().reason


def test_a_wrench_that_is_tilted_or_hangs_in_the_air_is_not_there() -> None:
    trial = Trial(WrenchSlide)
    trial.place(rotation=turned(6.0, axis=0))
    assert "tilted" in trial.measure().reason
    trial.place(shift=(0.0, 0.0, 0.003))
    assert trial.measure().reason == "the wrench does not lie on the table"


@both
def test_a_moving_wrench_is_not_there(kind: type[WrenchTask]) -> None:
    trial = Trial(kind)
    trial.place(shift=(0.0, 0.0, -1e-5))
    trial.joint.qvel[0] = 0.009 / (-JAW if kind is WrenchTurn else 1.0)
    assert trial.measure().reached
    trial.joint.qvel[0] *= 0.011 / 0.009
    assert not trial.measure().reached


@both
def test_progress_grows_from_start_to_goal_and_is_whole_only_there(kind: type[WrenchTask]) -> None:
    trial = Trial(kind)
    began = trial.task.objects[0]
    shift = np.subtract(began.position, trial.goal.position)
    turn = np.rad2deg(began.yaw - trial.goal.yaw)
    said = []
    for left in np.linspace(1.0, 0.0, 41):
        trial.place(left * shift - [0, 0, 1e-5], left * turn)
        measure = trial.measure()
        said.append(measure.progress)
        assert (measure.progress == 1.0) == measure.reached
    assert said[0] < 0.01
    assert said[-1] == 1.0
    assert np.all(np.diff(said) >= 0)


@pytest.mark.parametrize("way", [-1.0, 1.0])
def test_a_bolt_yields_to_more_than_its_friction_and_then_holds_again(way: float) -> None:
    trial = Trial(WrenchTurn)
    wrench: Any = trial.task.objects[0]
    trial.joint.qfrc_applied[0] = 0.9 * way * wrench.bolt
    run(trial.scene, trial.data, 0.3)
    # The solver's friction is a little soft.
    assert abs(trial.joint.qpos[0]) < 1e-3
    trial.joint.qfrc_applied[0] = 1.3 * way * wrench.bolt
    run(trial.scene, trial.data, 0.2)
    assert way * trial.joint.qpos[0] > 0.1
    trial.joint.qfrc_applied[0] = 0.0
    run(trial.scene, trial.data, 0.3)
    stopped = float(trial.joint.qpos[0])
    run(trial.scene, trial.data, 0.5)
    assert abs(trial.joint.qpos[0] - stopped) < 1e-5
    # The jaws are where they were: it turned about the bolt and about nothing else.
    now = trial.sensing.object("wrench")
    bolt = bolt_place(wrench.position[:2], wrench.yaw)
    np.testing.assert_allclose(bolt_place(now.position[:2], now.yaw), bolt, atol=1e-9)


@pytest.mark.parametrize("speed", [-3.0, 0.4])
def test_the_speed_of_a_wrench_on_a_bolt_is_that_of_its_middle(speed: float) -> None:
    trial = Trial(WrenchTurn)
    trial.joint.qvel[0] = speed
    mujoco.mj_forward(trial.scene.model, trial.data)
    before = trial.sensing.object("wrench")
    trial.joint.qpos[0] += speed * 1e-6
    mujoco.mj_forward(trial.scene.model, trial.data)
    moved = np.linalg.norm(trial.sensing.object("wrench").position - before.position)
    assert before.speed == pytest.approx(moved / 1e-6, rel=1e-5)


@settings(max_examples=30)
@given(
    shares=hnp.arrays(float, (40, 3), elements=st.floats(-1.0, 1.0)),
    yaw=st.floats(-3, 3),
    size=st.sampled_from([1.0, 0.4, 2.5]),
)
def test_clearance_is_the_distance_to_the_nearest_solid_part_of_the_model(
    shares: Array, yaw: float, size: float
) -> None:
    wrench = Wrench("wrench", 0.1, (0.02, -0.03, 0.02), yaw, size=size)
    scene = Scene(SceneSpec((Hand(),), (wrench,)))
    data = mujoco.MjData(scene.model)
    mujoco.mj_forward(scene.model, data)
    position, rotation = scene.object_pose(data, "wrench")
    points = position + size * (shares * [0.09, 0.04, 0.03]) @ rotation.T
    nearest = np.full(len(points), np.inf)
    for g in np.flatnonzero(scene.model.geom_bodyid == scene.model.body("wrench").id):
        own = (points - data.geom_xpos[g]) @ data.geom_xmat[g].reshape(3, 3)
        half = scene.model.geom_size[g]
        outside = np.linalg.norm(own - np.clip(own, -half, half), axis=1)
        depth = np.min(half - np.abs(own), axis=1)
        nearest = np.minimum(nearest, np.where(depth > 0, -depth, outside))
    np.testing.assert_allclose(wrench.clearance(points, position, rotation), nearest, atol=1e-12)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("past", [-40.0, -6.0, 0.0, 4.0, 14.0, 16.0, 100.0])
def test_a_nut_turned_far_past_its_goal_is_spoiled(seed: int, past: float) -> None:
    trial = Trial(WrenchTurn, seed)
    way = np.sign(wrapped(trial.goal.yaw - trial.task.objects[0].yaw))
    trial.place(turn=way * past)
    measure = trial.measure()
    assert measure.lost == (past > 15.0)
    assert measure.reached == (abs(past) <= 5.0)
