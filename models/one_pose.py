"""Forward kinematics of one pose at a time, for the loop that reconstructs at every control step.

What `models.kinematics` does for any number of poses costs, for a single one, mostly calls of
NumPy. Here the five fingers' chains lie side by side in buffers that are made once, and every step
of the calculation is one call for all of them. Results agree with those of `Kinematics` to
rounding; captures and trained models come from there, so that their digests do not depend on this.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from models.frames import FINGERS
from models.pose import POSE_SIZE, ROOT_POSITION
from models.skeleton import Skeleton

Array = NDArray[np.float64]

_LEVELS = 3
"""Most bones in one finger; the thumb's chain is padded with a bone of no length."""

_TINY = 1e-24
"""rad2, added to squared angles. It keeps 0/0 out of the closed forms and changes nothing: what
cancellation spoils there is multiplied by the square of the same small vector."""


def _cross_table() -> Array:
    """(3, 9) T with (v @ T).reshape(3, 3) @ a == cross(a, v)."""
    table = np.zeros((3, 9))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        table[i, 3 * k + j], table[i, 3 * j + k] = -1.0, 1.0
    return table


_CROSS = _cross_table()
_SKEW = -_CROSS


class OnePose:
    """Fingertips of single poses of one skeleton, and their derivative.

    Buffers are used again for every pose, so an object serves one thread at a time; what it returns
    is the caller's own.
    """

    def __init__(self, skeleton: Skeleton) -> None:
        five = len(FINGERS)
        slots = _LEVELS * five
        # Row 0 is the root; then come the fingers' first bones, their second and their third ones.
        # The padding reads one number more than a pose has: a turn that stays 0.
        place = np.full((1 + slots, 3), POSE_SIZE)
        place[0] = 3, 4, 5
        rest, anchor = np.tile(np.eye(3), (slots, 1, 1)), np.zeros((slots, 3))
        self._reach = np.zeros((five, 4, 1))
        self._reach[:, 3] = 1.0
        for finger in range(five):
            chain = [(i, b) for i, b in enumerate(skeleton.bones) if b.finger == finger]
            for level, (i, bone) in enumerate(chain):
                slot = five * level + finger
                place[1 + slot] = 6 + 3 * i + np.arange(3)
                rest[slot], anchor[slot] = bone.rest, bone.anchor
            self._reach[finger, 1] = chain[-1][1].length
        self._place, self._rest = place, rest[:, None]
        self._padded, self._vectors = np.zeros(POSE_SIZE + 1), np.empty(place.shape)
        # A turn and its left Jacobian are both x I + y cross(w) + z w w', with other x, y and z.
        self._shares = np.empty((1 + slots, 2, 3))
        flat = self._shares.reshape(1 + slots, 6)
        # Views of the places of 1 - b t2, of a and b (twice each) and of (1 - a) / t2.
        self._share_1, self._share_a = flat[:, 0], flat[:, 1:4:2]
        self._share_b, self._share_c = flat[:, 2:5:2], flat[:, 5]
        self._basis = np.zeros((1 + slots, 3, 9))
        self._basis[:, 0] = np.eye(3).ravel()
        self._products = self._basis[:, 2].reshape(1 + slots, 3, 3)
        self._crosses = self._basis[:, 1]
        self._turns = np.empty((1 + slots, 2, 9))
        self._both = self._turns.reshape(1 + slots, 2, 3, 3)
        self._bones = np.empty((slots, 2, 3, 3))
        self._turn_of = self._bones[:, 0].reshape(_LEVELS, five, 3, 3)
        self._left_of = self._bones[:, 1].reshape(_LEVELS, five, 3, 3)
        # From a bone's frame to its parent's, and from the frames of all levels to the world's.
        self._local = np.tile(np.eye(4), (_LEVELS, five, 1, 1))
        self._local[..., :3, 3] = anchor.reshape(_LEVELS, five, 3)
        self._local_turn = self._local[..., :3, :3]
        self._frames = np.tile(np.eye(4), (1 + _LEVELS, five, 1, 1))
        self._root_turn, self._root_place = self._frames[0, :, :3, :3], self._frames[0, :, :3, 3]
        self._steps = [
            (self._frames[i], self._local[i], self._frames[i + 1]) for i in range(_LEVELS)
        ]
        self._before, self._joints = self._frames[:-1, :, :3, :3], self._frames[1:, :, :3, 3]
        self._ends = np.empty((five, 4, 1))
        self._axes = np.empty((1 + _LEVELS, five, 3, 3))
        self._axes_root, self._axes_bones = self._axes[0], self._axes[1:]
        self._arms = np.empty((1 + _LEVELS, five, 3))
        self._arms_root, self._arms_bones = self._arms[0], self._arms[1:]
        self._flat_arms = self._arms.reshape(-1, 3)
        self._crossed = np.empty((len(self._flat_arms), 9))
        self._crossed_arms = self._crossed.reshape(self._axes.shape)
        self._blocks = np.empty(self._axes.shape)
        self._flat_blocks = self._blocks.reshape(-1)
        self._from, self._to = _scattering(place, five)
        self._blank = np.zeros((five, 3, POSE_SIZE))
        self._blank[..., ROOT_POSITION] = np.eye(3)

    def tips(self, q: Array) -> Array:
        """(5, 3) m, centres of the fingertips of a pose (48,)."""
        return self._walk(q)[0]

    def tips_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Fingertips (5, 3) and their derivative (5, 3, 48) by the pose (48,)."""
        tips, root_left, left = self._walk(q)
        # exp(w + d) = exp(J d) exp(w): the turn J d happens in the frame before the joint.
        self._axes_root[:] = root_left
        np.matmul(self._before, left, self._axes_bones)
        np.subtract(tips, q[ROOT_POSITION], self._arms_root)
        np.subtract(tips, self._joints, self._arms_bones)
        np.matmul(self._flat_arms, _CROSS, self._crossed)
        np.matmul(self._crossed_arms, self._axes, self._blocks)
        jacobian = self._blank.copy()
        jacobian.reshape(-1)[self._to] = self._flat_blocks.take(self._from)
        return tips, jacobian

    def _walk(self, q: Array) -> tuple[Array, Array, Array]:
        """Fingertips (5, 3), left Jacobians of the root (3, 3) and of the bones (3, 5, 3, 3).

        The latter after the bones' rest rotations. Frames stay in their buffer.
        """
        self._padded[:POSE_SIZE] = q
        # With a mode other than "raise", numbers go to their places without a copy between.
        turned = self._turned(self._padded.take(self._place, None, self._vectors, "clip"))
        np.matmul(self._rest, turned[1:], self._bones)
        self._local_turn[:] = self._turn_of
        self._root_turn[:] = turned[0, 0]
        self._root_place[:] = q[ROOT_POSITION]
        for before, local, after in self._steps:
            np.matmul(before, local, after)
        tips = np.matmul(self._frames[_LEVELS], self._reach, self._ends)[:, :3, 0].copy()
        return tips, turned[0, 1], self._left_of

    def _turned(self, w: Array) -> Array:
        """(n, 2, 3, 3) exp(w) and left Jacobian of rotation vectors (n, 3); Rodrigues."""
        np.multiply(w[:, :, None], w[:, None, :], self._products)
        np.matmul(w, _SKEW, self._crosses)
        t2 = np.einsum("ij,ij->i", w, w)
        t2 += _TINY
        t = np.sqrt(t2)
        # 1 - cos loses half the digits for small angles; 2 sin^2(t/2) does not.
        half = np.sin(0.5 * t)
        half /= t
        a = np.sin(t)
        a /= t
        b = 2.0 * half
        b *= half
        np.subtract(1.0, b * t2, self._share_1)
        self._share_a[:] = a[:, None]
        self._share_b[:] = b[:, None]
        np.divide(1.0 - a, t2, self._share_c)
        np.matmul(self._shares, self._basis, self._turns)
        return self._both


def _scattering(place: NDArray[np.int64], five: int) -> tuple[NDArray[np.int64], ...]:
    """Where the numbers of all blocks (4, 5, 3, 3) are that belong into the Jacobian, and where.

    Block [0, f] is finger f's by the root's turn, block [1 + l, f] by its bone of level l.
    """
    source, target = [], []
    for level in range(1 + _LEVELS):
        for finger in range(five):
            columns = place[0] if level == 0 else place[1 + five * (level - 1) + finger]
            if columns[0] == POSE_SIZE:
                continue
            for row in range(3):
                for column in range(3):
                    source.append(((level * five + finger) * 3 + row) * 3 + column)
                    target.append((finger * 3 + row) * POSE_SIZE + columns[column])
    return np.array(source), np.array(target)
