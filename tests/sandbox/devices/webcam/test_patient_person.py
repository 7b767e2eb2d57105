"""A simulated user who bears with a hand that follows badly, and landmarks that wander."""

import numpy as np
import pytest

from benchmarks.webcam_loop import Wandering, perfect, play
from sandbox.options.webcam_devices import webcam_choice

ABOVE = webcam_choice("at=0/0.05/0.58,tilt=90,roll=180").camera


@pytest.mark.parametrize("off", [0.0, 4.0])
def test_the_patient_user_stacks_boxes_by_landmarks_that_wander(off: float) -> None:
    result, device = play(
        "stack", 201, ABOVE, perfect(ABOVE, off, 201), rate=10.0, late=0.1, patient=True
    )
    assert result.success
    assert np.median(device.beside) == pytest.approx(1.18 * off, rel=0.1, abs=1e-6)


def test_landmarks_wander_as_far_as_is_said_and_slowly() -> None:
    wandering = Wandering(2.0, 3)
    places = np.array([wandering.at(0.1 * i) for i in range(4000)])
    assert places.std() == pytest.approx(2.0, rel=0.05)
    steps = np.diff(places, axis=0)
    # exp(-0.2) of a landmark's error is left after 0.1 s.
    assert steps.std() == pytest.approx(2.0 * np.sqrt(2.0 * (1.0 - np.exp(-0.2))), rel=0.05)
