"""A correction by touches is an estimate: exact where it knows the bones, cautious elsewhere."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from scipy.optimize import least_squares

from encoders.capture import Capture
from encoders.correction import PAD_HEIGHT
from encoders.regression.bone_fit import (
    perturbed_skeleton,
    train_correction,
)
from encoders.regression.polynomial import PolynomialEncoder
from encoders.regression.trained import PersonCorrection, builtin_capture
from encoders.regression.training import blocked_predictions
from encoders.validation import robust_covariance
from models.kinematics import Kinematics
from models.pose import absolute_pose, joint_vectors, violations, within_limits
from models.rotations import geodesic_angle
from models.skeleton import ADULT
from tests.support.simulation import HIGHEST, LOWEST

TABLE = Kinematics(ADULT)


@cache
def takes() -> Capture:
    return builtin_capture().select(np.arange(0, len(builtin_capture()), 20))


@cache
def predicted_poses() -> np.ndarray:
    return blocked_predictions(lambda: PolynomialEncoder(2, 0.03), takes())


@cache
def error_covariance() -> np.ndarray:
    return robust_covariance(takes().relative - predicted_poses())


@cache
def first_guess() -> np.ndarray:
    return absolute_pose(predicted_poses(), takes().leftmost)


seeds = st.integers(0, 2**16)
fingers = st.lists(st.integers(0, 4), min_size=1, max_size=5, unique=True)


def touched(q: np.ndarray, down: list[int]) -> np.ndarray:
    """(T, 5, 2) touches under the fingertips of poses (T, 48), NaN for all other fingers."""
    xy = TABLE.tips(q)[..., :2] * [1, -1]
    xy[:, [f for f in range(5) if f not in down]] = np.nan
    return xy


def near_a_table(seed: int, frames: int = 4) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Poses (T, 48) in the middle of their ranges, predictions of them, the errors' covariance."""
    rng = np.random.default_rng(seed)
    q = LOWEST + rng.uniform(0.3, 0.7, (frames, 48)) * (HIGHEST - LOWEST)
    mixed = rng.normal(size=(48, 60)) * np.array([0.001] * 3 + [0.01] * 45)[:, None]
    covariance = mixed @ mixed.T / 60
    return q, q + rng.multivariate_normal(np.zeros(48), covariance, frames), covariance


def joint_angle(q: np.ndarray, truth: np.ndarray) -> float:
    """rad, mean angle of the joints from the captured ones."""
    return float(geodesic_angle(joint_vectors(q), joint_vectors(truth)).mean())


def wrist_distance(q: np.ndarray, truth: np.ndarray) -> float:
    return float(np.linalg.norm((q - truth)[:, :3], axis=1).mean())


@settings(max_examples=40)
@given(seed=seeds, down=fingers)
def test_with_the_right_bones_and_full_trust_the_tips_meet_the_touches(
    seed: int, down: list[int]
) -> None:
    q, guess, covariance = near_a_table(seed)
    # All tips of these fingers belong on the surface, so only one finger's height can be right.
    q[:, 2] += PAD_HEIGHT - TABLE.tips(q)[:, down[0], 2]
    guess[:, 2] += q[:, 2] - guess[:, 2]
    xy = touched(q, down[:1])
    full = PersonCorrection(ADULT, covariance, np.full(3, 1e-12))
    tips = TABLE.tips(full.correct(guess, xy))[:, down[0]]
    assert np.abs(tips[:, :2] * [1, -1] - xy[:, down[0]]).max() < 1e-5
    assert np.abs(tips[:, 2] - PAD_HEIGHT).max() < 1e-5


@given(seed=seeds, down=fingers)
def test_a_prediction_without_a_touch_or_with_right_tips_is_left_alone(
    seed: int, down: list[int]
) -> None:
    q, guess, covariance = near_a_table(seed)
    some = PersonCorrection(ADULT, covariance, np.full(3, 1e-6))
    unchanged = some.correct(guess, touched(q, []))
    np.testing.assert_allclose(unchanged, within_limits(guess, ADULT), atol=1e-12)
    q[:, 2] += PAD_HEIGHT - TABLE.tips(q)[:, down[0], 2]
    np.testing.assert_allclose(some.correct(q, touched(q, down[:1])), q, atol=1e-12)


@given(seed=seeds, down=fingers, distrust=st.sampled_from((1e9, 1e12, 1e15)))
def test_with_endless_distrust_the_prediction_stays_as_it_was(
    seed: int, down: list[int], distrust: float
) -> None:
    q, guess, covariance = near_a_table(seed)
    cautious = PersonCorrection(ADULT, covariance, distrust * np.full(3, 1e-4))
    np.testing.assert_allclose(
        cautious.correct(guess, touched(q, down)), within_limits(guess, ADULT), atol=1e-6
    )


