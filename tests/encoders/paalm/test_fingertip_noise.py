"""A finger is smoothed as much as its device makes it tremble, and no more."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.evaluation.paalm_errors import judge_recording
from encoders.paalm import PaalmOptions
from encoders.paalm.joint_angles import STEADY, FingertipNoise
from encoders.paalm.simulated.air import simulate_air
from encoders.paalm.simulated.forward import FROZEN_LEAP, leap_take
from tests.support.leap_hands import SHORT, calibrated, take

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


def test_a_jump_after_a_gap_is_not_measured_as_noise() -> None:
    jumps = np.cumsum(np.arange(200) % 40 == 0)[:, None] * np.array([0.05, 0.0, 0.0])
    assert constants(jumps) == 0.03
    found = followed(np.zeros((10, 3)))
    found.interrupt()
    before = found.mean
    for _ in range(2):
        found.add((0.3, 0.0, 0.0))
    assert found.mean == before, "what is before and after a gap is not compared"


def test_a_device_as_quiet_as_it_should_be_is_followed_as_with_a_fixed_constant() -> None:
    one = take(2, drop_outs=False)
    free, fixed = calibrated(one), calibrated(one, FIXED)
    for frame in one.frames:
        np.testing.assert_array_equal(
            free.step(frame).hands["right"].table, fixed.step(frame).hands["right"].table
        )


def test_of_a_noisy_device_a_third_of_the_jitter_goes_and_hardly_any_accuracy() -> None:
    # 2 mm from frame to frame; a real Leap of 2013 had 0.05.
    noisy = replace(FROZEN_LEAP, tip=0.002, length=0.001, direction=1.0)
    free: list[dict[str, float]] = []
    fixed: list[dict[str, float]] = []
    for person in range(7, 13):
        hand = simulate_air(person, "right", replace(SHORT, open_seconds=3.0))
        one = leap_take(hand, person, "v1", False, noisy)
        for found, options in ((free, PaalmOptions()), (fixed, FIXED)):
            found.append(judge_recording("", one, options, names=False).figures)
    jitter, pip = (
        np.mean([f[k] for f in free]) / np.mean([f[k] for f in fixed])
        for k in ("jitter_deg", "pip_deg")
    )
    # Of 18 persons 0.62; of these six 0.66.
    assert jitter < 0.7
    assert pip < 1.05
