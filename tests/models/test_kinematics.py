"""The hand's kinematics: rotations, fingertips and their derivative, and the mirror."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp
from scipy.spatial.transform import Rotation

from models.arithmetic import Array
from models.kinematics import Kinematics
from models.pose import (
    JOINTS,
    absolute_pose,
    blend,
    relative_pose,
    violations,
    within_limits,
)
from models.rotations import (
    exp,
    geodesic_angle,
    log,
    matrix_to_quaternion,
    quaternion_exp,
    quaternion_log,
    quaternion_to_matrix,
    unwrap_near,
)
from models.skeleton import ADULT
from models.surface import Surface
from tests.support.simulation import legal_poses

HAND = Kinematics(ADULT)

vectors = hnp.arrays(float, 3, elements=st.floats(-10, 10))
turns = vectors.filter(lambda w: np.linalg.norm(w) > 1e-3).flatmap(
    lambda w: st.floats(0, np.pi - 1e-3).map(lambda a: a * w / np.linalg.norm(w))
)


@given(w=vectors, other=turns)
def test_rotations_are_those_of_another_library(w: Array, other: Array) -> None:
    theirs, its = Rotation.from_rotvec(w), Rotation.from_rotvec(other)
    np.testing.assert_allclose(log(its.as_matrix()), other, atol=1e-9)
    np.testing.assert_allclose(quaternion_log(quaternion_exp(other)), other, atol=1e-12)
    assert abs(geodesic_angle(w, other) - (theirs.inv() * its).magnitude()) < 1e-7
    np.testing.assert_allclose(exp(w), theirs.as_matrix(), atol=1e-12)
    np.testing.assert_allclose(exp(log(exp(w))), theirs.as_matrix(), atol=1e-12)
    np.testing.assert_allclose(quaternion_to_matrix(quaternion_exp(w)), exp(w), atol=1e-12)
    np.testing.assert_allclose(
        matrix_to_quaternion(exp(w)), np.roll(theirs.as_quat(canonical=True), 1), atol=1e-9
    )


@pytest.mark.parametrize("size", (0.0, 1e-12, 1e-9, 1e-7, 1e-6, 1e-5, np.pi - 1e-9, np.pi))
@pytest.mark.parametrize("axis", ((1, 0, 0), (0, 1, 0), (0, 0, -1), (0.6, -0.64, 0.48)))
def test_tiny_and_half_turns_are_exact_too(size: float, axis: tuple[float, float, float]) -> None:
    w = size * np.array(axis)
    np.testing.assert_allclose(exp(w), Rotation.from_rotvec(w).as_matrix(), atol=1e-15)
    back = log(exp(w))
    assert min(np.abs(back - w).max(), np.abs(back + w).max() if size > 3 else np.inf) < 1e-9


@given(w=turns, reference=vectors)
def test_unwrapping_keeps_the_rotation_and_comes_nearer(w: Array, reference: Array) -> None:
    near = unwrap_near(w, reference)
    np.testing.assert_allclose(exp(near), exp(w), atol=1e-9)
    assert np.linalg.norm(near - reference) <= np.linalg.norm(w - reference) + 1e-9


@settings(max_examples=30)
@given(q=legal_poses)
def test_jacobian_is_the_derivative_of_the_fingertips(q: Array) -> None:
    h = 1e-6
    steps = h * np.eye(48)
    slope = (HAND.tips(q + steps) - HAND.tips(q - steps)) / (2 * h)
    tips, jacobian = HAND.tips_and_jacobian(q)
    np.testing.assert_allclose(tips, HAND.tips(q), atol=1e-15)
    np.testing.assert_allclose(jacobian, np.moveaxis(slope, 0, -1), atol=1e-8)


@given(shapes=st.sampled_from(((), (3,), (2, 3), (0,))), seed=st.integers(0, 99))
def test_a_batch_is_its_poses_one_by_one(shapes: tuple[int, ...], seed: int) -> None:
    q = np.random.default_rng(seed).normal(size=(*shapes, 48)) * 0.3
    tips, jacobian = HAND.tips_and_jacobian(q)
    assert tips.shape == (*shapes, 5, 3) and jacobian.shape == (*shapes, 5, 3, 48)
    for index in np.ndindex(*shapes):
        one, slope = HAND.tips_and_jacobian(q[index])
        np.testing.assert_allclose(tips[index], one, atol=1e-14)
        np.testing.assert_allclose(jacobian[index], slope, atol=1e-14)


@given(q=legal_poses, factor=st.floats(0.5, 2.0))
def test_a_larger_hand_reaches_further_by_its_factor(q: Array, factor: float) -> None:
    q[:3] = 0
    np.testing.assert_allclose(
        Kinematics(ADULT.scaled(factor)).tips(q), factor * HAND.tips(q), atol=1e-12
    )


@pytest.mark.parametrize("bone", [i for i, b in enumerate(ADULT.bones) if b.finger > 0])
def test_a_negative_turn_about_x_flexes_a_finger(bone: int) -> None:
    q = np.zeros(48)
    q[6 + 3 * bone] = -0.3
    finger = ADULT.bones[bone].finger
    wrist_to_tip = np.linalg.norm([HAND.tips(p)[finger] for p in (np.zeros(48), q)], axis=1)
    assert wrist_to_tip[1] < wrist_to_tip[0]


@given(q=hnp.arrays(float, 48, elements=st.floats(-4, 4)))
def test_clamped_poses_are_legal_and_legal_poses_stay(q: Array) -> None:
    clamped = within_limits(q, ADULT)
    assert violations(clamped, ADULT) == 0
    np.testing.assert_array_equal(within_limits(clamped, ADULT), clamped)
    np.testing.assert_array_equal(clamped[:6], q[:6])
    outside = (q[JOINTS] < ADULT.lower - 1e-9) | (q[JOINTS] > ADULT.upper + 1e-9)
    assert violations(q, ADULT) == outside.sum()


@given(q=legal_poses, contact=st.tuples(st.floats(0, 0.2), st.floats(0, 0.15)))
def test_relative_and_absolute_poses_undo_each_other(
    q: Array, contact: tuple[float, float]
) -> None:
    relative = relative_pose(q, contact)
    np.testing.assert_allclose(absolute_pose(relative, contact), q, atol=1e-15)
    # The contact is at (x, -y, 0) of the surface; relative to it, it is at the origin.
    np.testing.assert_allclose(relative[:3], q[:3] - [contact[0], -contact[1], 0], atol=1e-15)


@given(q=legal_poses, tilt=turns, x=st.floats(-1, 1))
def test_a_pose_in_the_world_touches_what_it_touches_on_the_surface(
    q: Array, tilt: Array, x: float
) -> None:
    surface = Surface(origin=(x, 0.2, 0.7), rotation=exp(tilt))
    world = surface.pose_to_world(q)
    expected = HAND.tips(q) @ surface.rotation.T + np.array(surface.origin)
    np.testing.assert_allclose(HAND.tips(world), expected, atol=1e-8)


@given(a=legal_poses, b=legal_poses)
def test_a_blend_starts_and_ends_where_it_should(a: Array, b: Array) -> None:
    np.testing.assert_allclose(blend(a, b, 0.0), a, atol=1e-15)
    np.testing.assert_allclose(HAND.tips(blend(a, b, 1.0)), HAND.tips(b), atol=1e-9)
