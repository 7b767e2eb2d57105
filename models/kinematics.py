"""Forward kinematics of the hand and the fingertips' Jacobian, for any number of poses at once."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array
from models.frames import FINGERS
from models.pose import POSE_SIZE, ROOT_POSITION, ROOT_ROTATION, joint_vectors
from models.rotations import exp, exp_and_left_jacobian, skew
from models.skeleton import Skeleton

_LEVELS = 3
"""Largest number of bones in a finger. The thumb's chain is padded with a bone of length 0."""


class Placement(NamedTuple):
    """Positions and rotations of all bones and fingertips, in the frame in which the pose is
    given."""

    joints: Array
    """(..., 14, 3) m, positions of the ball joints."""
    rotations: Array
    """(..., 14, 3, 3) rotations of the bones."""
    tips: Array
    """(..., 5, 3) m, centres of the fingertips' end spheres."""


class Kinematics:
    """Forward kinematics of one skeleton: `place(q)` for poses (..., 48), m and rad.

    Results are in the frame in which the poses are given, such as the world.

    All five fingers are computed side by side, bone by bone from the palm outwards. So a pose takes
    three rounds of small array operations instead of fourteen.
    """

    def __init__(self, skeleton: Skeleton) -> None:
        self.skeleton = skeleton
        five = len(FINGERS)
        self._anchor = np.zeros((_LEVELS, five, 3))
        self._rest = np.tile(np.eye(3), (_LEVELS, five, 1, 1))
        self._reach = np.zeros((five, 3))
        # Index of each finger's bone at each level. The padding is the index after the last bone,
        # for which `_padded` adds an identity rotation.
        self._bone = np.full((_LEVELS, five), len(skeleton.bones))
        for finger in range(five):
            chain = [(i, b) for i, b in enumerate(skeleton.bones) if b.finger == finger]
            for level, (i, bone) in enumerate(chain):
                self._bone[level, finger] = i
                self._anchor[level, finger] = bone.anchor
                self._rest[level, finger] = bone.rest
            self._reach[finger, 1] = chain[-1][1].length
        self._real = self._bone < len(skeleton.bones)

    def place(self, q: ArrayLike) -> Placement:
        """Joints, bone rotations and fingertips of poses (..., 48)."""
        q = np.asarray(q, float)
        turn = self._padded(exp(joint_vectors(q)))
        rotation = exp(q[..., ROOT_ROTATION])[..., None, :, :]
        position = q[..., None, ROOT_POSITION]
        bones = len(self.skeleton.bones)
        joints = np.empty((*q.shape[:-1], bones, 3))
        rotations = np.empty((*q.shape[:-1], bones, 3, 3))
        for level in range(_LEVELS):
            position = position + (rotation @ self._anchor[level][..., None])[..., 0]
            rotation = rotation @ self._rest[level] @ turn[..., self._bone[level], :, :]
            real = self._real[level]
            joints[..., self._bone[level][real], :] = position[..., real, :]
            rotations[..., self._bone[level][real], :, :] = rotation[..., real, :, :]
        tips = position + (rotation @ self._reach[..., None])[..., 0]
        return Placement(joints, rotations, tips)

    def tips(self, q: ArrayLike) -> Array:
        """(..., 5, 3) m, centres of the fingertips of poses (..., 48)."""
        return self.place(q).tips

    def tips_and_jacobian(self, q: ArrayLike) -> tuple[Array, Array]:
        """Fingertips (..., 5, 3) m of poses (..., 48), and their derivative (..., 5, 3, 48) with
        respect to the pose."""
        q = np.asarray(q, float)
        batch = q.shape[:-1]
        turn, left = exp_and_left_jacobian(joint_vectors(q))
        turn, left = self._padded(turn), self._padded(left)
        root, root_left = exp_and_left_jacobian(q[..., ROOT_ROTATION])
        rotation, position = root[..., None, :, :], q[..., None, ROOT_POSITION]
        places, axes = [], []
        for level in range(_LEVELS):
            position = position + (rotation @ self._anchor[level][..., None])[..., 0]
            before = rotation @ self._rest[level]
            chosen = self._bone[level]
            # exp(w + d) = exp(J d) exp(w): the rotation J d is in the frame before the joint.
            axes.append(before @ left[..., chosen, :, :])
            rotation = before @ turn[..., chosen, :, :]
            places.append(position)
        tips = position + (rotation @ self._reach[..., None])[..., 0]

        jacobian = np.zeros((*batch, len(FINGERS), 3, POSE_SIZE))
        jacobian[..., ROOT_POSITION] = np.eye(3)
        arm = tips - q[..., None, ROOT_POSITION]
        jacobian[..., ROOT_ROTATION] = -skew(arm) @ root_left[..., None, :, :]
        for level in range(_LEVELS):
            block = -skew(tips - places[level]) @ axes[level]
            for finger in range(len(FINGERS)):
                if self._real[level, finger]:
                    start = 6 + 3 * int(self._bone[level, finger])
                    jacobian[..., finger, :, start : start + 3] = block[..., finger, :, :]
        return tips, jacobian

    def _padded(self, per_bone: Array) -> Array:
        """Appends an identity rotation for the levels that a short finger lacks."""
        eye = np.broadcast_to(np.eye(3), (*per_bone.shape[:-3], 1, 3, 3))
        return np.concatenate([per_bone, eye], axis=-3)
