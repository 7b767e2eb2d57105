"""The dial counts at its mark, let go of and at rest, and is turned the way that its scale goes."""

from __future__ import annotations

from math import pi, radians

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from models.scene import Scene, SceneSpec
from models.surface import Surface
from tasks.dial import (
    BORDER,
    KNOB,
    RADIUS,
    SWEEP,
    TORQUE,
    TURN,
    WRIST,
    Dial,
    DialUser,
    KnobHandling,
)
from tasks.simulated_user.grasp import wrapped
from tasks.simulated_user.user_hand import Hand
from tasks.task import Measure, place_surface
from tasks.user import SeenObject, Sight, UserConfiguration
from tests.support.simulation import run
from tests.support.task_scene import TaskScene

SURFACE = place_surface(Surface(), Dial)
seeds = st.integers(0, 2**63 - 1)


class Trial(TaskScene[Dial]):
    """A trial in its real scene, with a hand far above it."""

    def __init__(self, seed: int = 6_000) -> None:
        super().__init__(Dial.draw(seed, SURFACE))
        mujoco.mj_forward(self.scene.model, self.data)

    def at(self, angle: float, speed: float = 0.0) -> Measure:
        """What the task says with the knob at an angle, rad, and a speed, rad/s."""
        self.data.joint(KNOB).qpos[:], self.data.joint(KNOB).qvel[:] = angle, speed
        return self.measure()


@settings(max_examples=30, deadline=None)
@given(seed=seeds)
def test_the_mark_is_three_quarters_of_a_turn_away_and_within_the_end_stops(seed: int) -> None:
    task = Dial.draw(seed, SURFACE)
    knob = next(part for part in task.objects if part.name == KNOB)
    joint = knob.joint  # type: ignore[attr-defined]
    assert abs(task.mark - joint.start) == pytest.approx(TURN) == pytest.approx(1.5 * pi)
    assert joint.range == pytest.approx((-SWEEP / 2, SWEEP / 2))
    assert wrapped(task.goals[0].yaw - knob.yaw - (task.mark - joint.start)) == pytest.approx(
        0.0, abs=1e-9
    )
    xy = SURFACE.to_surface(np.array(knob.position))
    assert np.all(xy >= BORDER - 1e-9) and np.all(xy <= SURFACE.size - BORDER + 1e-9)


def test_it_counts_at_the_mark_and_at_rest_only() -> None:
    trial = Trial()
    mark = trial.task.mark
    start = trial.at(-mark)
    assert start.progress == 0.0 and "270 degrees" in start.reason
    assert trial.at(mark).reached and trial.at(mark - radians(4.9)).reached
    assert not trial.at(mark - radians(5.1)).reached
    assert "moving" in trial.at(mark, 0.2).reason
    assert 0.4 < trial.at(0.0).progress < 0.6
    # The same direction of the pointer, a whole turn away, would be beyond the end stop.
    assert not trial.at(mark - np.sign(mark) * 2 * pi).reached


@pytest.mark.parametrize("seed", range(6_000, 6_006))
def test_the_reason_names_the_direction_in_which_the_pointer_nears_the_mark(seed: int) -> None:
    trial = Trial(seed)
    pointer = np.empty((2, 2))
    sign = -1 if " clockwise" in trial.at(0.0).reason else 1
    for row, angle in zip(pointer, (0.0, 0.1 * sign), strict=True):
        trial.data.joint(KNOB).qpos[:] = angle
        mujoco.mj_forward(trial.scene.model, trial.data)
        row[:] = trial.data.body(KNOB).xmat.reshape(3, 3)[:2, 1]
    # Seen from above, with x to the right and y away from the person.
    turned = np.cross(np.append(pointer[0], 0), np.append(pointer[1], 0))[2]
    assert np.sign(turned) == sign
    off = [abs(wrapped(angle - trial.task.mark)) for angle in (0.0, 0.1 * sign)]
    assert off[1] < off[0]


def test_friction_holds_the_knob_against_less_than_its_torque_and_end_stops_hold_it() -> None:
    trial = Trial()
    data = trial.data
    loss = float(trial.scene.model.dof_frictionloss[trial.scene.model.joint(KNOB).dofadr[0]])
    assert TORQUE[0] <= loss <= TORQUE[1]
    start = trial.sensing.joint(KNOB).position
    body = trial.scene.object_bodies[KNOB]
    data.xfrc_applied[body, 5] = 0.8 * loss * np.sign(trial.task.mark)
    run(trial.scene, data, 0.5)
    assert trial.sensing.joint(KNOB).position == pytest.approx(start, abs=0.01)
    data.xfrc_applied[body, 5] = -2.0 * loss * np.sign(trial.task.mark)
    run(trial.scene, data, 1.0)
    assert abs(trial.sensing.joint(KNOB).position) < SWEEP / 2 + radians(2.0)


def sight_of(task: Dial, angle: float) -> Sight:
    """The screen with the knob at an angle, rad."""
    scene = Scene(SceneSpec((), task.objects))
    data = mujoco.MjData(scene.model)
    data.joint(KNOB).qpos[:] = angle
    mujoco.mj_forward(scene.model, data)
    seen = {t.name: SeenObject(t, *scene.object_pose(data, t.name)) for t in task.objects}
    return Sight(0.0, {}, False, seen, task.goals, False)


@settings(max_examples=20, deadline=None)
@given(seed=seeds, share=st.floats(0.0, 1.0))
def test_the_user_sees_how_far_the_knob_has_to_turn_and_never_across_the_gap(
    seed: int, share: float
) -> None:
    task = Dial.draw(seed, SURFACE)
    angle = SWEEP * (share - 0.5)
    sight = sight_of(task, angle)
    user = DialUser(UserConfiguration(), SURFACE, 1)
    _, turn = user._missing(sight, sight.objects[KNOB])
    assert turn == pytest.approx(task.mark - angle, abs=1e-6)


@pytest.mark.parametrize("fingers", [2, 3, 5])
def test_a_grasp_is_around_the_rim_and_its_wrist_stays_within_reach(fingers: int) -> None:
    task = Dial.draw(3, SURFACE)
    knob = sight_of(task, -task.mark).objects[KNOB]
    handling = KnobHandling(knob.shape)  # type: ignore[arg-type]
    hand = Hand.draw(UserConfiguration(fingers=fingers), 3)
    grasp = handling.grasp(knob, 2 * task.mark, hand)
    places = grasp.places(np.zeros(2), 0.0, hand)
    # A fingertip has a radius of 7 mm.
    assert np.linalg.norm(places, axis=1) == pytest.approx(RADIUS + 0.007)
    assert places[0] @ places[1:].mean(axis=0) < 0.0
    off = wrapped(grasp.axis - hand.natural_axis)
    made = handling.reach(knob, grasp, 2 * task.mark, hand)
    assert max(abs(off), abs(off + made)) <= WRIST + 1e-9
    assert abs(made) == pytest.approx(2 * WRIST)
