"""Errors of estimated poses relative to captured poses, frame by frame (the paper's Table 1, and
further measures).

All poses are in the 3-D surface frame, not relative to a contact. Estimates from true and from
wrong labels are therefore compared in the same frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from encoders.capture import Capture
from encoders.correction import PAD_HEIGHT
from models.arithmetic import Array
from models.kinematics import Kinematics
from models.pose import JOINTS, ROOT_POSITION, ROOT_ROTATION, joint_vectors, violations
from models.rotations import geodesic_angle
from models.skeleton import ADULT

LIMIT_TOLERANCE = 1e-6
"""Tolerance (rad) at the end of a joint's range, for rounding to single precision."""

_KINEMATICS = Kinematics(ADULT)


@dataclass(frozen=True)
class PoseErrors:
    """Errors of T poses.

    Attributes:
        wrist: (T,) cm, distance between true and estimated wrist.
        joints: (T, 14) degrees, angle of the rotation between true and estimated ball joint.
        components: (T, 42) degrees, absolute difference of every rotation-vector component.
        turn: (T,) degrees, angle of the rotation between true and estimated wrist.
    """

    wrist: Array
    joints: Array
    components: Array
    turn: Array

    @cached_property
    def angle(self) -> Array:
        """Mean (T,) over the ball joints, degrees."""
        return self.joints.mean(axis=1)

    @cached_property
    def component(self) -> Array:
        """Mean (T,) over the components, degrees."""
        return self.components.mean(axis=1)


def pose_errors(estimate: Array, truth: Array) -> PoseErrors:
    """Errors of estimated poses (T, 48) relative to captured poses (T, 48)."""
    off = estimate - truth
    return PoseErrors(
        100.0 * np.linalg.norm(off[:, ROOT_POSITION], axis=1),
        np.rad2deg(geodesic_angle(joint_vectors(estimate), joint_vectors(truth))),
        np.rad2deg(np.abs(off[:, JOINTS])),
        np.rad2deg(geodesic_angle(estimate[:, ROOT_ROTATION], truth[:, ROOT_ROTATION])),
    )


def tip_errors(q: Array, xy: Array) -> Array:
    """Distances (contacts,) in cm of the fingertips of our hand model from their touches.

    The centre of a touching fingertip belongs 6 mm above its touch.

    Args:
        q: (T, 48) poses.
        xy: (T, 5, 2) m, touches by label, NaN where lifted.
    """
    down = ~np.isnan(xy[..., 0])
    tips = _KINEMATICS.tips(q)[down]
    touches = xy[down]
    places = np.column_stack([touches[:, 0], -touches[:, 1], np.full(len(touches), PAD_HEIGHT)])
    return 100.0 * np.linalg.norm(tips - places, axis=1)


def limit_share(q: Array) -> float:
    """Share, 0 to 1, of the joint components of poses (T, 48) that are outside our hand's
    ranges."""
    outside = violations(q, ADULT, LIMIT_TOLERANCE)
    return float(outside.mean() / (JOINTS.stop - JOINTS.start))


def variance_shares(vectors: Array, counts: tuple[int, ...]) -> dict[int, float]:
    """Percentage of the variance of vectors (T, n) that their first k principal components explain,
    by k."""
    values = np.linalg.eigvalsh(np.cov(vectors, rowvar=False))[::-1]
    return {k: float(100.0 * values[:k].sum() / values.sum()) for k in counts}


_GAP = 1.5
"""Frames farther apart than this number of median periods do not count as consecutive."""


@dataclass(frozen=True)
class Smoothness:
    """Changes of poses between frames. An array is empty if a capture has no such frames.

    Attributes:
        acceleration: (n,) degrees/s2, mean absolute second difference of the 42 joint components,
            for every three frames in a row with the same contacts.
        jump: (m,) degrees, mean absolute change of the 42 joint components between two frames with
            different contacts.
        largest_joint: (m,) degrees, largest rotation of a joint between these frames.
        wrist_jump: (m,) cm, movement of the wrist between these frames.
    """

    acceleration: Array
    jump: Array
    largest_joint: Array
    wrist_jump: Array


def smoothness(q: Array, capture: Capture) -> Smoothness:
    """Smoothness of poses (T, 48); the capture gives the time, take and contacts of every pose."""
    joints = np.rad2deg(q[:, JOINTS])
    steps = np.diff(capture.time)
    follows = np.diff(capture.trial) == 0
    period = float(np.median(steps[follows])) if follows.any() else np.inf
    follows &= (steps > 0) & (steps < _GAP * period)
    same = (capture.ids[1:] == capture.ids[:-1]).all(axis=1)

    steady = follows & same
    triple = steady[1:] & steady[:-1]
    second = (joints[2:] - 2.0 * joints[1:-1] + joints[:-2])[triple] / period**2

    changed = np.flatnonzero(follows & ~same)
    before, after = q[changed], q[changed + 1]
    turned = np.rad2deg(geodesic_angle(joint_vectors(before), joint_vectors(after)))
    return Smoothness(
        np.abs(second).mean(axis=1),
        np.abs(joints[changed + 1] - joints[changed]).mean(axis=1),
        turned.max(axis=1),
        100.0 * np.linalg.norm((after - before)[:, :3], axis=1),
    )


def joined(parts: list[Smoothness]) -> Smoothness:
    """Combines the smoothness of several captures."""
    return Smoothness(
        np.concatenate([p.acceleration for p in parts]),
        np.concatenate([p.jump for p in parts]),
        np.concatenate([p.largest_joint for p in parts]),
        np.concatenate([p.wrist_jump for p in parts]),
    )
