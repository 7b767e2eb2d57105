"""Wrenches: trials are in reach, a bolt is a bolt, sizes fit, and a hand grasps and turns them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any
from xml.etree.ElementTree import tostring

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from models.arithmetic import Array
from models.objects import BOLT_LIFT, HANDLE, JAW, THICKNESS, Wrench, bolt_place
from models.rotations import exp, matrix_to_quaternion
from models.scene import Scene, SceneSpec
from models.surface import PRESETS, Surface
from sandbox.devices.simulated.air_person import hold_of, pinch_motion
from tasks.simulated_user.grasp import within_comfort
from tasks.simulated_user.handling import WrenchHandling, handling_of
from tasks.simulated_user.user_hand import Hand
from tasks.task import Goal, Measure
from tasks.user import SeenObject, UserConfiguration
from tasks.variation import RANGES, Variation, vary
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
yaws = st.floats(-np.pi, np.pi)
turns = st.floats(-np.deg2rad(90), np.deg2rad(90))
fingers = st.integers(2, 5)
bolts = st.sampled_from([None, 0.05])
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
    scene = Scene(SceneSpec((), (wrench,)))
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


sizes = st.floats(*RANGES["size"])


def seen(yaw: float, size: float = 1.0, bolt: float | None = None) -> SeenObject:
    wrench = Wrench("wrench", 0.1, (0.01, -0.02, 0.012), yaw, bolt, size=size)
    return SeenObject(wrench, np.array(wrench.position), exp([0.0, 0.0, yaw]))


@given(yaw=yaws, bolt=bolts, x=st.floats(-0.1, 0.1), k=sizes)
def test_scaling_by_1_changes_nothing_and_factors_multiply(
    yaw: float, bolt: float, x: float, k: float
) -> None:
    wrench = Wrench("wrench", 0.1, (x, 0.03, 0.012), yaw, bolt)
    assert wrench.scaled(1.0) == wrench
    assert tostring(wrench.scaled(1.0).body()) == tostring(wrench.body())
    there, back = wrench.scaled(k), wrench.scaled(k).scaled(1.0 / k)
    assert there.size == pytest.approx(k) and back.size == pytest.approx(1.0)
    np.testing.assert_allclose(back.position, wrench.position, atol=1e-12)


@given(seed=seeds, k=st.floats(0.3, 3.0))
@settings(max_examples=40)
def test_a_larger_wrench_sits_on_the_same_bolt_and_weighs_and_rubs_the_same(
    seed: int, k: float
) -> None:
    task = WrenchTurn.draw(seed, TABLET)
    varied = vary(task, Variation(size=k), TABLET)
    was: Any
    now: Any
    (was,), (now,) = task.objects, varied.objects
    bolt = bolt_place(was.position[:2], was.yaw)
    np.testing.assert_allclose(now.bolt_place(now.position[:2], now.yaw), bolt, atol=1e-12)
    (goal,) = varied.goals
    np.testing.assert_allclose(now.bolt_place(goal.position[:2], goal.yaw), bolt, atol=1e-12)
    assert (now.mass, now.yaw, now.bolt) == (was.mass, was.yaw, was.bolt)
    assert goal.yaw == task.goals[0].yaw
    for middle in (now.position, goal.position):
        assert middle[2] - now.thickness / 2 == pytest.approx(BOLT_LIFT)


@given(seed=seeds, k=st.floats(0.3, 3.0))
@settings(max_examples=40)
def test_a_larger_free_wrench_lies_on_the_table_about_the_same_middle(seed: int, k: float) -> None:
    task = WrenchSlide.draw(seed, TABLET)
    varied = vary(task, Variation(size=k), TABLET)
    wrench: Any = varied.objects[0]
    assert wrench.mass == task.objects[0].mass
    places: Any = ((task.objects[0], wrench), (task.goals[0], varied.goals[0]))
    for old, new in places:
        x, y, _ = old.position
        assert new.position == pytest.approx((x, y, wrench.thickness / 2))
        assert new.yaw == old.yaw


@given(seed=seeds, k=st.floats(1.0, 2.5), share=st.floats(0.0, 1.0))
@settings(max_examples=20)
def test_a_longer_handle_is_gripped_where_the_screen_has_room_during_the_whole_turn(
    seed: int, k: float, share: float
) -> None:
    task = vary(WrenchTurn.draw(seed, TABLET), Variation(size=k), TABLET)
    wrench: Any
    (wrench,), (goal,) = task.objects, task.goals
    sight = SeenObject(wrench, np.array(wrench.position), exp([0.0, 0.0, wrench.yaw]))
    hand, turn = Hand.draw(UserConfiguration(), 0), goal.yaw - wrench.yaw
    bolt = np.array(wrench.bolt_place(wrench.position[:2], wrench.yaw))
    far = np.linalg.norm(bolt - wrench.position[:2])
    far += handling_of(wrench).grasp(sight, turn, hand).grip
    assert far <= GRIP - JAW + 1e-12
    yaw = wrench.yaw + share * turn
    on = TABLET.to_surface([*(bolt + far * np.array([np.cos(yaw), np.sin(yaw)])), 0.0])
    # Nearer to the bolt there is as much room as the bolt itself has.
    border = min(GRIP_BORDER, WrenchTurn.border) - 2e-4
    assert np.all(on > border) and np.all(on < TABLET.size - border)


@both
@pytest.mark.parametrize("size", [0.5, 0.7, 1.4, 2.0])
def test_a_wrench_of_any_size_is_at_its_goal_where_its_goal_is_drawn(
    kind: type[WrenchTask], size: float
) -> None:
    trial = Trial(kind, size=size)
    trial.place(shift=(0.0, 0.0, -1e-5))
    assert trial.measure().reached
    now = trial.sensing.object("wrench").position
    np.testing.assert_allclose(now, trial.goal.position, atol=2e-5)


@given(yaw=yaws, turn=st.floats(-1.5, 1.5), n=st.integers(2, 5), bolt=bolts, k=st.floats(0.6, 2.5))
def test_fingers_come_down_beside_the_handle_that_is_there_and_close_on_it(
    yaw: float, turn: float, n: int, bolt: float, k: float
) -> None:
    c = UserConfiguration(fingers=n)
    hand = Hand.draw(c, 0)
    wrench = seen(yaw, k, bolt)
    shape: Any = wrench.shape
    grasp = handling_of(shape).grasp(wrench, turn, hand)
    for gap in (grasp.opening(hand), -c.squeeze):
        places = grasp.places(grasp.middle(wrench), gap, hand)
        local = (places - wrench.position[:2]) @ wrench.rotation[:2, :2]
        assert np.all((local[:, 0] > shape.handle[0]) & (local[:, 0] < shape.handle[1]))
        assert np.all(np.sign(local[1:, 1]) == -np.sign(local[0, 1]))
        outside = np.abs(local[:, 1]) - shape.handle_width / 2
        assert np.all(outside > 0.0155 if gap > 0 else (outside > 0.0) & (outside < 0.0055))


@given(yaw=yaws, k=sizes, bolt=bolts, turn=st.floats(-0.4, 0.4))
def test_a_hand_in_the_air_closes_on_the_handle_that_is_there_and_turns_it_about_its_bolt(
    yaw: float, k: float, bolt: float, turn: float
) -> None:
    wrench = seen(yaw, k, bolt)
    hold = hold_of(wrench, np.zeros(2))
    x, y, z = wrench.rotation.T @ (hold.position - wrench.position)
    shape: Any = wrench.shape
    assert shape.handle[0] < x < shape.handle[1]
    assert y == pytest.approx(0.0, abs=1e-12) and z == pytest.approx(0.0)
    assert hold.width == shape.handle_width
    assert hold.top == pytest.approx(wrench.position[2] + shape.thickness / 2)
    if bolt is None:
        return
    pivot = np.array(shape.bolt_place(wrench.position[:2], yaw))
    middle = pivot - shape.jaw * np.array([np.cos(yaw + turn), np.sin(yaw + turn)])
    goal = Goal("wrench", (middle[0], middle[1], 0.012), yaw + turn)
    step, by = pinch_motion(wrench, goal, hold.position[:2])
    assert by == pytest.approx(turn)
    arms = [np.linalg.norm(p - pivot) for p in (hold.position[:2], hold.position[:2] + step)]
    assert arms[0] == pytest.approx(arms[1])


def wrench_handling(wrench: SeenObject) -> WrenchHandling:
    assert isinstance(wrench.shape, Wrench)
    return WrenchHandling(wrench.shape)


@given(yaw=yaws, turn=turns, n=fingers, bolt=bolts)
def test_every_turn_is_made_in_three_grasps_without_a_wrist_that_is_broken(
    yaw: float, turn: float, n: int, bolt: float
) -> None:
    hand = Hand.draw(UserConfiguration(fingers=n), 0)
    handling = wrench_handling(seen(0.0, bolt=bolt))
    left = turn
    for _ in range(3):
        wrench = seen(yaw, bolt=bolt)
        grasp = handling.grasp(wrench, left, hand)
        made = handling.reach(wrench, grasp, left, hand)
        assert abs(made) <= abs(left) + 1e-12
        assert made * left >= 0.0
        for angle in (yaw, yaw + made):
            off = wrapped(grasp.axis_on(angle) - hand.natural_axis)
            assert abs(off) < np.deg2rad(101), np.rad2deg(off)
        yaw, left = yaw + made, left - made
    assert abs(left) < 1e-9


@given(axis=yaws, turn=turns)
def test_a_wrist_turned_too_far_may_turn_back_but_no_further(axis: float, turn: float) -> None:
    hand = Hand.draw(UserConfiguration(), 0)
    now = wrapped(axis - hand.natural_axis)
    after = now + within_comfort(axis, turn, hand)
    assert abs(after) <= max(abs(now), np.deg2rad(95.0)) + 1e-9
    if turn * now < 0 and abs(turn) < abs(now):
        assert after == pytest.approx(now + turn)


@given(yaw=yaws, turn=st.floats(0.1, 1.5), way=st.sampled_from([-1, 1]), bolt=bolts)
def test_two_fingers_close_so_that_the_handle_begins_to_turn_the_right_way(
    yaw: float, turn: float, way: int, bolt: float
) -> None:
    hand = Hand.draw(UserConfiguration(fingers=2), 0)
    wrench = seen(yaw, bolt=bolt)
    grasp = handling_of(wrench.shape).grasp(wrench, way * turn, hand)
    middle = grasp.middle(wrench)
    thumb, index = grasp.places(middle, 0.0, hand)
    along = np.array([np.cos(grasp.axis), np.sin(grasp.axis)])
    moment = sum(
        float((p - middle)[0] * f[1] - (p - middle)[1] * f[0])
        for p, f in ((thumb, along), (index, -along))
    )
    assert way * moment > 0.01
