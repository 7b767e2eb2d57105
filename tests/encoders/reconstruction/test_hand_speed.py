"""A hand is as slow as it has to be where it meets things, and nobody waits for it elsewhere."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.labels.belief import builtin_population_belief
from encoders.reconstruction.hand_motion import Phase, RateLimit
from encoders.reconstruction.touch_reconstructor import ReconstructorSettings, TouchReconstructor
from encoders.regression.trained import builtin
from models.frames import Contact, TouchFrame
from models.pose import JOINTS, ROOT_POSITION
from models.skeleton import ADULT
from models.surface import Surface

SLOW = RateLimit(0.2, 2.0)
DT = 0.016
PINCH = np.array([[-0.025, 0.012], [0.0, -0.02], [0.025, -0.02]])
places = st.tuples(st.floats(0.04, 0.15), st.floats(0.04, 0.11))


def hand(rate: RateLimit) -> TouchReconstructor:
    model, labeller = builtin("population"), builtin_population_belief()
    settings = ReconstructorSettings(rate=rate)
    return TouchReconstructor(model, labeller, ADULT, Surface(), settings)


def frames(first: np.ndarray, second: np.ndarray) -> list[TouchFrame]:
    """Three fingers rest, slide on while they are down, leave, and come back elsewhere."""
    found = []
    for i in range(240):
        place = None
        if i < 120:
            place = first + (second - first) * min(max(i - 70, 0) / 20, 1.0)
        elif i >= 140:
            place = first
        touched = () if place is None else place + PINCH
        contacts = [
            Contact(k + 10 * (i >= 140), float(x), float(y)) for k, (x, y) in enumerate(touched)
        ]
        found.append(TouchFrame(i * DT, tuple(contacts)))
    return found


@given(first=places, second=places)
@settings(max_examples=8, deadline=None)
def test_a_slow_hand_comes_down_when_a_quick_one_does_and_is_slow_from_there_on(
    first: tuple[float, float], second: tuple[float, float]
) -> None:
    quick, slow = hand(RateLimit()), hand(SLOW)
    before = None
    for frame in frames(np.array(first), np.array(second)):
        fast, careful = quick.step(frame), slow.step(frame)
        assert fast.phase == careful.phase
        if before and before.phase in (Phase.COMING_DOWN, Phase.DOWN):
            moved = careful.q - before.q
            joints = np.linalg.norm(moved[JOINTS].reshape(-1, 3), axis=1)
            assert np.linalg.norm(moved[ROOT_POSITION]) <= SLOW.linear * DT * (1 + 1e-9)
            assert joints.max() <= SLOW.angular * DT * (1 + 1e-9)
        before = careful
    assert careful.phase is Phase.DOWN


@pytest.mark.parametrize("noise", [0.0, 0.001])
def test_a_hand_waits_no_longer_over_resting_touches_with_a_millimetre_of_noise(
    noise: float,
) -> None:
    rng, phases = np.random.default_rng(5), []
    reconstructor = hand(RateLimit())
    for i in range(100):
        places = np.array([0.09, 0.08]) + PINCH + noise * rng.normal(size=(3, 2))
        contacts = [Contact(k, *place) for k, place in enumerate(places.tolist())]
        phases.append(reconstructor.step(TouchFrame(i * DT, tuple(contacts))).phase)
    assert phases[-1] is Phase.DOWN and 0 < phases.count(Phase.ABOVE) * DT < 0.2
