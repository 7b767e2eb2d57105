"""An encoder that turns with the hand: what it knows in one direction it knows in all."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike

from encoders.capture import Capture
from encoders.input_vector import contact_vectors
from encoders.regression.polynomial import PolynomialEncoder, QuadraticEncoder
from encoders.regression.trained import builtin_capture
from encoders.regression.yaw_normalised import (
    SPREADS,
    YawNormalisedEncoder,
    normalised_touches,
    yaw_of,
)
from models.arithmetic import Array
from models.errors import EncoderError
from models.pose import absolute_pose, joint_vectors, relative_pose
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


@cache
def plain_encoder() -> QuadraticEncoder:
    return QuadraticEncoder(0.03).fit(learned().u, learned().relative)


points = st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)).map(np.array)
angles = st.floats(-3.0, 3.0)
seeds = st.integers(0, 2**16)


def estimate(encoder: YawNormalisedEncoder | PolynomialEncoder, xy: np.ndarray) -> np.ndarray:
    """(T, 48) poses in the 3-D surface frame of touches (T, 5, 2)."""
    u, leftmost = contact_vectors(xy)
    return absolute_pose(encoder.predict(u), leftmost)


def differences(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(3,) mean distance of the wrist (m), angle of the hand and angle of the joints (rad)."""
    wrist = np.linalg.norm((a - b)[:, :3], axis=1).mean()
    hand = geodesic_angle(a[:, 3:6], b[:, 3:6]).mean()
    return np.array([wrist, hand, geodesic_angle(joint_vectors(a), joint_vectors(b)).mean()])


def after_a_turn(
    encoder: YawNormalisedEncoder | PolynomialEncoder, angle: float, about: np.ndarray
) -> np.ndarray:
    """How far the poses of turned touches are from the turned poses of the touches."""
    turned = turned_pose(estimate(encoder, new().xy), angle, about)
    return differences(turned, estimate(encoder, turned_places(new().xy, angle, about)))


@settings(max_examples=30)
@given(degrees=st.floats(-40, 40), about=points)
def test_touches_that_turn_turn_the_hand_and_hardly_move_its_joints(
    degrees: float, about: Array
) -> None:
    wrist, hand, joints = after_a_turn(turned_encoder(), np.deg2rad(degrees), about)
    assert hand < 0.15 * np.deg2rad(abs(degrees)) + 1e-9
    assert joints < np.deg2rad(1.0)
    assert wrist < 0.010


@settings(max_examples=30)
@given(degrees=st.floats(5, 40), left=st.booleans(), about=points)
def test_a_plain_quadratic_turns_far_worse(degrees: float, left: bool, about: Array) -> None:
    angle = np.deg2rad(degrees if left else -degrees)
    assert (
        after_a_turn(turned_encoder(), angle, about)
        < 0.5 * after_a_turn(plain_encoder(), angle, about)
    ).all()


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
    inputs, _ = normalised_touches(contact_vectors(before)[0], turn)
    same, _ = normalised_touches(contact_vectors(after)[0], turn + more)
    np.testing.assert_allclose(same, inputs, atol=1e-9)


@given(seed=seeds, angle=angles)
def test_the_middle_of_turned_touches_is_zero_and_so_are_lifted_fingers(
    seed: int, angle: float
) -> None:
    rng = np.random.default_rng(seed)
    xy = rng.uniform(0, 0.2, (1, 5, 2))
    xy[0, rng.permutation(5)[: seed % 5]] = np.nan
    u, leftmost = contact_vectors(xy)
    inputs, middle = normalised_touches(u, np.array([angle]))
    places, down = inputs[:, :10].reshape(5, 2), u[0, 10:] == 1
    np.testing.assert_array_equal(inputs[:, 10:], u[:, 10:])
    np.testing.assert_array_equal(places[~down], 0.0)
    np.testing.assert_allclose(places[down].sum(axis=0), 0.0, atol=1e-9)
    # From the leftmost contact, y up.
    wanted = (np.nanmean(xy, axis=1) - leftmost) * [1.0, -1.0]
    np.testing.assert_allclose(middle, wanted, atol=1e-12)


@given(tilt=st.tuples(st.floats(-1, 1), st.floats(-1, 1)), angle=angles, more=angles)
def test_the_turn_of_a_pose_is_what_it_was_turned_by_whatever_its_tilt(
    tilt: tuple[float, float], angle: float, more: float
) -> None:
    q = np.zeros(48)
    q[3:6] = log(exp([0.0, 0.0, angle]) @ exp([*tilt, 0.0]))
    assert yaw_of(q) == pytest.approx(angle, abs=1e-9)
    gap = yaw_of(turned_pose(q, more, (0.1, -0.2))) - angle - more
    assert (gap + np.pi) % (2 * np.pi) - np.pi == pytest.approx(0.0, abs=1e-9)


BASE = np.array([[-0.057, -0.05], [-0.027, 0.02], [0.003, 0.03], [0.023, 0.02], [0.048, 0.0]])
BASE -= BASE.mean(axis=0)
"""(5, 2) m, y up: fingertips of a hand that points up the screen."""


