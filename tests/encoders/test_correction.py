"""The correction puts fingertips on their touches, and does as little else as it can."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from benchmarks.pinch import GUESS_COVARIANCE
from encoders.correction import Corrected, FingertipCorrection
from models.kinematics import Kinematics
from models.pose import violations
from models.skeleton import ADULT
from tests.support.simulation import HIGHEST, LOWEST, random_pose

KINEMATICS = Kinematics(ADULT)
CORRECTION = FingertipCorrection(ADULT, GUESS_COVARIANCE)
SPREAD = np.sqrt(np.diag(GUESS_COVARIANCE))

generators = st.integers(0, 2**32 - 1).map(np.random.default_rng)
counts = st.integers(1, 5)


class Case:
    """A legal pose, where some of its fingertips are, and a guess that is some way off.

    Args:
        rng: Draws all of it.
        count: Fingers that touch.
        poor: How many of the standard deviations that the correction expects the guess is off.
    """

    def __init__(self, rng: np.random.Generator, count: int, poor: float = 0.5) -> None:
        self.q = random_pose(rng)
        self.labels = rng.permutation(5)[:count]
        self.targets = KINEMATICS.tips(self.q)[self.labels]
        self.guess = self.q + poor * SPREAD * rng.normal(size=48)

    def corrected(self, start: np.ndarray | None = None) -> Corrected:
        return CORRECTION.correct(self.guess, self.labels, self.targets, start)


def missed(q: np.ndarray, labels: np.ndarray, targets: np.ndarray) -> float:
    """m, farthest fingertip from its target."""
    return float(np.linalg.norm(KINEMATICS.tips(q)[labels] - targets, axis=1).max())


@given(rng=generators, count=counts)
@settings(max_examples=200)
def test_every_touching_fingertip_is_within_a_millimetre(
    rng: np.random.Generator, count: int
) -> None:
    case = Case(rng, count, poor=1.0)
    result = case.corrected()
    assert missed(result.q, case.labels, case.targets) < 0.001
    assert violations(result.q, ADULT) == 0


@given(rng=generators, count=counts, finger=st.integers(0, 4))
@settings(max_examples=50)
def test_a_guess_that_meets_its_touches_by_illegal_joints_is_not_taken_as_it_is(
    rng: np.random.Generator, count: int, finger: int
) -> None:
    case = Case(rng, count)
    last = max(i for i, bone in enumerate(ADULT.bones) if bone.finger == finger)
    case.q[6 + 3 * last] = ADULT.lower[3 * last] - 0.5
    targets = KINEMATICS.tips(case.q)[case.labels]
    result = CORRECTION.correct(case.q, case.labels, targets)
    assert violations(result.q, ADULT) == 0
    assert result.error == pytest.approx(missed(result.q, case.labels, targets), abs=1e-12)


@given(rng=generators, count=counts, poor=st.floats(0.0, 6.0), far=st.floats(0.0, 0.5))
@settings(max_examples=100)
def test_an_extreme_guess_or_touches_out_of_reach_never_give_an_illegal_pose_or_a_wrong_error(
    rng: np.random.Generator, count: int, poor: float, far: float
) -> None:
    case = Case(rng, count, poor)
    case.targets += far * rng.normal(size=(count, 3))
    result = case.corrected()
    assert violations(result.q, ADULT) == 0
    assert np.isfinite(result.q).all()
    assert result.error == pytest.approx(missed(result.q, case.labels, case.targets), abs=1e-12)
    assert 0 <= result.iterations <= CORRECTION.settings.iterations


@given(rng=generators, count=counts)
@settings(max_examples=50)
def test_a_guess_that_is_right_is_left_alone(rng: np.random.Generator, count: int) -> None:
    case = Case(rng, count, poor=0.0)
    result = case.corrected()
    np.testing.assert_array_equal(result.q, case.q)
    assert result.iterations == 0


@given(rng=generators, count=counts, shift=st.tuples(*[st.floats(-0.5, 0.5)] * 3))
@settings(max_examples=50)
def test_touches_and_guess_moved_alike_in_any_order_move_the_hand_and_nothing_else(
    rng: np.random.Generator, count: int, shift: tuple[float, float, float]
) -> None:
    case = Case(rng, count)
    order = rng.permutation(count)
    targets = case.targets[order] + np.array(shift)
    moved = np.concatenate([shift, np.zeros(45)])
    result = CORRECTION.correct(case.guess + moved, case.labels[order], targets)
    np.testing.assert_allclose(result.q, case.corrected().q + moved, atol=1e-8, rtol=0)


@given(rng=generators, count=counts)
@settings(max_examples=50)
def test_the_result_is_likelier_than_the_pose_that_touched(
    rng: np.random.Generator, count: int
) -> None:
    # That pose meets the touches too, so it was there to be found.
    case = Case(rng, count)
    distance = np.linalg.norm((case.corrected().q - case.guess) / SPREAD)
    assert distance <= np.linalg.norm((case.q - case.guess) / SPREAD)


@given(rng=generators, finger=st.integers(0, 4))
@settings(max_examples=50)
def test_fingers_that_do_not_touch_keep_their_legal_posture(
    rng: np.random.Generator, finger: int
) -> None:
    case = Case(rng, 1)
    result = CORRECTION.correct(case.guess, [finger], KINEMATICS.tips(case.q)[[finger]])
    legal = np.clip(case.guess[6:], ADULT.lower, ADULT.upper).reshape(14, 3)
    others = [i for i, bone in enumerate(ADULT.bones) if bone.finger != finger]
    np.testing.assert_allclose(result.q[6:].reshape(14, 3)[others], legal[others], atol=1e-9)


@given(rng=generators, count=counts)
@settings(max_examples=30)
def test_fingers_that_rest_bring_the_hand_to_rest_wherever_it_came_from(
    rng: np.random.Generator, count: int
) -> None:
    case = Case(rng, count, poor=0.4)
    ends = []
    for start in (case.q, np.clip(case.q + 0.1 * SPREAD * rng.normal(size=48), LOWEST, HIGHEST)):
        q = start
        for _ in range(12):
            before, q = q, case.corrected(start=q).q
        assert np.abs(q - before).max() < 1e-3
        ends.append(q)
    np.testing.assert_allclose(ends[1], ends[0], atol=1e-3, rtol=0)
