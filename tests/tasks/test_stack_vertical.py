"""Stacking in an upright plane: what is drawn, what counts as stacked, and that it can be done."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from models.rotations import exp, matrix_to_quaternion
from models.surface import Surface
from sandbox.session.respawn import AWAY
from tasks.stack import StackVertical
from tasks.task import Measure, place_surface
from tests.support.scripted import run as proceed
from tests.support.scripted import scripted
from tests.support.simulation import no_warning, run
from tests.support.task_scene import TaskScene

FAR = np.concatenate([[0.0, -0.3, 0.10], np.zeros(45)])
UPRIGHT = place_surface(Surface(), StackVertical)


class Stack(TaskScene[StackVertical]):
    """A trial in its scene, with the second box put on, beside or before the base."""

    def __init__(self, seed: int = 3) -> None:
        super().__init__(StackVertical.draw(seed, UPRIGHT), FAR)
        self.edge = 2 * min(box.half_size[0] for box in self.task.objects)

    def place(
        self, right: float, away: float, turn: tuple[float, float, float] = (0, 0, 0)
    ) -> None:
        """The second box on the base, but for shares of the smaller edge and degrees."""
        base, second = self.task.objects
        middle = np.asarray(base.position)
        height = base.half_size[2] + second.half_size[2] - 1e-5
        joint = self.data.joint("second")
        shift = np.array([right * self.edge, away * self.edge, height])
        joint.qpos[:3] = middle + shift
        joint.qpos[3:] = matrix_to_quaternion(exp(np.deg2rad(turn)))

    def after(self, seconds: float = 0.3) -> Measure:
        run(self.scene, self.data, seconds)
        no_warning(self.data)
        return self.task.measure(self.sensing)


@pytest.mark.parametrize("turn", [(0, 0, 0), (0, 0, 40), (90, 0, 0), (0, 90, 20), (180, 0, 0)])
def test_a_cube_on_the_base_is_stacked_on_any_face_and_at_any_yaw(
    turn: tuple[int, int, int],
) -> None:
    stack = Stack()
    stack.place(0.1, -0.1, turn)
    measure = stack.after()
    assert measure.reached, measure.reason
    assert measure.progress == 1.0


@pytest.mark.parametrize(("right", "away"), [(0.40, 0.0), (-0.40, 0.0), (0.0, 0.40), (0.0, -0.40)])
def test_depth_counts_for_the_offset_as_much_as_what_is_seen(right: float, away: float) -> None:
    stack = Stack()
    stack.place(right, away)
    measure = stack.after()
    assert not measure.reached
    stack.place(0.75 * right, 0.75 * away)
    assert stack.after().reached


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize("taken", [False, True])
def test_a_box_that_fingers_can_no_longer_meet_comes_back_into_their_plane(
    sign: float, taken: bool
) -> None:
    session = scripted(lambda now: (), task="stack-vertical", seed=3)
    boxes: Any = session.task.objects
    base, second = boxes
    start = int(session.scene.model.joint("second").qposadr[0])
    depth = sign * (second.half_size[0] + base.half_size[0] + 0.005)
    session.data.qpos[start + 1] = depth
    if taken:
        other = int(session.scene.model.joint("base").qposadr[0])
        session.data.qpos[other] = second.position[0] + 0.01
    proceed(session, AWAY - 0.1)
    assert np.isclose(session.data.qpos[start + 1], depth, atol=1e-3)
    proceed(session, 0.4)
    assert session.respawned == 1
    back = session.scene.object_pose(session.data, "second")[0]
    assert np.isclose(back[1], 0.0, atol=1e-3)
    aside = abs(back[0] - second.position[0])
    assert 0.02 < aside < 0.15 if taken else aside < 1e-3


@pytest.mark.parametrize("deeper", [-0.012, 0.012])
def test_a_box_that_fingers_still_meet_is_left_at_its_depth(deeper: float) -> None:
    session = scripted(lambda now: (), task="stack-vertical", seed=3)
    start = int(session.scene.model.joint("second").qposadr[0])
    session.data.qpos[start + 1] = deeper
    proceed(session, 1.0)
    assert session.respawned == 0
    assert np.isclose(session.data.qpos[start + 1], deeper, atol=1e-3)