def turning_hands(frames: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Contact vectors and relative poses of hands whose pose is a quadratic of what they see.

    Layouts stray about BASE, but never turn as a whole: that is what the hand's turn is. Then
    every hand is turned by up to 80 degrees.
    """
    rng = np.random.default_rng(seed)
    places = BASE + rng.normal(0, 0.008, (frames, 5, 2))
    places -= places.mean(axis=1, keepdims=True)
    (x, y), (bx, by) = np.moveaxis(places, -1, 0), BASE.T
    strayed = np.arctan2((bx * y - by * x).sum(axis=1), (bx * x + by * y).sum(axis=1))
    turn = rng.uniform(-1.4, 1.4, frames)
    law = np.random.default_rng(7).normal(0, 0.0125, (66, 48))
    law[:, :3] *= 0.1
    law[:, 3:6] = 0.0
    xy, q = np.empty((frames, 5, 2)), np.empty((frames, 48))
    terms = QuadraticEncoder().fit(np.zeros((1, 10)), np.zeros((1, 1))).terms
    for i in range(frames):
        straight = turned_places(places[i] * [1, -1], -strayed[i], np.zeros(2))
        xy[i] = turned_places(straight, turn[i], np.zeros(2))
        seen = (straight * [1, -1] - BASE).ravel() / 0.008
        q[i] = turned_pose(terms(seen) @ law, turn[i], np.zeros(2))
    u, leftmost = contact_vectors(xy)
    return u, relative_pose(q, leftmost)


def test_a_quadratic_law_in_the_hands_own_frame_is_found_far_better_than_by_a_plain_quadratic() -> (
    None
):
    u, q = turning_hands(1500, 1)
    unseen, truth = turning_hands(400, 2)
    turned = differences(YawNormalisedEncoder(1e-4, 1e-4).fit(u, q).predict(unseen), truth)
    plain = min(
        (differences(QuadraticEncoder(r).fit(u, q).predict(unseen), truth) for r in (0, 1e-4)),
        key=lambda found: found[0],
    )
    assert (turned < plain / 4).all()


def test_on_takes_not_seen_the_wrist_is_nearer_than_a_plain_quadratics() -> None:
    left = learned().trial % 5 == 0
    seen, unseen = learned().select(~left), learned().select(left)

    def wrist_error(encoder: YawNormalisedEncoder | PolynomialEncoder) -> float:
        fitted = encoder.fit(seen.u, seen.relative)
        return float(differences(fitted.predict(unseen.u), unseen.relative)[0])

    assert wrist_error(YawNormalisedEncoder()) < wrist_error(QuadraticEncoder(0.03))


def test_the_same_training_gives_the_same_encoder_to_the_bit() -> None:
    again = YawNormalisedEncoder().fit(learned().u, learned().relative)
    np.testing.assert_array_equal(again.coef_, turned_encoder().coef_)
    assert again.coef_.shape == (1 + len(SPREADS), 136, 48)


def test_the_first_of_its_quadratics_is_the_plain_one() -> None:
    np.testing.assert_array_equal(turned_encoder().coef_[0], plain_encoder().coef_)


def test_training_leaves_its_data_as_they_were() -> None:
    u, q = learned().u.copy(), learned().relative.copy()
    YawNormalisedEncoder().fit(u, q).predict(u)
    np.testing.assert_array_equal(u, learned().u)
    np.testing.assert_array_equal(q, learned().relative)


@given(rows=st.lists(st.deferred(lambda: st.integers(0, len(new()) - 1)), min_size=1, max_size=5))
def test_many_at_once_are_what_one_after_the_other_is(rows: list[int]) -> None:
    together = turned_encoder().predict(new().u[rows])
    alone = np.stack([turned_encoder().predict(new().u[i]) for i in rows])
    assert together.shape == (len(rows), 48)
    np.testing.assert_allclose(together, alone, atol=1e-10)
    shaped = turned_encoder().predict(new().u[[rows, rows]])
    np.testing.assert_allclose(shaped, np.stack([together, together]), atol=1e-10)


def test_coefficients_taken_over_predict_alike_to_the_bit() -> None:
    loaded = YawNormalisedEncoder().load(turned_encoder().coef_)
    np.testing.assert_array_equal(loaded.predict(new().u), turned_encoder().predict(new().u))


@pytest.mark.parametrize(
    ("u", "q"),
    (
        (np.zeros((4, 14)), np.zeros((4, 48))),
        (np.zeros((4, 15)), np.zeros((4, 47))),
        (np.zeros((4, 15)), np.zeros((3, 48))),
        (np.zeros((0, 15)), np.zeros((0, 48))),
        (np.zeros(15), np.zeros(48)),
        (0.0, 0.0),
        (np.full((4, 15), np.nan), np.zeros((4, 48))),
        (np.zeros((4, 15)), np.full((4, 48), np.inf)),
    ),
)
def test_data_that_are_no_touches_and_poses_are_refused(u: ArrayLike, q: ArrayLike) -> None:
    with pytest.raises(EncoderError):
        YawNormalisedEncoder().fit(u, q)


@pytest.mark.parametrize("shape", ((14,), (3, 16), ()))
def test_inputs_of_another_width_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(EncoderError, match="inputs"):
        turned_encoder().predict(np.zeros(shape))


def test_an_encoder_says_when_it_has_learned_nothing() -> None:
    with pytest.raises(EncoderError, match="learned nothing"):
        YawNormalisedEncoder().predict(np.zeros(15))


@pytest.mark.parametrize("shape", ((), (136,), (136, 48), (0, 136, 48), (3, 136, 47), (3, 816, 48)))
def test_coefficients_of_another_shape_are_refused(shape: tuple[int, ...]) -> None:
    with pytest.raises(EncoderError, match="coefficients"):
        YawNormalisedEncoder().load(np.zeros(shape))


@pytest.mark.parametrize("ridges", ((-1.0, 0.1), (0.1, np.nan), (np.inf, 0.1)))
def test_an_invalid_ridge_is_refused(ridges: tuple[float, float]) -> None:
    with pytest.raises(EncoderError, match="ridge"):
        YawNormalisedEncoder(*ridges).fit(learned().u, learned().relative)
