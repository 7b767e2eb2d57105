"""Poses from joints: the forward model's joints give the pose back."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from encoders.air.joint_fit import (
    KNUCKLES,
    PALM,
    TIPS,
    JointFit,
    JointsFitted,
    seen_size,
)
from models.arithmetic import Array
from models.pose import JOINTS, ROOT_POSITION, ROOT_ROTATION, violations
from models.rotations import geodesic_angle
from models.skeleton import ADULT
from tests.encoders.air.joint_hands import any_pose, points, seen

OF_FINGERS = np.array([3 * i for i, bone in enumerate(ADULT.bones) if bone.finger > 0])
"""Flexions of the fingers, among the joints' components."""


@cache
def fit_of_adult() -> JointFit:
    return JointFit(ADULT)


def fitted(seen_at: Array) -> JointsFitted:
    found = fit_of_adult().fit(seen_at)
    assert found is not None
    return found


def test_joints_of_any_pose_give_the_pose_back() -> None:
    rng = np.random.default_rng(1)
    off, turned = [], []
    for _ in range(100):
        q = any_pose(rng)
        found = fitted(points(q))
        off.append(np.degrees(np.abs((found.pose - q)[JOINTS][6:])))
        turned.append(float(np.degrees(geodesic_angle(found.pose[3:6], q[3:6]))))
        assert found.pose[ROOT_POSITION] == pytest.approx(q[ROOT_POSITION], abs=0.004)
        assert found.error < 1e-4
    assert np.mean(off) < 0.3 and np.max(off) < 5.0
    assert np.max(turned) < 4.0


def test_the_same_joints_give_the_same_bits() -> None:
    seen_at = points(any_pose(np.random.default_rng(2)))
    again = JointFit(ADULT)
    again.fit(points(any_pose(np.random.default_rng(3))))
    found = again.fit(seen_at)
    assert found is not None and found.pose.tobytes() == fitted(seen_at).pose.tobytes()


@pytest.mark.parametrize("size", [0.8, 1.2])
def test_tips_of_a_hand_of_another_size_are_where_the_person_s_are(size: float) -> None:
    rng = np.random.default_rng(4)
    errors = []
    for _ in range(20):
        q = any_pose(rng)
        q[JOINTS] *= 0.5
        errors.append(fitted(points(q, ADULT.scaled(size))).error)
    assert np.median(errors) < 0.003


def test_no_joint_leaves_its_range_wherever_its_points_are() -> None:
    rng = np.random.default_rng(6)
    for _ in range(20):
        at = points(any_pose(rng))
        at[3:] += rng.normal(0.0, 0.02, (17, 3))
        assert violations(fitted(at).pose, ADULT) == 0


def test_a_missing_finger_stays_at_rest_and_the_others_are_as_before() -> None:
    q = any_pose(np.random.default_rng(7))
    at = points(q)
    whole = fitted(at).pose
    at[[KNUCKLES[0], KNUCKLES[0] + 1, KNUCKLES[0] + 2, TIPS + 1]] = np.nan
    found = fitted(at)
    assert np.isfinite(found.pose).all()
    assert found.pose[JOINTS][6:15] == pytest.approx(np.zeros(9), abs=1e-6)
    assert np.degrees(found.pose - whole)[JOINTS][OF_FINGERS[3:]] == pytest.approx(0.0, abs=3.0)


@pytest.mark.parametrize("missing", [[PALM[0]], list(KNUCKLES[:2])])
def test_without_a_palm_there_is_no_pose(missing: list[int]) -> None:
    at = points(any_pose(np.random.default_rng(8)))
    at[missing] = np.nan
    assert fit_of_adult().fit(at) is None


@pytest.mark.parametrize("size", [0.9, 1.0, 1.15])
def test_the_size_of_a_hand_is_that_of_its_bones(size: float) -> None:
    q = any_pose(np.random.default_rng(10))
    assert seen_size(seen(points(q, ADULT.scaled(size))), ADULT) == pytest.approx(size)


def test_the_palm_is_laid_on_the_knuckles_of_a_longer_palm() -> None:
    q = any_pose(np.random.default_rng(11))
    q[JOINTS] = 0.0
    at = points(q)
    at[0] += 0.1 * (at[0] - at[list(KNUCKLES)].mean(axis=0))
    found = fitted(at).pose
    assert points(found)[TIPS:] == pytest.approx(at[TIPS:], abs=0.001)
    assert np.degrees(geodesic_angle(found[ROOT_ROTATION], q[ROOT_ROTATION])) < 3.0
