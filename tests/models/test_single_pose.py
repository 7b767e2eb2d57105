"""What the loop computes for one moment is what the functions for many moments compute."""

from __future__ import annotations

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from encoders.correction import CorrectionSettings, FingertipCorrection
from encoders.labels.belief import builtin_population_belief
from encoders.reconstruction.hand_motion import common_motion, rigid_motion
from models.arithmetic import Array
from models.kinematics import Kinematics
from models.rotations import (
    exp,
    log,
    turn_about_normal,
    turned_about_normal,
    unwrap_near,
    unwrapped,
)
from models.single_pose import SinglePose, tips_and_jacobians
from models.skeleton import ADULT
from tests.support.simulation import random_pose

generators = st.integers(0, 2**32 - 1).map(np.random.default_rng)
vectors = hnp.arrays(float, 3, elements=st.floats(-4, 4))
angles = st.floats(-3.0, 3.0)
places = st.lists(
    st.tuples(st.floats(0.0, 0.2), st.floats(0.0, 0.15)), min_size=0, max_size=5, unique=True
)


@given(rng=generators, size=st.sampled_from([0.0, 1e-12, 1e-7, 1e-3, 0.3, 2.0]))
def test_one_pose_has_the_fingertips_and_jacobian_of_many(
    rng: np.random.Generator, size: float
) -> None:
    q = size * rng.normal(size=48)
    for skeleton in (ADULT, ADULT.scaled(1.2), ADULT.mirrored()):
        tips, jacobian = Kinematics(skeleton).tips_and_jacobian(q)
        one = SinglePose(skeleton)
        found = one.tips_and_jacobian(q)
        np.testing.assert_allclose(found[0], tips, atol=1e-13, rtol=0)
        np.testing.assert_allclose(found[1], jacobian, atol=1e-13, rtol=0)
        np.testing.assert_array_equal(one.tips(q), found[0])


@given(rng=generators, fingers=st.lists(st.integers(0, 4), min_size=1, unique=True))
def test_a_finger_is_where_it_is_whoever_else_is_asked_for(
    rng: np.random.Generator, fingers: list[int]
) -> None:
    q = random_pose(rng)
    for found, part in zip(
        SinglePose(ADULT).tips_and_jacobian(q),
        SinglePose(ADULT, fingers).tips_and_jacobian(q),
        strict=True,
    ):
        np.testing.assert_array_equal(part, found[fingers])


@given(
    rng=generators,
    size=st.sampled_from([0.0, 1e-12, 1e-3, 0.3, 2.0]),
    count=st.integers(1, 40),
    fingers=st.lists(st.integers(0, 4), min_size=1, unique=True),
)
@settings(deadline=None)
def test_several_poses_are_found_to_the_bit_as_each_alone(
    rng: np.random.Generator, size: float, count: int, fingers: list[int]
) -> None:
    q = size * rng.normal(size=(count, 48))
    one = SinglePose(ADULT, fingers)
    together = tips_and_jacobians(one, q)
    for i in range(count):
        for alone, all_of_them in zip(one.tips_and_jacobian(q[i]), together, strict=True):
            np.testing.assert_array_equal(alone, all_of_them[i])


@given(w=vectors, turn=angles)
def test_a_turn_about_the_normal_is_a_product_of_rotations(w: Array, turn: float) -> None:
    whole = exp([0.0, 0.0, turn]) @ exp(w)
    np.testing.assert_allclose(exp(turned_about_normal(w, turn)), whole, atol=1e-12)
    assert np.linalg.norm(turned_about_normal(w, turn)) <= np.pi + 1e-12


@given(w=vectors, turn=angles)
def test_the_turn_about_the_normal_follows_the_hand(w: Array, turn: float) -> None:
    # A hand that lies on its side has no such turn.
    R = exp(w)
    assume(np.hypot(R[1, 0] - R[0, 1], R[0, 0] + R[1, 1]) > 1e-3)
    before, after = turn_about_normal(w), turn_about_normal(log(exp([0, 0, turn]) @ R))
    np.testing.assert_allclose(np.exp(1j * (after - before)), np.exp(1j * turn), atol=1e-8)


@given(w=vectors, reference=vectors)
def test_one_vector_is_unwrapped_as_many_are(w: Array, reference: Array) -> None:
    # Halfway between two turns either is as near.
    t = np.linalg.norm(w)
    assume(t < 1e-6 or abs(((reference - w) @ w / t / (2 * np.pi)) % 1 - 0.5) > 1e-6)
    np.testing.assert_allclose(unwrapped(w, reference), unwrap_near(w, reference), atol=1e-9)


@given(before=places, rng=generators)
def test_touches_move_together_as_points_do(
    before: list[tuple[float, float]], rng: np.random.Generator
) -> None:
    after = [
        (x + dx, y + dy)
        for (x, y), (dx, dy) in zip(before, 0.01 * rng.normal(size=(len(before), 2)), strict=True)
    ]
    found = common_motion(before, after)
    wanted = rigid_motion(np.reshape(before, (-1, 2)), np.reshape(after, (-1, 2)))
    np.testing.assert_allclose(found.carried, wanted.carried, atol=1e-12)
    np.testing.assert_allclose(found.about, wanted.about, atol=1e-12)
    spread = np.ptp(np.reshape(before, (-1, 2)), axis=0).max() if before else 0.0
    if spread > 1e-3:
        np.testing.assert_allclose(found.turn, wanted.turn, atol=1e-6)


@given(rng=generators, count=st.integers(2, 5))
@settings(max_examples=30, deadline=None)
def test_a_correction_that_carries_its_last_pose_corrects_as_a_new_one(
    rng: np.random.Generator, count: int
) -> None:
    kinematics, covariance = Kinematics(ADULT), 0.01 * np.eye(48)
    used, q = FingertipCorrection(kinematics.skeleton, covariance), random_pose(rng)
    labels = rng.permutation(5)[:count]
    targets = kinematics.tips(q)[labels]
    for _ in range(3):
        shift = 0.005 * rng.normal(size=3)
        targets = targets + shift + 0.0005 * rng.normal(size=targets.shape)
        start = q + np.r_[shift, np.zeros(45)]
        fresh = FingertipCorrection(kinematics.skeleton, covariance, CorrectionSettings())
        wanted = fresh.correct(q, labels, targets, start)
        found = used.correct(q, labels, targets, start)
        np.testing.assert_allclose(found.q, wanted.q, atol=1e-9, rtol=0)
        q = found.q


@given(rng=generators, count=st.integers(1, 5))
@settings(max_examples=20, deadline=None)
def test_a_belief_that_has_nothing_new_to_look_at_says_what_a_look_would_have_said(
    rng: np.random.Generator, count: int
) -> None:
    quick, slow = builtin_population_belief(), builtin_population_belief()
    xy = np.array([0.05, 0.05]) + 0.03 * rng.normal(size=(count, 2))
    for _ in range(12):
        xy = xy + 0.002 * rng.normal(size=xy.shape)
        contacts = {i: (float(x), float(y)) for i, (x, y) in enumerate(xy)}
        slow._answered = None
        assert quick.assign(contacts, {}) == slow.assign(contacts, {})
    fixed = {0: int(rng.integers(5))}
    slow._answered = None
    assert quick.assign(contacts, fixed) == slow.assign(contacts, fixed)