@settings(max_examples=25)
@given(seed=seeds, frame=st.deferred(lambda: st.integers(0, len(takes()) - 1)))
@example(seed=148, frame=148)
def test_the_corrected_pose_is_the_likeliest_one(seed: int, frame: int) -> None:
    """A least-squares solver that goes on from there gains next to nothing."""
    q, xy, covariance = takes().q[frame], takes().xy[frame], 0.1 * error_covariance()
    variance = np.array([3e-7, 3e-7, 2e-7])
    guess = np.random.default_rng(seed).multivariate_normal(q, covariance)
    assume(violations(guess, ADULT) == 0)
    found = PersonCorrection(ADULT, covariance, variance).correct(guess[None], xy[None])[0]
    down = ~np.isnan(xy[:, 0])
    targets = np.array([[x, -y, PAD_HEIGHT] for x, y in xy[down]])
    # In units of the prediction's own errors every direction weighs alike.
    units = np.linalg.cholesky(covariance)

    def residuals(errors: np.ndarray) -> np.ndarray:
        off = TABLE.tips(guess + units @ errors)[down] - targets
        return np.concatenate([(off / np.sqrt(variance)).ravel(), errors])

    def jacobian(errors: np.ndarray) -> np.ndarray:
        turns = TABLE.tips_and_jacobian(guess + units @ errors)[1][down] @ units
        return np.concatenate([(turns / np.sqrt(variance)[:, None]).reshape(-1, 48), np.eye(48)])

    def cost(errors: np.ndarray) -> float:
        """Negative logarithm of the pose's density, given prediction and touches."""
        return float(0.5 * np.sum(residuals(errors) ** 2))

    reached = np.linalg.solve(units, found - guess)
    least = least_squares(residuals, reached, jacobian).cost
    assert cost(reached) - least < 1e-2 * (cost(np.zeros_like(reached)) - least)


@given(seed=seeds, down=fingers, shift=st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)))
def test_a_hand_elsewhere_on_the_surface_is_corrected_alike(
    seed: int, down: list[int], shift: tuple[float, float]
) -> None:
    q, guess, covariance = near_a_table(seed)
    some = PersonCorrection(ADULT, covariance, np.full(3, 1e-6))
    away = np.zeros(48)
    away[:2] = shift[0], -shift[1]
    np.testing.assert_allclose(
        some.correct(guess + away, touched(q, down) + shift),
        some.correct(guess, touched(q, down)) + away,
        atol=1e-9,
    )


@given(seed=seeds, down=fingers)
def test_many_frames_at_once_are_what_each_is_alone_wherever_lifted_fingers_are(
    seed: int, down: list[int]
) -> None:
    q, guess, covariance = near_a_table(seed)
    xy = touched(q, down)
    xy[1, down[0]] = np.nan
    some = PersonCorrection(ADULT, covariance, np.full(3, 1e-6))
    together = some.correct(guess, xy)
    alone = [some.correct(guess[i : i + 1], xy[i : i + 1])[0] for i in range(len(q))]
    np.testing.assert_allclose(together, alone, atol=1e-10)
    # Half a place is no place: the other half must not count.
    xy[np.isnan(xy[..., 0]), 1] = 7.0
    np.testing.assert_array_equal(some.correct(guess, xy), together)


@settings(max_examples=40)
@given(seed=seeds, down=fingers, far=st.floats(0.0, 0.2))
def test_joints_stay_within_their_ranges_wherever_the_touches_are(
    seed: int, down: list[int], far: float
) -> None:
    rng = np.random.default_rng(seed)
    q, guess, covariance = near_a_table(seed)
    xy = touched(q, down) + rng.normal(0, far, (len(q), 5, 2))
    given_guess, given_xy = guess.copy(), xy.copy()
    corrected = PersonCorrection(ADULT, covariance, np.full(3, 1e-9)).correct(guess, xy)
    assert np.isfinite(corrected).all() and (violations(corrected, ADULT) == 0).all()
    np.testing.assert_array_equal(guess, given_guess)
    np.testing.assert_array_equal(xy, given_xy)


@pytest.mark.parametrize("seed", range(3))
def test_bones_wrong_by_six_percent_are_fitted_and_new_poses_are_no_worse_than_before(
    seed: int,
) -> None:
    wrong = perturbed_skeleton(ADULT, np.random.default_rng(seed), 0.06, 0.004)
    new = takes().trial % 3 == 0
    correction = train_correction(
        takes().select(~new), predicted_poses()[~new], error_covariance(), wrong
    )
    truth, before = takes().q[new], first_guess()[new]
    corrected = correction.correct(before, takes().xy[new])
    assert joint_angle(corrected, truth) < joint_angle(before, truth)
    assert wrist_distance(corrected, truth) < wrist_distance(before, truth)
