"""Errors of estimated poses relative to captured ones, frame by frame (the paper's Table 1 and
more).

All poses are in the 3-D surface frame, so that an estimate from wrong labels, whose leftmost
contact may be another finger, is compared in the same frame.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from encoders.correction import PAD_HEIGHT
from models.arithmetic import Array
from models.kinematics import Kinematics
from models.pose import JOINTS, ROOT_POSITION, ROOT_ROTATION, joint_vectors, violations
from models.rotations import geodesic_angle
from models.skeleton import ADULT

LIMIT_TOLERANCE = 1e-6
"""rad, tolerance at the end of a joint's range for rounding in single precision."""

_KINEMATICS = Kinematics(ADULT)


@dataclass(frozen=True)
class PoseErrors:
    """Errors of T poses.

    Attributes:
        wrist: (T,) cm, between true and estimated wrist.
        joints: (T, 14) degrees, angle of the rotation between true and estimated ball joint.
        components: (T, 42) degrees, absolute difference of every rotation-vector component.
        turn: (T,) degrees, angle between true and estimated rotation of the wrist.
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
    """Errors of estimated poses (T, 48) relative to captured ones (T, 48)."""
    off = estimate - truth
    return PoseErrors(
        100.0 * np.linalg.norm(off[:, ROOT_POSITION], axis=1),
        np.rad2deg(geodesic_angle(joint_vectors(estimate), joint_vectors(truth))),
        np.rad2deg(np.abs(off[:, JOINTS])),
        np.rad2deg(geodesic_angle(estimate[:, ROOT_ROTATION], truth[:, ROOT_ROTATION])),
    )


def tip_errors(q: Array, xy: Array) -> Array:
    """Distances (contacts,) in cm from each touch to the fingertip of *our* hand in the pose.

    A touch is at a finger's pad; the tip's centre should be 6 mm above it.

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
    """Share, 0 to 1, of all joint components in all frames that are outside our hand's ranges."""
    outside = violations(q, ADULT, LIMIT_TOLERANCE)
    return float(outside.mean() / (JOINTS.stop - JOINTS.start))


def variance_shares(vectors: Array, counts: tuple[int, ...]) -> dict[int, float]:
    """Percentage of the variance of vectors (T, n) in their first principal components."""
    values = np.linalg.eigvalsh(np.cov(vectors, rowvar=False))[::-1]
    return {k: float(100.0 * values[:k].sum() / values.sum()) for k in counts}
