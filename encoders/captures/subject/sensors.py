"""Simulated measurement of a hand: touches by a screen, poses by a capture system."""

from __future__ import annotations

import numpy as np

from encoders.captures.subject.configuration import SubjectConfiguration
from encoders.captures.subject.gestures import smooth_noise
from models.arithmetic import Array
from models.kinematics import Kinematics, Placement
from models.pose import BALL_JOINTS, JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION, within_limits
from models.skeleton import Skeleton
from models.surface import METRES_PER_INCH


def touches(
    rng: np.random.Generator,
    placement: Placement,
    skeleton: Skeleton,
    configuration: SubjectConfiguration,
) -> Array:
    """Touches (n, 5, 2) m of all fingertips as a screen reports them (x right, y down).

    The flatter a finger lies, the more of its pad touches, and the further back is the middle of
    the touch. Positions come in whole dots.
    """
    last = [*(skeleton.first_bone[1:] - 1), len(skeleton.bones) - 1]
    along = placement.rotations[..., last, :, :][..., 1]
    seen = (placement.tips - configuration.pad_roll * along)[..., :2]
    seen = seen + rng.normal(0, configuration.touch_noise, seen.shape)
    dot = METRES_PER_INCH / configuration.touch_resolution
    return np.round(seen / dot) * dot * np.array([1.0, -1.0])


def day_error(rng: np.random.Generator, configuration: SubjectConfiguration) -> Array:
    """Constant error (48,) of one day's poses: markers never sit twice on the same spot."""
    out = np.empty(POSE_SIZE)
    out[ROOT_POSITION] = rng.normal(0, configuration.day_root[0], 3)
    out[ROOT_ROTATION] = rng.normal(0, configuration.day_root[1], 3)
    out[JOINTS] = rng.normal(0, configuration.day_joint, POSE_SIZE - 6)
    return out


def measured_pose(
    rng: np.random.Generator,
    times: Array,
    q: Array,
    day: Array,
    kinematics: Kinematics,
    configuration: SubjectConfiguration,
) -> Array:
    """Poses (n, 48) as a capture system reports them: with errors, and within anatomic limits.

    Such a system turns joints until the skeleton meets the markers, those on the fingertips among
    them. Its joints may err by degrees, but together they put the fingertips where they were.

    Args:
        rng: Source of the errors.
        times: (n,) s, times of the frames.
        q: (n, 48) true poses.
        day: (48,) constant error of the day.
        kinematics: Kinematics of the skeleton that is fitted to the markers.
        configuration: Sizes of the errors.
    """
    c = configuration
    error = np.tile(day, (len(q), 1))
    error[:, ROOT_POSITION] += rng.normal(0, c.root_noise[0], (len(q), 3))
    error[:, ROOT_ROTATION] += rng.normal(0, c.root_noise[1], (len(q), 3))
    skin = smooth_noise(rng, times, c.soft_tissue_time, (3 * BALL_JOINTS,))
    error[:, JOINTS] += c.soft_tissue * skin + rng.normal(0, c.joint_noise, skin.shape)
    variance = np.empty(POSE_SIZE)
    variance[ROOT_POSITION] = c.root_noise[0] ** 2 + c.day_root[0] ** 2
    variance[ROOT_ROTATION] = c.root_noise[1] ** 2 + c.day_root[1] ** 2
    variance[JOINTS] = c.soft_tissue**2 + c.joint_noise**2 + c.day_joint**2
    tips, by_pose = kinematics.tips_and_jacobian(q)
    out = q + error
    for _ in range(2):
        miss = (tips - kinematics.tips(out)).reshape(len(q), -1, 1)
        J = by_pose.reshape(len(q), -1, POSE_SIZE)
        spread = J * variance
        H = spread @ np.swapaxes(J, -1, -2) + c.tip_marker**2 * np.eye(J.shape[1])
        out = out + (np.swapaxes(spread, -1, -2) @ np.linalg.solve(H, miss))[..., 0]
    return within_limits(out, kinematics.skeleton)
