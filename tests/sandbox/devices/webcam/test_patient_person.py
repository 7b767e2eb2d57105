"""A simulated user who bears with a hand that follows badly, and landmarks that wander."""

import numpy as np
import pytest

from models.objects import Box
from models.rotations import exp
from sandbox.devices.simulated.air_user.body import AXIS, Pinch
from sandbox.devices.simulated.air_user.patient import PatientPerson
from sandbox.devices.simulated.air_user.person import Stage
from sandbox.devices.webcam import webcam_choice
from tasks.task import Goal
from tasks.user import SeenObject, Sight, UserConfiguration
from tests.support.drawn_person import Wandering, perfect, play

ABOVE = webcam_choice("at=0/0.05/0.58,tilt=90,roll=180").camera


@pytest.mark.parametrize("off", [0.0, 4.0])
def test_the_patient_user_stacks_boxes_by_landmarks_that_wander(off: float) -> None:
    result, device = play(
        "stack", 201, ABOVE, perfect(ABOVE, off, 201), rate=10.0, late=0.1, patient=True
    )
    assert result.success
    assert np.median(device.beside) == pytest.approx(1.18 * off, rel=0.1, abs=1e-6)


class Dragged(PatientPerson):
    """Tells what it does."""

    stages: list[Stage]

    def _go(self, aim: Pinch, stage: Stage, now: float, slowness: float = 1.0) -> None:
        self.stages.append(stage)
        super()._go(aim, stage, now, slowness)


def dragged_box(x: float, yaw: float) -> Sight:
    """A box (x, 0) from its goal in m, turned by rad, between thumb and fingers on the table."""
    box = Box("box", (0.025, 0.025, 0.025), 0.1, (x, 0.0, 0.025), yaw)
    seen = SeenObject(box, np.array([x, 0.0, 0.025]), exp(np.array([0.0, 0.0, yaw])))
    axis = np.array([np.cos(AXIS), np.sin(AXIS), 0.0])
    tips = {f: np.array([x, 0.0, 0.02]) + side * 0.04 * axis for f, side in SIDES.items()}
    goal = Goal("box", (0.0, 0.0, 0.025), 0.0)
    return Sight(0.0, tips, True, {"box": seen}, (goal,), False)


SIDES = {0: -1.0, 1: 1.0, 2: 1.0, 3: 2.0, 4: 2.0}


def test_a_box_that_was_dragged_is_held_again_and_put_so_far_before_its_goal() -> None:
    person = Dragged(UserConfiguration(), 1, np.full(5, 0.007))
    person.stages = []
    person._name = "box"
    person._push(dragged_box(0.002, 0.0), 1.0)
    assert person.stages == [Stage.OPENED]
    after = dragged_box(0.014, 0.2)
    person._leave(after, 2.0)
    # The hand is still about it: it is not raised, and does not come from above again.
    assert person.stages == [Stage.OPENED, Stage.CLOSED]
    goal = person._goal(after)
    assert goal.position == pytest.approx((-0.012, 0.0, 0.025)) and goal.yaw == pytest.approx(-0.2)


def test_landmarks_wander_as_far_as_is_said_and_slowly() -> None:
    wandering = Wandering(2.0, 3)
    places = np.array([wandering.at(0.1 * i) for i in range(4000)])
    assert places.std() == pytest.approx(2.0, rel=0.05)
    steps = np.diff(places, axis=0)
    # exp(-0.2) of a landmark's error is left after 0.1 s.
    assert steps.std() == pytest.approx(2.0 * np.sqrt(2.0 * (1.0 - np.exp(-0.2))), rel=0.05)
