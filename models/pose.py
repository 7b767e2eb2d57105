"""Layout of the pose `q` (N = 48), its frames and its legal range.

q = root position (3, m), root rotation vector (3, rad), then 14 ball joints x rotation vector
(3, rad) in the order of the skeleton's table: thumb CMC, MCP; index, middle, ring, little MCP, PIP,
DIP. A pose is given in the world, in the 3-D surface frame, or relative: in the 3-D surface frame
with its root moved so that the leftmost contact is the origin. Encoders learn the relative pose.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array
from models.rotations import unwrap_near
from models.skeleton import Skeleton

POSE_SIZE = 48
"""N, degrees of freedom of the hand."""
BALL_JOINTS = 14
ROOT_POSITION = slice(0, 3)
ROOT_ROTATION = slice(3, 6)
JOINTS = slice(6, 48)

_MIRROR = np.concatenate([[-1.0, 1.0, 1.0], np.tile([1.0, -1.0, -1.0], 1 + BALL_JOINTS)])


def joint_vectors(q: ArrayLike) -> Array:
    """Rotation vectors (..., 14, 3) of the ball joints of poses (..., 48)."""
    q = np.asarray(q, float)
    return q[..., JOINTS].reshape(*q.shape[:-1], BALL_JOINTS, 3)


def mirrored(q: ArrayLike) -> Array:
    """The pose of the other hand seen in a mirror across x = 0; its own inverse.

    In positions, x changes its sign; in rotation vectors, which are axial, y and z do.
    """
    return np.asarray(q, float) * _MIRROR


def relative_pose(q: ArrayLike, leftmost: ArrayLike) -> Array:
    """Converts poses (..., 48) in the 3-D surface frame to relative poses.

    Args:
        q: (..., 48).
        leftmost: (..., 2) leftmost contact on the surface, metres (x right, y down).
    """
    return _shifted(q, leftmost, -1.0)


def absolute_pose(relative: ArrayLike, leftmost: ArrayLike) -> Array:
    """Inverse of `relative_pose`."""
    return _shifted(relative, leftmost, 1.0)


def _shifted(q: ArrayLike, leftmost: ArrayLike, sign: float) -> Array:
    q, leftmost = np.array(q, float), np.asarray(leftmost, float)
    q[..., 0] += sign * leftmost[..., 0]
    q[..., 1] -= sign * leftmost[..., 1]
    return q


def blend(a: ArrayLike, b: ArrayLike, t: float) -> Array:
    """Interpolates from pose a (48,) (t = 0) to b (t = 1); rotations take the shorter way."""
    a, b = np.asarray(a, float), np.asarray(b, float)
    target = b.copy()
    target[ROOT_ROTATION] = unwrap_near(b[ROOT_ROTATION], a[ROOT_ROTATION])
    return a + t * (target - a)


def within_limits(q: ArrayLike, skeleton: Skeleton) -> Array:
    """Poses (..., 48) with every ball joint clamped, component by component, to its range.

    All servo targets must be clamped by this function: a ball joint's own limit in the simulation
    bounds only the total angle, and would let a finger bend sideways as far as it bends forward.
    """
    q = np.array(q, float)
    q[..., JOINTS] = np.clip(q[..., JOINTS], skeleton.lower, skeleton.upper)
    return q


def violations(q: ArrayLike, skeleton: Skeleton, tolerance: float = 1e-9) -> Array:
    """Number (...) of components outside their range by more than `tolerance` rad."""
    joints = np.asarray(q, float)[..., JOINTS]
    return np.sum(
        (joints < skeleton.lower - tolerance) | (joints > skeleton.upper + tolerance), axis=-1
    )
