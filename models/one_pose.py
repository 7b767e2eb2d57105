"""Forward kinematics of one pose at a time, for the loop that reconstructs at every control step.

For a single pose, the batched functions of `models.kinematics` spend most of their time on the
overhead of NumPy calls. Here the fingers' chains lie side by side in preallocated buffers, and
every step of the calculation is one call for all of them. Results agree with those of `Kinematics`
to rounding. Captures and trained models use `Kinematics`, so their digests do not depend on this
module.

`SeveralPoses` does the same for several poses with the same fingers. A trial must get the same
result side by side with others as alone, so every pose takes the same steps in the same order of
sums, and only the calls of NumPy are shared: with 64 poses each costs a fifth.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.arithmetic.arrays import Array
from models.frames import FINGERS
from models.pose import POSE_SIZE, ROOT_POSITION
from models.skeleton import Skeleton

Indices = NDArray[np.int64]

LEVELS = 3
"""Most bones in one finger; the thumb's chain is padded with a bone of no length."""

TINY = 1e-24
"""rad2, added to squared angles. It avoids 0/0 in the closed forms and does not change results: the
terms that lose digits by cancellation are multiplied by the square of the same small vector."""


def _cross_table() -> Array:
    """(3, 9) T with (v @ T).reshape(3, 3) @ a == cross(a, v)."""
    table = np.zeros((3, 9))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        table[i, 3 * k + j], table[i, 3 * j + k] = -1.0, 1.0
    return table


CROSS = _cross_table()

ZERO, ONE, MINUS = POSE_SIZE, POSE_SIZE + 1, POSE_SIZE + 2
"""Indices of the numbers 0, 1 and -1 in a padded pose."""
PADDING = (0.0, 1.0, -1.0)

_SKEW = ((None, 2, 1), (2, None, 0), (1, 0, None))
_SKEW_SIGN = ((ZERO, MINUS, ONE), (ONE, ZERO, MINUS), (MINUS, ONE, ZERO))
"""Entries of a skew matrix: index of the vector's component, and its sign."""


class Chains(NamedTuple):
    """Index tables for the chains of k fingers, s = 3 k bones."""

    left: Indices
    """(1 + s, 3, 9) index of the first factor in the padded pose, for the products I, skew(w) and w
    w',"""
    right: Indices
    """and index of the second factor."""
    share_of: Indices
    """(1 + s, 2, 3) indices into the (6, 1 + s) coefficients of all rotations, for x, y and z of
    every rotation and of its left Jacobian. With angle t, a = sin(t) / t and b = (1 - cos(t)) / t2,
    the coefficients are, in this order, 1 - b t2, 1 - a, (1 - a) / t2, b, b t2 and a."""
    rest: Array
    """(s, 1, 3, 3) rest rotations; the thumb's padding is a rotation that stays 0."""
    anchor: Array
    """(s, 3) m, position of each bone in the frame of the one before."""
    reach: Array
    """(k, 4, 1) m, the tips in the frames of the last bones, homogeneous."""
    entry_of: Indices
    """(k, 3, 48) index of every entry of the Jacobian among the numbers of all blocks (4, k, 3, 3),
    0 and 1. Block [0, f] is the derivative of the f-th finger by the root's rotation, block [1 + l,
    f] that by its bone of level l."""

    @classmethod
    def of(cls, skeleton: Skeleton, fingers: Sequence[int]) -> Chains:
        """Builds the tables for these fingers in their order."""
        many = len(fingers)
        slots = LEVELS * many
        place = np.full((1 + slots, 3), ZERO)
        place[0] = 3, 4, 5
        rest, anchor = np.tile(np.eye(3), (slots, 1, 1)), np.zeros((slots, 3))
        reach = np.zeros((many, 4, 1))
        reach[:, 3] = 1.0
        for at, finger in enumerate(fingers):
            chain = [(i, b) for i, b in enumerate(skeleton.bones) if b.finger == finger]
            for level, (i, bone) in enumerate(chain):
                slot = many * level + at
                place[1 + slot] = 6 + 3 * i + np.arange(3)
                rest[slot], anchor[slot] = bone.rest, bone.anchor
            reach[at, 1] = chain[-1][1].length
        each = np.array([[0, 5, 3], [5, 3, 2]])
        share_of = (1 + slots) * each + np.arange(1 + slots)[:, None, None]
        left, right = _factors(place)
        entry_of = _gathering(place, many)
        return cls(left, right, share_of, rest[:, None], anchor, reach, entry_of)


