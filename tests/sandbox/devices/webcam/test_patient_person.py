"""A simulated user who bears with a hand that follows badly, and landmarks that wander."""

import numpy as np
import pytest

from sandbox.devices.webcam import webcam_choice
from tests.support.drawn_person import perfect, play

ABOVE = webcam_choice("at=0/0.05/0.58,tilt=90,roll=180").camera


@pytest.mark.parametrize("off", [0.0, 4.0])
def test_the_patient_user_stacks_boxes_by_landmarks_that_wander(off: float) -> None:
    result, device = play(
        "stack", 201, ABOVE, perfect(ABOVE, off, 201), rate=10.0, late=0.1, patient=True
    )
    assert result.success
    assert np.median(device.beside) == pytest.approx(1.18 * off, rel=0.1, abs=1e-6)
