"""The fit of our bones to landmarks: it gives back poses, and keeps to what is possible."""

from __future__ import annotations

from dataclasses import replace
from math import degrees

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.air.camera import Camera
from encoders.air.landmark_fit import FitSettings, HandPoints, LandmarkFit
from models.arithmetic import Array
from models.pose import ROOT_POSITION, ROOT_ROTATION, violations
from models.rotations import exp, log
from models.single_pose import SinglePose
from models.skeleton import ADULT
from tests.encoders.air.seen_hands import SIZE, held_up, seen

CAMERA = Camera()
MIDDLE_JOINTS = [6 + 3 * i for i in (3, 6, 9, 12)]
TURN = st.floats(-0.5, 0.5)


def looked_at(q: Array, fit: LandmarkFit, size: float = 1.0) -> tuple[Array, float]:
    """Pose and error after a few pictures of a hand that is held still."""
    hand = seen(q, CAMERA, skeleton=ADULT.scaled(size))
    rays, world = CAMERA.rays(np.array(hand.image), SIZE), np.array(hand.world)
    found = fit.fit(rays, world, 0.0)
    for _ in range(10):
        found = fit.fit(rays, world, 1 / 30)
    return found.pose, found.error


@given(st.floats(0.0, 80.0), TURN, TURN, TURN, st.floats(0.35, 0.7))
@settings(max_examples=40)
def test_the_fitted_hand_is_seen_where_the_landmarks_are(
    bend: float, roll: float, pitch: float, yaw: float, away: float
) -> None:
    _, error = looked_at(held_up(bend, (pitch, yaw, roll), away), LandmarkFit(ADULT))
    assert error < 0.004


def test_landmarks_of_our_own_hand_give_its_pose_back() -> None:
    rng = np.random.default_rng(7)
    points = HandPoints(ADULT)
    bent, off = [], []
    for _ in range(60):
        roll, pitch, yaw = rng.uniform(-0.5, 0.5, 3)
        q = held_up(rng.uniform(5.0, 80.0), (pitch, yaw, roll), rng.uniform(0.35, 0.6))
        found, _ = looked_at(q, LandmarkFit(ADULT))
        bent += np.degrees(np.abs(found[MIDDLE_JOINTS] - q[MIDDLE_JOINTS])).tolist()
        off += np.linalg.norm(points.points(found) - points.points(q), axis=1).tolist()
    assert np.median(bent) < 5.0 and np.quantile(bent, 0.95) < 15.0
    assert np.median(off) < 0.005 and np.quantile(off, 0.95) < 0.02


@given(st.floats(0.7, 1.4))
@settings(max_examples=15)
def test_a_larger_hand_is_the_same_hand_farther_away(size: float) -> None:
    q = held_up(30.0, (0.2, 0.3, 0.0))
    scaled = q.copy()
    scaled[ROOT_POSITION] *= size
    plain = FitSettings()
    larger = replace(
        plain,
        **{n: size * getattr(plain, n) for n in ("picture", "loose", "depth", "linear", "toward")},
    )
    one, _ = looked_at(q, LandmarkFit(ADULT))
    other, _ = looked_at(scaled, LandmarkFit(ADULT.scaled(size), larger), size)
    assert other[ROOT_POSITION] == pytest.approx(size * one[ROOT_POSITION], abs=1e-3)
    assert other[3:] == pytest.approx(one[3:], abs=0.01)


@given(st.integers(0, 2**32 - 1), st.floats(0.0, 0.3))
@settings(max_examples=40)
def test_no_landmarks_bend_a_joint_beyond_its_range(seed: int, noise: float) -> None:
    rng = np.random.default_rng(seed)
    hand = seen(held_up(40.0), CAMERA)
    rays = CAMERA.rays(np.array(hand.image), SIZE)
    fit = LandmarkFit(ADULT)
    for _ in range(4):
        wrong = rays + noise * rng.standard_normal(rays.shape)
        world = np.array(hand.world) + noise * rng.standard_normal((21, 3))
        found = fit.fit(wrong, world, 1 / 30)
        assert np.isfinite(found.pose).all()
        assert violations(found.pose, ADULT) == 0
        assert found.pose[2] > 0.0


def test_landmarks_that_are_one_point_raise_nothing() -> None:
    fit = LandmarkFit(ADULT)
    found = fit.fit(np.zeros((21, 2)), np.zeros((21, 3)), 0.0)
    assert np.isfinite(found.pose).all()


def pinching() -> Array:
    """(48,) pose in the camera's frame whose thumb bends as it does around a box of 5 cm."""
    q = held_up(25.0, (0.5, 0.2, 0.1))
    q[6], q[9] = np.radians([38.0, -48.0])
    return q


def test_a_pinching_thumb_is_followed_by_steps_that_move_nothing_else() -> None:
    q, points = pinching(), HandPoints(ADULT)
    poses, off = [], []
    for steps in (0, FitSettings().thumb_steps):
        found, _ = looked_at(q, LandmarkFit(ADULT, FitSettings(thumb_steps=steps)))
        poses.append(found)
        off.append(float(np.linalg.norm((points.points(found) - points.points(q))[15])))
    assert off[1] < 0.75 * off[0]
    assert np.delete(poses[1] - poses[0], np.s_[6:12]) == pytest.approx(0.0, abs=1e-12)


def test_a_hand_that_jumps_is_found_again() -> None:
    fit = LandmarkFit(ADULT)
    looked_at(held_up(20.0), fit)
    turned = held_up(20.0, (0.0, 0.0, 2.5), 0.6)
    found, error = looked_at(turned, fit)
    assert error < 0.004
    relative = log(exp(found[ROOT_ROTATION]).T @ exp(turned[ROOT_ROTATION]))
    assert degrees(float(np.linalg.norm(relative))) < 15.0


def test_the_derivative_of_joints_and_tips_is_that_of_finite_differences() -> None:
    rng = np.random.default_rng(3)
    q = 0.4 * rng.standard_normal(48)
    pose = SinglePose(ADULT)
    points, jacobian = pose.joints_and_jacobian(q)
    assert points == pytest.approx(np.concatenate(pose.joints_and_tips(q)))
    step = 1e-6
    for i in range(48):
        moved = []
        for sign in (1.0, -1.0):
            at = q.copy()
            if ROOT_ROTATION.start <= i < ROOT_ROTATION.stop:
                turn = np.zeros(3)
                turn[i - ROOT_ROTATION.start] = sign * step
                at[ROOT_ROTATION] = log(exp(q[ROOT_ROTATION]) @ exp(turn))
            else:
                at[i] += sign * step
            moved.append(np.concatenate(pose.joints_and_tips(at)))
        slope = (moved[0] - moved[1]) / (2.0 * step)
        assert jacobian[:, :, i] == pytest.approx(slope, abs=1e-8)