def _factors(place: Indices) -> tuple[Indices, Indices]:
    """`Chains.left` and `Chains.right`.

    Args:
        place: (n, 3) indices of the components of n rotation vectors w in the padded pose.
    """
    left, right = np.empty((2, len(place), 3, 3, 3), np.int64)
    for i in range(3):
        for j in range(3):
            which = _SKEW[i][j]
            left[:, 0, i, j] = right[:, 0, i, j] = ONE if i == j else ZERO
            left[:, 1, i, j] = ZERO if which is None else place[:, which]
            right[:, 1, i, j] = _SKEW_SIGN[i][j]
            left[:, 2, i, j], right[:, 2, i, j] = place[:, i], place[:, j]
    return left.reshape(-1, 3, 9), right.reshape(-1, 3, 9)


def _gathering(place: Indices, many: int) -> Indices:
    """`Chains.entry_of`."""
    blocks = np.arange((1 + LEVELS) * many * 9).reshape(1 + LEVELS, many, 3, 3)
    zero, one = blocks.size, blocks.size + 1
    table = np.full((many, 3, POSE_SIZE), zero)
    table[..., ROOT_POSITION] = np.where(np.eye(3), one, zero)
    for level in range(1 + LEVELS):
        for finger in range(many):
            columns = place[0] if level == 0 else place[1 + many * (level - 1) + finger]
            if columns[0] != ZERO:
                table[finger][:, columns] = blocks[level, finger]
    return table


class OnePose:
    """Fingertips of single poses of one skeleton, and their derivative.

    Buffers are reused for every pose, so an object serves one thread at a time; returned arrays are
    new.

    Args:
        skeleton: The hand's skeleton.
        fingers: Labels of the k wanted fingers, in this order. The result for a finger does not
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
        # NumPy is quickest with whole arrays of one shape, so constants are such arrays, too.
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
        # All blocks of the Jacobian, then the numbers 0 and 1, which fill its other entries.
        self._entries = np.array([0.0] * self._axes.size + [0.0, 1.0])
        self._blocks = self._entries[:-2].reshape(self._axes.shape)
        self._entry_of = chains.entry_of

    def tips(self, q: Array) -> Array:
        """Centres (k, 3) m of the fingertips of a pose (48,)."""
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
        # Bone rotations after their rest rotations.
        np.matmul(self._rest, self._bone_turns, self._bones)
        self._local_turn[:] = self._turn_of
        self._root_turn[:] = self._root
        self._root_place[:] = q[ROOT_POSITION]
        for before, local, after in self._steps:
            np.matmul(before, local, after)
        np.matmul(self._frames[-1], self._reach, self._ends)
        return self._tips.copy()

    def _turn(self) -> None:
        """exp(w) and left Jacobian (n, 2, 3, 3) of all rotation vectors w of the padded pose
        (Rodrigues)."""
        padded, numbers = self._padded, self._numbers
        # With a mode other than "raise", numbers go to their places without a copy between.
        padded.take(self._left, None, self._factor, "clip")
        padded.take(self._right, None, self._other, "clip")
        np.multiply(self._factor, self._other, self._basis)
        # Recorded sessions were reconstructed with squares added in this order: do not change it.
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


class SeveralPoses:
    """Fingertips of several poses of one skeleton, and their derivative.

    Args:
        skeleton: The hand's skeleton.
        fingers: Labels of the k wanted fingers, in this order.
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
        # Every column of the table has one nonzero number: the product is exact in any order.
        crossed = np.dot(arms.reshape(-1, 3), CROSS).reshape(axes.shape)
        blocks = np.matmul(crossed, axes).reshape(n, -1)
        entries = np.concatenate([blocks, np.tile([0.0, 1.0], (n, 1))], axis=1)
        return tips, entries.take(chains.entry_of, 1)

    def _turns(self, q: Array) -> Array:
        """exp(w) and left Jacobian (n, 1 + s, 2, 3, 3) of all rotation vectors w of poses (n,
        48)."""
        n, chains = len(q), self._chains
        padded = np.concatenate([q, np.tile(PADDING, (n, 1))], axis=1)
        # `take`, unlike indexing, lays out the rows in memory like those of one pose.
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
