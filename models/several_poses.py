"""Forward kinematics of several poses with the fingers of one, each to the bit as if it were alone.

What is asked of many touches at once, for an evaluation or of trials that run side by side, must be
what a session would have been told. So every pose takes the steps that `models.one_pose` takes, in
the same order of sums, and only the calls of NumPy are shared: with 64 poses each costs a fifth.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from models.chains import CROSS, LEVELS, PADDING, TINY, Chains
from models.pose import ROOT_POSITION
from models.skeleton import Skeleton

Array = NDArray[np.float64]


class SeveralPoses:
    """Fingertips of poses of one skeleton, and their derivative.

    Args:
        skeleton: Of the hand.
        fingers: Whose tips are wanted, k of them in this order.
    """

    def __init__(self, skeleton: Skeleton, fingers: Sequence[int]) -> None:
        self._chains = Chains.of(skeleton, fingers)
        self._many = len(fingers)

    def tips_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Fingertips (n, k, 3) in m and their derivative (n, k, 3, 48) by the poses (n, 48)."""
        n, chains, many = len(q), self._chains, self._many
        turns = self._turns(q)
        bones = np.matmul(chains.rest, turns[:, 1:])
        turn_of, left_of = (bones[:, :, i].reshape(n, LEVELS, many, 3, 3) for i in (0, 1))
        local = np.tile(np.eye(4), (n, LEVELS, many, 1, 1))
        local[..., :3, :3] = turn_of
        local[..., :3, 3] = chains.anchor.reshape(LEVELS, many, 3)
        frames = np.tile(np.eye(4), (n, 1 + LEVELS, many, 1, 1))
        frames[:, 0, :, :3, :3] = turns[:, 0, :1]
        frames[:, 0, :, :3, 3] = q[:, None, ROOT_POSITION]
        for level in range(LEVELS):
            np.matmul(frames[:, level], local[:, level], frames[:, level + 1])
        tips = np.matmul(frames[:, -1], chains.reach)[:, :, :3, 0]
        axes = np.empty((n, 1 + LEVELS, many, 3, 3))
        axes[:, 0] = turns[:, 0, 1:]
        np.matmul(frames[:, :-1, :, :3, :3], left_of, axes[:, 1:])
        arms = tips[:, None] - frames[..., :3, 3]
        # Every column of the table has one number: the product is exact in any order.
        crossed = np.dot(arms.reshape(-1, 3), CROSS).reshape(axes.shape)
        blocks = np.matmul(crossed, axes).reshape(n, -1)
        entries = np.concatenate([blocks, np.tile([0.0, 1.0], (n, 1))], axis=1)
        return tips, entries.take(chains.entry_of, 1)

    def _turns(self, q: Array) -> Array:
        """exp(w) and left Jacobian (n, 1 + s, 2, 3, 3) of all turns w of poses (n, 48)."""
        n, chains = len(q), self._chains
        padded = np.concatenate([q, np.tile(PADDING, (n, 1))], axis=1)
        # `take`, unlike an index, lays the rows out as one pose is.
        basis = padded.take(chains.left, 1) * padded.take(chains.right, 1)
        # The order of sums is that of one pose.
        t2 = basis[:, :, 2, 0] + basis[:, :, 2, 8] + basis[:, :, 2, 4] + TINY
        t = np.sqrt(t2)
        a, half = np.sin(t) / t, np.sin(0.5 * t) / t
        b = half * half
        b += b
        loss = b * t2
        numbers = np.stack([1.0 - loss, 1.0 - a, (1.0 - a) / t2, b, loss, a], axis=1)
        shares = numbers.reshape(n, -1).take(chains.share_of, 1)
        return np.matmul(shares, basis).reshape(*basis.shape[:2], 2, 3, 3)
