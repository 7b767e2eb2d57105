"""Forward kinematics of one pose at a time, for the loop that reconstructs at every control step.

What `models.kinematics` does for any number of poses costs, for a single one, mostly calls of
NumPy. Here the fingers' chains lie side by side in buffers that are made once, and every step of
the calculation is one call for all of them. Results agree with those of `Kinematics` to rounding;
captures and trained models come from there, so that their digests do not depend on this.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from models.chains import CROSS, LEVELS, PADDING, TINY, Chains
from models.frames import FINGERS
from models.pose import POSE_SIZE, ROOT_POSITION
from models.skeleton import Skeleton

Array = NDArray[np.float64]


class OnePose:
    """Fingertips of single poses of one skeleton, and their derivative.

    Buffers are used again for every pose, so an object serves one thread at a time; what it returns
    is the caller's own.

    Args:
        skeleton: Of the hand.
        fingers: Whose tips are wanted, k of them in this order. What is found for a finger does not
            depend on the others, to the bit.
    """

    def __init__(self, skeleton: Skeleton, fingers: Sequence[int] = range(len(FINGERS))) -> None:
        chains = Chains.of(skeleton, fingers)
        many = len(fingers)
        slots = LEVELS * many
        self._rest, self._reach = chains.rest, chains.reach
        self._left, self._right = chains.left, chains.right
        self._padded = np.append(np.zeros(POSE_SIZE), PADDING)
        self._factor, self._other = np.empty(self._left.shape), np.empty(self._left.shape)
        self._basis = np.empty(self._left.shape)
        self._squares = [self._basis[:, 2, i] for i in (0, 4, 8)]
        # NumPy is quickest with whole arrays of one shape: constants are such arrays, too.
        self._one, self._tiny = np.ones((2, 1 + slots)), np.full(1 + slots, TINY)
        self._twice = np.tile(np.arange(1 + slots), (2, 1))
        self._parts = np.array([[0.5], [1.0]]) * self._one
        self._numbers, self._shares = np.empty((6, 1 + slots)), np.empty((1 + slots, 2, 3))
        self._share_of = chains.share_of
        self._turns = np.empty((1 + slots, 2, 9))
        both = self._turns.reshape(1 + slots, 2, 3, 3)
        self._root, self._root_left, self._bone_turns = both[0, 0], both[0, 1], both[1:]
        self._bones = np.empty((slots, 2, 3, 3))
        self._turn_of = self._bones[:, 0].reshape(LEVELS, many, 3, 3)
        self._left_of = self._bones[:, 1].reshape(LEVELS, many, 3, 3)
        # From a bone's frame to its parent's, and from the frames of all levels to the world's.
        self._local = np.tile(np.eye(4), (LEVELS, many, 1, 1))
        self._local[..., :3, 3] = chains.anchor.reshape(LEVELS, many, 3)
        self._local_turn = self._local[..., :3, :3]
        self._frames = np.tile(np.eye(4), (1 + LEVELS, many, 1, 1))
        self._root_turn, self._root_place = self._frames[0, :, :3, :3], self._frames[0, :, :3, 3]
        self._steps = [
            (self._frames[i], self._local[i], self._frames[i + 1]) for i in range(LEVELS)
        ]
        self._before, self._joints = self._frames[:-1, :, :3, :3], self._frames[:, :, :3, 3]
        self._ends = np.empty((many, 4, 1))
        self._tips = self._ends[:, :3, 0]
        self._axes = np.empty((1 + LEVELS, many, 3, 3))
        self._axes_root, self._axes_bones = self._axes[0], self._axes[1:]
        self._arms = np.empty((1 + LEVELS, many, 3))
        self._flat_arms = self._arms.reshape(-1, 3)
        self._crossed = np.empty((len(self._flat_arms), 9))
        self._crossed_arms = self._crossed.reshape(self._axes.shape)
        # All blocks of the Jacobian, and the numbers 0 and 1 that are the rest of it.
        self._entries = np.array([0.0] * self._axes.size + [0.0, 1.0])
        self._blocks = self._entries[:-2].reshape(self._axes.shape)
        self._entry_of = chains.entry_of

    def tips(self, q: Array) -> Array:
        """(k, 3) m, centres of the fingertips of a pose (48,)."""
        return self._walk(q)

    def tips_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Fingertips (k, 3) and their derivative (k, 3, 48) by the pose (48,)."""
        tips = self._walk(q)
        # exp(w + d) = exp(J d) exp(w): the turn J d happens in the frame before the joint.
        self._axes_root[:] = self._root_left
        np.matmul(self._before, self._left_of, self._axes_bones)
        # The root's own frame stands where the root is, a bone's where its joint is.
        np.subtract(tips, self._joints, self._arms)
        np.dot(self._flat_arms, CROSS, self._crossed)
        np.matmul(self._crossed_arms, self._axes, self._blocks)
        return tips, self._entries.take(self._entry_of)

    def _walk(self, q: Array) -> Array:
        """Fingertips (k, 3) of a pose; turns, left Jacobians and frames stay in their buffers."""
        self._padded[:POSE_SIZE] = q
        self._turn()
        # Of the bones after their rest rotations.
        np.matmul(self._rest, self._bone_turns, self._bones)
        self._local_turn[:] = self._turn_of
        self._root_turn[:] = self._root
        self._root_place[:] = q[ROOT_POSITION]
        for before, local, after in self._steps:
            np.matmul(before, local, after)
        np.matmul(self._frames[-1], self._reach, self._ends)
        return self._tips.copy()

    def _turn(self) -> None:
        """exp(w) and left Jacobian (n, 2, 3, 3) of all turns w of the padded pose; Rodrigues."""
        padded, numbers = self._padded, self._numbers
        # With a mode other than "raise", numbers go to their places without a copy between.
        padded.take(self._left, None, self._factor, "clip")
        padded.take(self._right, None, self._other, "clip")
        np.multiply(self._factor, self._other, self._basis)
        # Recorded sessions were reconstructed with squares that were added in this order.
        x2, y2, z2 = self._squares
        t2 = x2 + z2
        t2 += y2
        t2 += self._tiny
        t = np.sqrt(t2.take(self._twice))
        # sin(t/2) / t and sin(t) / t.
        np.divide(np.sin(t * self._parts), t, numbers[4:])
        _, _, c, b, half, _ = numbers
        # 1 - cos loses half the digits for small angles; 2 sin^2(t/2) does not.
        np.multiply(half, half, b)
        b += b
        np.multiply(b, t2, half)
        np.subtract(self._one, numbers[4:], numbers[:2])
        np.divide(numbers[1], t2, c)
        numbers.take(self._share_of, None, self._shares, "clip")
        np.matmul(self._shares, self._basis, self._turns)
