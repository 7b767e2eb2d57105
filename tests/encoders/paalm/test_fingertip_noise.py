"""A finger is smoothed as much as its device makes it tremble, and no more."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.paalm import PaalmOptions
from encoders.paalm.joint_angles import STEADY, FingertipNoise
from tests.support.leap_hands import calibrated, take

DT = 1.0 / 60.0
FIXED = PaalmOptions(longest=PaalmOptions().smoothing)


def followed(places: np.ndarray) -> FingertipNoise:
    noise = FingertipNoise()
    for place in places.tolist():
        noise.add(tuple(place))
    return noise


def constants(places: np.ndarray) -> float:
    return followed(places).constant(DT, 0.03, 0.15)


@given(st.integers(0, 10_000), st.floats(0.2, 5.0))
@settings(max_examples=40, deadline=None)
def test_the_time_constant_grows_with_the_square_of_white_noise(seed: int, size: float) -> None:
    noise = np.random.default_rng(seed).standard_normal((400, 3))
    # Of independent numbers, a second difference has six times the variance.
    scale = size * STEADY / (np.sqrt(6.0) * np.sqrt(8.0 / np.pi))
    found = followed(scale * noise)
    assert 0.6 * size < found.mean / STEADY < 1.6 * size
    asked = DT * (found.mean / STEADY) ** 2
    assert found.constant(DT, 0.03, 0.15) == min(max(asked, 0.03), 0.15)


@given(st.floats(0.15, 1.0), st.floats(0.01, 0.08), st.tuples(*[st.floats(-1, 1)] * 3))
@settings(deadline=None)
def test_fast_movement_is_not_measured_as_noise(
    time: float, far: float, way: tuple[float, float, float]
) -> None:
    s = np.clip((np.arange(120) * DT - 0.5) / time, 0.0, 1.0)
    places = (far * (10 * s**3 - 15 * s**4 + 6 * s**5))[:, None] * np.array(way)
    assert constants(places) == 0.03


def test_a_jump_and_a_gap_are_not_measured_as_noise() -> None:
    jumps = np.cumsum(np.arange(200) % 40 == 0)[:, None] * np.array([0.05, 0.0, 0.0])
    assert constants(jumps) == 0.03
    found = followed(np.zeros((10, 3)))
    found.interrupt()
    for _ in range(2):
        found.add((0.3, 0.0, 0.0))
    assert found.mean == 0.0


def test_a_device_as_quiet_as_it_should_be_is_followed_as_with_a_fixed_constant() -> None:
    one = take(2, drop_outs=False)
    free, fixed = calibrated(one), calibrated(one, FIXED)
    for frame in one.frames:
        np.testing.assert_array_equal(
            free.step(frame).hands["right"].table, fixed.step(frame).hands["right"].table
        )
