"""Box to goal: every trial is a fair one, and nothing counts as done that is not."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
import pytest

from benchmarks.pinch import pinch_poses
from models.arithmetic import Array
from models.rotations import exp, matrix_to_quaternion
from models.surface import Surface
from tasks.box_to_goal import EDGE, BoxToGoal
from tasks.task import Measure
from tests.support.simulation import no_warning, put, run
from tests.support.task_scene import AWAY, TaskScene

TABLET = Surface().centred_at((0.0, 0.0, BoxToGoal.touch_height))


def turned(degrees: float, axis: int = 2) -> np.ndarray:
    return exp(np.deg2rad(degrees) * np.eye(3)[axis])


class Trial(TaskScene[BoxToGoal]):
    """A trial in its real scene, with the box put where a test wants it."""

    def __init__(self, seed: int = 4) -> None:
        super().__init__(BoxToGoal.draw(seed, TABLET))
        self.goal = np.asarray(self.task.goals[0].position)
        self.joint = self.data.joint("box")

    def place(
        self,
        shift: Sequence[float] | Array = (0.0, 0.0, 0.0),
        turn: float = 0.0,
        rotation: Array | None = None,
    ) -> None:
        """The box at rest at its goal, but for a shift (m), a turn (degrees) and a rotation."""
        yaw = turned(np.rad2deg(self.task.goals[0].yaw) + turn)
        matrix = yaw if rotation is None else yaw @ rotation
        self.joint.qpos[:3] = self.goal + np.asarray(shift)
        self.joint.qpos[3:] = matrix_to_quaternion(matrix)
        self.joint.qvel[:] = 0.0

    def measure(self) -> Measure:
        measure = super().measure()
        no_warning(self.data)
        return measure


@pytest.fixture
def trial() -> Trial:
    return Trial()


@pytest.mark.parametrize("degrees", [0.0, 90.0, 180.0, -90.0, 270.0])
def test_a_cube_at_its_goal_has_arrived_and_a_quarter_turn_counts_as_none(
    trial: Trial, degrees: float
) -> None:
    assert resting(trial, turn=degrees) == Measure(True, 1.0, "")


def resting(trial: Trial, **place: Any) -> Measure:
    """What is said of a box that was put somewhere near the goal and has come to rest."""
    trial.place(**place)
    run(trial.scene, trial.data, 0.2)
    return trial.task.measure(trial.sensing)


@pytest.mark.parametrize("direction", [(1, 0), (0, -1), (0.6, 0.8)])
def test_a_centimetre_off_is_off(trial: Trial, direction: tuple[float, float]) -> None:
    step = np.array([*direction, 0.0])
    assert resting(trial, shift=0.009 * step).reached
    assert not resting(trial, shift=0.011 * step).reached


@pytest.mark.parametrize(("quarter", "sign"), [(0.0, 1.0), (0.0, -1.0), (90.0, 1.0), (180.0, -1.0)])
def test_eleven_degrees_are_too_many(trial: Trial, sign: float, quarter: float) -> None:
    assert resting(trial, turn=quarter + 9.0 * sign).reached
    assert not resting(trial, turn=quarter + 11.0 * sign).reached


def on_edge(degrees: float, axis: int) -> dict[str, Any]:
    """A box tilted on one of its edges, which is pressed into the table as a weight presses it."""
    angle = np.deg2rad(abs(degrees))
    lowest = EDGE / 2 * (np.cos(angle) + np.sin(angle))
    return {"shift": (0, 0, lowest - EDGE / 2 - 1e-5), "rotation": turned(degrees, axis)}


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_tilted_box_has_not_arrived(trial: Trial, axis: int, sign: float) -> None:
    trial.place(**on_edge(4.0 * sign, axis))
    assert trial.measure().reached
    trial.place(**on_edge(6.0 * sign, axis))
    assert not trial.measure().reached


def test_a_box_on_another_face_does_not_count_as_upright(trial: Trial) -> None:
    # It looks the same; the task asks for the face that was below.
    assert not resting(trial, rotation=turned(90.0, 0)).reached


def test_a_box_in_the_air_has_not_arrived(trial: Trial) -> None:
    trial.place(shift=(0.0, 0.0, 0.003))
    assert not trial.measure().reached


def test_a_box_that_moves_has_not_arrived(trial: Trial) -> None:
    trial.place(shift=(0.0, 0.0, -1e-5))
    trial.joint.qvel[:3] = 0.009, 0.0, 0.0
    assert trial.measure().reached
    trial.joint.qvel[:3] = 0.0, 0.011, 0.0
    assert not trial.measure().reached


def test_a_box_in_somebodys_fingers_has_not_arrived_until_they_let_go(trial: Trial) -> None:
    trial.place()
    box = trial.task.objects[0]
    at_goal = type(box)(
        box.name, box.half_size, box.mass, tuple(trial.goal), trial.task.goals[0].yaw
    )
    opened, closed = pinch_poses(at_goal)
    put(trial.scene, trial.data, opened)
    trial.scene.set_solid(0, frozenset({0, 1}))
    run(trial.scene, trial.data, 0.1)
    assert trial.task.measure(trial.sensing).reached, "fingers beside the box do not hold it"
    for share in np.linspace(0.0, 1.0, 20):
        trial.data.ctrl[:] = opened + share * (closed - opened)
        run(trial.scene, trial.data, 0.016)
    run(trial.scene, trial.data, 0.3)
    measure = trial.task.measure(trial.sensing)
    assert not measure.reached
    assert 0.9 < measure.progress < 1.0
    trial.data.ctrl[:] = opened
    run(trial.scene, trial.data, 0.5)
    assert trial.task.measure(trial.sensing).reached


def test_a_ghost_in_the_box_does_not_hold_it(trial: Trial) -> None:
    trial.place()
    inside = AWAY.copy()
    put(trial.scene, trial.data, inside)
    mujoco.mj_forward(trial.scene.model, trial.data)
    inside[:3] += trial.goal - trial.data.body("right_index_dip").xpos
    put(trial.scene, trial.data, inside)
    run(trial.scene, trial.data, 0.2)
    assert trial.task.measure(trial.sensing).reached


@pytest.mark.parametrize("seed", range(5))
def test_progress_grows_on_the_way_to_the_goal_and_is_whole_only_there(seed: int) -> None:
    trial = Trial(seed)
    start = np.asarray(trial.task.objects[0].position)
    said = []
    for share in np.linspace(0.0, 1.0, 101):
        trial.place(shift=(1.0 - share) * (start - trial.goal) - [0.0, 0.0, 1e-5])
        measure = trial.measure()
        said.append(measure.progress)
        assert (measure.progress == 1.0) == measure.reached
    assert said[0] < 0.01
    assert np.all(np.diff(said) >= 0)
    assert said[-1] == 1.0
    trial.place(shift=2.0 * (start - trial.goal))
    assert trial.measure().progress == 0.0, "farther than at the start is no progress"
