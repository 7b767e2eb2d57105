"""The null-space variant leaves fingertips alone; the likeliest pose is the likeliest."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.regression.regularised_ik import MapIkEncoder, NullSpaceIkEncoder, null_space_part
from encoders.regression.trained import builtin_capture
from tests.encoders.regression.ik_frames import KINEMATICS, pca, poses, row, targets_of, touches
from tests.support.simulation import random_pose


def test_the_null_space_variant_ends_with_fingertips_met() -> None:
    # Many frames: unpaced steps went to and fro on some of them, and on most did not.
    many = builtin_capture().u[7::120]
    assert NullSpaceIkEncoder().fit(touches(), poses()).solve(many).residual.max() < 1e-4


@given(seed=st.integers(0, 2**32 - 1), contacts=st.integers(1, 5))
@settings(max_examples=25, deadline=None)
def test_what_is_projected_into_the_null_space_leaves_fingertips_to_first_order(
    seed: int, contacts: int
) -> None:
    rng = np.random.default_rng(seed)
    q, fingers = random_pose(rng), rng.permutation(5)[:contacts]
    _, jacobian = KINEMATICS.tips_and_jacobian(q)
    J = jacobian[fingers].reshape(1, -1, 48)
    cost = rng.uniform(0.1, 10, 48)
    wish = rng.normal(0, 1, (1, 48))
    left = null_space_part(wish, J, cost)
    h = 1e-5
    moved = (KINEMATICS.tips(q + h * left[0]) - KINEMATICS.tips(q - h * left[0])) / (2 * h)
    np.testing.assert_allclose(moved[fingers], 0.0, atol=1e-7)
    # Twice is once, and nothing that leaves them already is taken away.
    np.testing.assert_allclose(null_space_part(left, J, cost), left, atol=1e-9)
    # What was taken away is the cheapest that does: orthogonal, in its costs, to what is left.
    assert abs(np.sum((wish - left) * cost * left)) < 1e-8


def test_the_wish_changes_no_fingertip_to_first_order_in_a_step() -> None:
    q = pca().predict(row(0, 1, 3))[None]
    _, jacobian = KINEMATICS.tips_and_jacobian(q)
    J = jacobian[:, [0, 1, 3]].reshape(1, 9, 48)
    off = np.full((1, 9), 0.002)
    plain, wishing = (
        NullSpaceIkEncoder(gain=0).fit(touches(), poses()),
        NullSpaceIkEncoder(gain=1).fit(touches(), poses()),
    )
    difference = wishing._step(q, poses()[:1], off, J) - plain._step(q, poses()[:1], off, J)
    assert np.abs(difference).max() > 0.01
    np.testing.assert_allclose(J @ difference[0], 0.0, atol=1e-12)


def test_the_null_space_variant_ends_as_near_to_its_wish_as_fingertips_let_it() -> None:
    encoder = NullSpaceIkEncoder(settled=1e-10, iterations=300).fit(touches(), poses())
    contacts = row(0, 1, 2)
    q = encoder.predict(contacts)[None]
    _, jacobian = KINEMATICS.tips_and_jacobian(q)
    J = jacobian[:, :3].reshape(1, 9, 48)
    cost = np.full(48, 25e-4)
    cost[:3] = 0.1
    np.testing.assert_allclose(null_space_part(encoder.mean_ - q, J, cost), 0.0, atol=1e-5)


def test_the_most_likely_pose_is_a_local_maximum_of_the_posterior() -> None:
    encoder = MapIkEncoder(tip_sigma=0.002).fit(touches(), poses())
    contacts = row(0, 1, 2, 4)
    q = encoder.predict(contacts)
    goal = targets_of(contacts[None], encoder.pad_height_)[0][[0, 1, 2, 4]]

    def unlikeliness(pose: np.ndarray) -> float:
        away, off = pose - encoder.mean_, KINEMATICS.tips(pose)[[0, 1, 2, 4]] - goal
        return float(away @ np.linalg.solve(encoder.covariance_, away) + np.sum(off**2) / 0.002**2)

    best = unlikeliness(q)
    rng = np.random.default_rng(0)
    spread = np.linalg.cholesky(encoder.covariance_)
    for size in (1e-3, 1e-2, 1e-1):
        for _ in range(20):
            assert unlikeliness(q + size * spread @ rng.normal(size=48)) > best
