"""Slalom: every trial is a fair one, pins that fall end it, and a person with eyes can do it."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from models.arithmetic import Array
from models.objects import Cylinder
from models.rotations import exp, matrix_to_quaternion
from models.surface import Surface
from tasks.clutter.slalom import (
    FALLEN,
    OPENING,
    PIN_RADIUS,
    Slalom,
)
from tasks.task import Measure
from tasks.variation import Variation, vary
from tests.support.simulation import run
from tests.support.task_scene import TaskScene

TABLET = Surface().centred_at((0.0, 0.0, Slalom.touch_height))


def gates(task: Slalom) -> Array:
    """(2, 2, 2) m, the pins of both gates."""
    return np.array([pin.position[:2] for pin in task.objects[1:]]).reshape(2, 2, 2)


class Trial(TaskScene[Slalom]):
    """A trial in its real scene, with things put where a test wants them."""

    def __init__(self, seed: int = 3) -> None:
        super().__init__(Slalom.draw(seed, TABLET))
        goal = self.task.goals[0]
        box = self.data.joint("box")
        box.qpos[:3] = goal.position
        box.qpos[3:] = matrix_to_quaternion(exp(goal.yaw * np.array([0.0, 0.0, 1.0])))

    def tilt(self, pin: str, angle: float) -> None:
        """Tilts a pin about its middle by an angle, rad."""
        self.data.joint(pin).qpos[3:] = matrix_to_quaternion(exp(np.array([angle, 0.0, 0.0])))


def test_a_box_at_its_goal_with_all_pins_standing_is_there() -> None:
    trial = Trial()
    run(trial.scene, trial.data, 0.2)
    assert trial.measure() == Measure(True, 1.0, "")


@pytest.mark.parametrize("pin", ["pin1", "pin2", "pin3", "pin4"])
def test_a_pin_that_leans_is_not_enough_and_one_that_fell_ends_the_trial(pin: str) -> None:
    trial = Trial()
    trial.tilt(pin, np.deg2rad(8.0))
    leaning = trial.measure()
    assert leaning.reason == "a pin does not stand upright" and not leaning.lost
    trial.tilt(pin, FALLEN + 0.01)
    fallen = trial.measure()
    assert fallen.reason == "a pin has been toppled" and fallen.lost and not fallen.reached


def test_distances_to_a_cylinder_are_those_that_mujoco_measures() -> None:
    rng = np.random.default_rng(4)
    pin = Cylinder("pin", 0.01, 0.03, 0.02, (0.1, 0.0, 0.03)).scaled(1.5)
    assert pin.position[2] == pytest.approx(0.045)
    turn, place = exp(rng.normal(size=3)), rng.normal(0.0, 0.05, 3)
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody>"
        "<body mocap='true'><geom name='a' type='cylinder' size='.015 .045'/></body>"
        "<body mocap='true'><geom name='b' type='sphere' size='.001'/></body></worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    data.mocap_pos[0], data.mocap_quat[0] = place, matrix_to_quaternion(turn)
    points = place + rng.normal(0.0, 0.05, (40, 3))
    for point, far in zip(points, pin.clearance(points, place, turn), strict=True):
        data.mocap_pos[1] = point
        mujoco.mj_kinematics(model, data)
        if far > 0.002:
            assert far - 0.001 == pytest.approx(
                mujoco.mj_geomDistance(model, data, 0, 1, 1.0, None), abs=1e-6
            )


@pytest.mark.parametrize("factor", [0.9, 1.2])
def test_room_is_the_width_of_the_gates_and_nothing_else(factor: float) -> None:
    task = Slalom.draw(5, TABLET)
    varied = vary(task, Variation(room=factor), TABLET)
    assert isinstance(varied, Slalom)
    before, after = gates(task), gates(varied)
    assert np.allclose(before.mean(axis=1), after.mean(axis=1))
    wide = np.linalg.norm(after[:, 0] - after[:, 1], axis=1) - 2 * PIN_RADIUS
    assert np.allclose(wide, factor * OPENING)
    assert varied.objects[0] == task.objects[0] and varied.goals == task.goals
