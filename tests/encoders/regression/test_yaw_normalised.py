"""An encoder that turns with the hand: what it knows in one direction it knows in all."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.capture import Capture
from encoders.input_vector import contact_vectors
from encoders.regression.trained import builtin_capture
from encoders.regression.yaw_normalised import (
    YawNormalisedEncoder,
    normalised_touches,
    yaw_of,
)
from models.arithmetic import Array
from models.errors import EncoderError
from models.pose import absolute_pose, joint_vectors
from models.rotations import exp, geodesic_angle, log
from tests.encoders.regression.turning import turned_places, turned_pose


@cache
def learned() -> Capture:
    return builtin_capture().select(np.arange(0, len(builtin_capture()), 10))


@cache
def new() -> Capture:
    """Other frames; two fingers alone hardly tell where the hand points, three do."""
    capture = builtin_capture()
    frames = capture.select(np.arange(5, len(capture), 50))
    return frames.select(frames.down.sum(axis=1) >= 3)


@cache
def turned_encoder() -> YawNormalisedEncoder:
    return YawNormalisedEncoder().fit(learned().u, learned().relative)


points = st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)).map(np.array)
angles = st.floats(-3.0, 3.0)
seeds = st.integers(0, 2**16)


def estimate(xy: np.ndarray) -> np.ndarray:
    """(T, 48) poses in the 3-D surface frame of touches (T, 5, 2)."""
    u, leftmost = contact_vectors(xy)
    return absolute_pose(turned_encoder().predict(u), leftmost)


@settings(max_examples=30)
@given(degrees=st.floats(-40, 40), about=points)
def test_touches_that_turn_turn_the_hand_and_hardly_move_its_joints(
    degrees: float, about: Array
) -> None:
    angle = np.deg2rad(degrees)
    turned = turned_pose(estimate(new().xy), angle, about)
    found = estimate(turned_places(new().xy, angle, about))
    assert geodesic_angle(turned[:, 3:6], found[:, 3:6]).mean() < 0.15 * abs(angle) + 1e-9
    joints = geodesic_angle(joint_vectors(turned), joint_vectors(found))
    assert joints.mean() < np.deg2rad(1.0)
    assert np.linalg.norm((turned - found)[:, :3], axis=1).mean() < 0.010


@given(shift=points)
def test_touches_that_move_together_change_nothing_relative(shift: Array) -> None:
    moved = turned_encoder().predict(contact_vectors(new().xy + shift)[0])
    np.testing.assert_allclose(moved, turned_encoder().predict(new().u), atol=1e-9)


@given(seed=seeds, angle=angles, more=angles, shift=points)
def test_the_normalised_frame_does_not_depend_on_the_hands_turn_and_place(
    seed: int, angle: float, more: float, shift: Array
) -> None:
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, 0.2, (6, 5, 2))
    xy[rng.uniform(size=(6, 5)) < 0.3] = np.nan
    xy[:, 0] = 0.1
    before, after = xy, turned_places(xy, more, shift)
    turn = np.full(6, angle)
    u, leftmost = contact_vectors(before)
    inputs, middle = normalised_touches(u, turn)
    # From the leftmost contact, y up.
    expected = (np.nanmean(before, axis=1) - leftmost) * [1.0, -1.0]
    np.testing.assert_allclose(middle, expected, atol=1e-12)
    same, _ = normalised_touches(contact_vectors(after)[0], turn + more)
    np.testing.assert_allclose(same, inputs, atol=1e-9)


@given(tilt=st.tuples(st.floats(-1, 1), st.floats(-1, 1)), angle=angles, more=angles)
def test_the_turn_of_a_pose_is_what_it_was_turned_by_whatever_its_tilt(
    tilt: tuple[float, float], angle: float, more: float
) -> None:
    q = np.zeros(48)
    q[3:6] = log(exp([0.0, 0.0, angle]) @ exp([*tilt, 0.0]))
    assert yaw_of(q) == pytest.approx(angle, abs=1e-9)
    gap = yaw_of(turned_pose(q, more, (0.1, -0.2))) - angle - more
    assert (gap + np.pi) % (2 * np.pi) - np.pi == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("shape", ((), (136,), (136, 48), (0, 136, 48), (3, 136, 47), (3, 816, 48)))
def test_coefficients_of_another_shape_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(EncoderError, match="coefficients"):
        YawNormalisedEncoder().load(np.zeros(shape))


@pytest.mark.parametrize("ridges", ((-1.0, 0.1), (0.1, np.nan), (np.inf, 0.1)))
def test_an_invalid_ridge_is_refused(ridges: tuple[float, float]) -> None:
    with pytest.raises(EncoderError, match="ridge"):
        YawNormalisedEncoder(*ridges).fit(learned().u, learned().relative)
