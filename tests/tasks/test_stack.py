"""Stacking: every trial is a fair one, only a stack is a stack, and hands keep clear of boxes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arithmetic import Array
from models.errors import InputError
from models.objects import Box
from models.rotations import exp, matrix_to_quaternion
from models.scene import TABLE
from models.surface import Surface
from tasks.simulated_user.grasp import Surroundings, roomiest_grasp
from tasks.simulated_user.user import Slider
from tasks.simulated_user.user_hand import Hand
from tasks.stack import OFFSET_TOLERANCE, Stack, StackThree
from tasks.task import Goal, Measure, flat_yaw, place
from tasks.user import SeenObject, UserConfiguration
from tests.support.simulation import run
from tests.support.task_scene import TaskScene

TABLET = Surface().centred_at((0.0, 0.0, Stack.touch_height))
AWAY = np.concatenate([[0.0, 0.0, 0.40], np.zeros(45)])
"""(48,) pose of a hand above three boxes."""


class Trial(TaskScene[Stack]):
    """A trial in its real scene, with boxes put where a test wants them."""

    def __init__(self, kind: type[Stack] = Stack, seed: int = 4, task: Stack | None = None) -> None:
        super().__init__(task or kind.draw(seed, TABLET), AWAY)

    def edge(self, number: int) -> float:
        return 2 * self.task.objects[number].half_size[0]

    def put(
        self, number: int, position: Sequence[float] | Array, rotation: Array | None = None
    ) -> None:
        """A box, at rest, with its middle there."""
        joint = self.data.joint(self.task.objects[number].name)
        joint.qpos[:3] = position
        if rotation is not None:
            joint.qpos[3:] = matrix_to_quaternion(rotation)
        joint.qvel[:] = 0.0

    def stack(
        self,
        number: int,
        on: int,
        off: Sequence[float] | Array = (0.0, 0.0),
        rotation: Array | None = None,
    ) -> None:
        """A box on another one, off its middle by (2,) m."""
        below = self.data.joint(self.task.objects[on].name).qpos[:3]
        height = (self.edge(number) + self.edge(on)) / 2
        self.put(number, below + np.array([*off, height]), rotation)

    def after(self, seconds: float = 0.3) -> Measure:
        run(self.scene, self.data, seconds)
        return self.task.measure(self.sensing)

    def weight(self, number: int) -> float:
        return 9.81 * self.task.objects[number].mass


@pytest.fixture
def trial() -> Trial:
    return Trial()


@pytest.fixture
def three() -> Trial:
    return Trial(StackThree)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("degrees", [0.0, 90.0, 180.0])
def test_a_box_on_the_middle_of_the_other_is_a_stack_on_whichever_face_it_stands(
    trial: Trial, axis: int, degrees: float
) -> None:
    trial.stack(1, 0, rotation=exp(np.deg2rad(degrees) * np.eye(3)[axis]))
    assert trial.after() == Measure(True, 1.0, "")


@pytest.mark.parametrize("direction", [(1, 0), (0, -1), (0.6, 0.8)])
def test_the_offset_counts_in_edges_of_the_smaller_box(
    trial: Trial, direction: tuple[float, float]
) -> None:
    smaller = min(trial.edge(0), trial.edge(1))
    trial.stack(1, 0, off=(OFFSET_TOLERANCE * smaller - 0.001) * np.array(direction))
    assert trial.after().reached
    trial.stack(1, 0, off=(OFFSET_TOLERANCE * smaller + 0.001) * np.array(direction))
    measure = trial.after()
    assert not measure.reached and "off the middle of the base box" in measure.reason


def test_boxes_side_by_side_that_push_each_other_are_not_stacked(trial: Trial) -> None:
    base = np.array(trial.task.objects[0].position)
    trial.put(0, base, np.eye(3))
    beside = (trial.edge(0) + trial.edge(1)) / 2
    trial.put(1, [base[0] + beside, base[1], trial.edge(1) / 2], np.eye(3))
    trial.data.body("second").xfrc_applied[0] = -0.7 * trial.weight(1)
    measure = trial.after()
    assert trial.sensing.force("base", "second")[0] < -0.1 * trial.weight(1)
    assert not trial.sensing.rests_on("second", "base")
    assert not trial.sensing.rests_on("base", "second")
    assert not measure.reached
    with pytest.raises(InputError, match=r"no object of this name \(got 'table'"):
        trial.sensing.rests_on("table", "base")


def test_a_box_that_leans_on_the_other_and_on_the_table_is_not_stacked() -> None:
    edges, masses = np.array([0.040, 0.060]), np.array([0.2, 0.1])
    trial = Trial(task=Stack.of(0, edges, masses, np.array([[-0.04, 0], [0.04, 0]]), np.zeros(2)))
    # One edge of the large box on the table, and the face beside it on the small one's upper edge.
    tilt = np.deg2rad(43.0)
    rotation = exp(np.array([0.0, tilt, 0.0]))
    corner = np.array([-0.020 + 0.040 / np.tan(tilt), 0.0, 0.0])
    trial.put(1, corner - rotation @ np.array([0.030, 0.0, -0.030]), rotation)
    both = 0
    for _ in range(30):
        measure = trial.after(0.01)
        both += trial.sensing.touching("second", "base") and trial.sensing.touching("second", TABLE)
        assert not measure.reached
    assert both > 5, "it hardly leaned, and nothing was tested"


def test_a_stack_with_the_base_on_top_is_the_wrong_one(trial: Trial) -> None:
    low = np.array(trial.task.objects[1].position)
    trial.put(1, low)
    trial.stack(0, 1)
    measure = trial.after()
    assert not measure.reached
    assert measure.reason == "the base box does not stand on the table"


def test_a_stack_that_slides_is_not_done(trial: Trial) -> None:
    trial.stack(1, 0)
    assert trial.after().reached
    for name in ("base", "second"):
        trial.data.joint(name).qvel[:3] = 0.02, 0.0, 0.0
    mujoco.mj_forward(trial.scene.model, trial.data)
    assert trial.task.measure(trial.sensing).reason == "the base box is still moving"


def test_three_boxes_count_in_their_order_only(three: Trial) -> None:
    three.stack(1, 0)
    half = three.after()
    assert not half.reached and 0.5 <= half.progress < 0.6
    assert half.reason == "the third box stands on the table"
    three.stack(2, 1)
    assert three.after() == Measure(True, 1.0, "")


def test_forces_between_boxes_are_opposite_and_support_the_weights(three: Trial) -> None:
    three.stack(1, 0)
    three.stack(2, 1)
    three.after(0.5)
    force = three.sensing.force
    for a, b in (("base", "second"), ("second", "third"), ("base", "third")):
        np.testing.assert_array_equal(force(a, b), -force(b, a))
    assert force("third", "second")[2] == pytest.approx(three.weight(2), rel=1e-3)
    both = three.weight(1) + three.weight(2)
    assert force("second", "base")[2] == pytest.approx(both, rel=1e-3)
    assert force("base", TABLE)[2] == pytest.approx(both + three.weight(0), rel=1e-3)
    assert not three.sensing.touching("third", "base")


@dataclass
class Pose:
    position: np.ndarray
    rotation: np.ndarray


def test_a_goal_on_a_box_goes_where_the_box_goes() -> None:
    goal = Goal("b", (0.0, 0.0, 0.05), 0.3, "a")
    for angle, shift in ((0.0, 0.0), (0.4, 0.1), (-2.0, -0.3)):
        turn = exp(np.array([0.0, 0.0, angle]))
        poses = {"a": Pose(np.array([shift, 0.2, 0.025]), turn)}
        (placed,) = place([goal], poses)
        np.testing.assert_allclose(placed.position, [shift, 0.2, 0.075])
        assert np.cos(placed.yaw - angle - 0.3) == pytest.approx(1.0)
        assert placed.on is None


def test_a_goal_on_a_box_that_is_not_placed_yet_is_shown_above_that_boxs_goal() -> None:
    goals = [Goal("b", (0, 0, 0.05), 0.0, "a"), Goal("c", (0, 0, 0.04), 0.0, "b")]
    base, flat = np.array([0.1, 0.0, 0.025]), np.eye(3)
    away = place(goals, {"a": Pose(base, flat), "b": Pose(np.array([-0.1, 0, 0.025]), flat)})
    np.testing.assert_allclose(away[1].position, [0.1, 0.0, 0.115])
    there = np.array([0.106, 0.0, 0.075])
    stacked = place(goals, {"a": Pose(base, flat), "b": Pose(there, flat)})
    np.testing.assert_allclose(stacked[1].position, [0.106, 0.0, 0.115])


@given(angle=st.floats(-3.0, 3.0), face=st.sampled_from([0, 1, 2]), turns=st.integers(0, 3))
def test_the_direction_of_a_cube_is_the_same_on_every_face_but_for_quarter_turns(
    angle: float, face: int, turns: int
) -> None:
    rotation = exp(np.array([0.0, 0.0, angle])) @ exp(turns * np.pi / 2 * np.eye(3)[face])
    assert np.sin(2 * (flat_yaw(rotation) - angle)) == pytest.approx(0.0, abs=1e-9)


USER = UserConfiguration()
HAND = Hand.draw(USER, 0)


@given(
    seed=st.integers(0, 1_000),
    heights=st.lists(st.floats(-0.1, 0.3), min_size=1, max_size=6),
)
def test_a_slider_stays_on_its_way_and_goes_where_it_should(
    seed: int, heights: list[float]
) -> None:
    slider = Slider(0.18, np.random.default_rng(seed))
    now = 0.0
    for height in heights:
        arrival = slider.move(height, now)
        assert arrival > now
        for t in np.linspace(now, arrival, 20):
            assert 0.0 <= slider.control(float(t)) <= 1.0
        now = arrival
        wanted = np.clip(height, 0.0, 0.18)
        assert abs(slider.height(now) - wanted) < 0.18 * 0.2
        if height <= 0.0:
            assert slider.control(now) == 0.0, "at its lower end it rests"


def seen(
    xy: Sequence[float] | Array, edge: float = 0.05, height: float = 0.025, yaw: float = 0.0
) -> SeenObject:
    c, s = np.cos(yaw), np.sin(yaw)
    shape = Box("box", (edge / 2,) * 3, 0.1, (*xy, height))
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return SeenObject(shape, np.array([*xy, height]), rotation)


@pytest.mark.parametrize("direction", np.linspace(0.0, 2 * np.pi, 8, endpoint=False))
def test_fingers_are_put_where_there_is_room(direction: float) -> None:
    box = seen((0.0, 0.0))
    beside = 0.068 * np.array([np.cos(direction), np.sin(direction)])
    neighbour = seen(beside, yaw=direction)
    grasp = roomiest_grasp(box, 0.0, HAND, Surroundings(TABLET, (neighbour,)))
    places = grasp.places(np.zeros(2), grasp.opening(HAND), HAND)
    points = np.column_stack([places, np.full(len(places), 0.028)])
    room = neighbour.shape.clearance(points, neighbour.position, neighbour.rotation)
    assert room.min() > 0.0


@pytest.mark.parametrize("yaw", np.linspace(-0.7, 0.7, 5))
def test_a_failed_grasp_is_not_tried_again_at_once(yaw: float) -> None:
    box = seen((0.0, 0.0), yaw=yaw)
    first = roomiest_grasp(box, 0.0, HAND, Surroundings(TABLET))
    second = roomiest_grasp(box, 0.0, HAND, Surroundings(TABLET), first)
    assert abs(np.sin(second.axis - first.axis)) > 0.9 or np.cos(second.axis - first.axis) < -0.9


def test_a_grasp_is_chosen_that_fits_on_the_screen_at_the_goal_as_well() -> None:
    width = TABLET.size[0]
    goal = TABLET.to_world([width - 0.030, TABLET.size[1] / 2])[:2]
    grasp = roomiest_grasp(seen((0.0, 0.0)), 0.0, HAND, Surroundings(TABLET, (), goal))
    places = grasp.places(goal, -USER.squeeze, HAND)
    xy = TABLET.to_surface(np.column_stack([places, np.zeros(len(places))]))
    assert np.all(xy > 0.0) and np.all(xy < TABLET.size)
