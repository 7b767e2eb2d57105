"""How the fingers' chains lie side by side for the forward kinematics of single poses.

What one pose and several poses have in common (`models.one_pose`, `models.several_poses`): where a
pose has the numbers of every turn, what never changes along the chains, and where every block of
the Jacobian goes. Row 0 is the root; then come the fingers' first bones, their second and their
third ones. A turn and its left Jacobian are both x I + y skew(w) + z w w', with other x, y and z.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.pose import POSE_SIZE, ROOT_POSITION
from models.skeleton import Skeleton

Array = NDArray[np.float64]
Indices = NDArray[np.int64]

LEVELS = 3
"""Most bones in one finger; the thumb's chain is padded with a bone of no length."""

TINY = 1e-24
"""rad2, added to squared angles. It keeps 0/0 out of the closed forms and changes nothing: what
cancellation spoils there is multiplied by the square of the same small vector."""


def _cross_table() -> Array:
    """(3, 9) T with (v @ T).reshape(3, 3) @ a == cross(a, v)."""
    table = np.zeros((3, 9))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        table[i, 3 * k + j], table[i, 3 * j + k] = -1.0, 1.0
    return table


CROSS = _cross_table()

ZERO, ONE, MINUS = POSE_SIZE, POSE_SIZE + 1, POSE_SIZE + 2
"""Where a padded pose has the numbers 0, 1 and -1."""
PADDING = (0.0, 1.0, -1.0)

_SKEW = ((None, 2, 1), (2, None, 0), (1, 0, None))
_SKEW_SIGN = ((ZERO, MINUS, ONE), (ONE, ZERO, MINUS), (MINUS, ONE, ZERO))
"""Skew matrices: which component of the vector is where, and its sign."""


class Chains(NamedTuple):
    """The chains of k fingers, s = 3 k bones."""

    left: Indices
    """(1 + s, 3, 9) of which number of the padded pose I, skew(w) and w w' are products,"""
    right: Indices
    """and of which other one."""
    share_of: Indices
    """(1 + s, 2, 3) of which number among the (6, 1 + s) of all turns x, y and z of every turn and
    of its left Jacobian are. With a the sine of the turn t by t, b 1 - cos(t) by t2, they are in
    this order 1 - b t2, 1 - a, (1 - a) / t2, b, b t2 and a."""
    rest: Array
    """(s, 1, 3, 3) rest rotations; the thumb's padding is a turn that stays 0."""
    anchor: Array
    """(s, 3) m, where each bone is in the frame of the one before."""
    reach: Array
    """(k, 4, 1) m, the tips in the frames of the last bones, homogeneous."""
    entry_of: Indices
    """(k, 3, 48) of which number among those of all blocks (4, k, 3, 3), 0 and 1 the Jacobian is.
    Block [0, f] is the f-th finger's by the root's turn, block [1 + l, f] by its bone of level
    l."""

    @classmethod
    def of(cls, skeleton: Skeleton, fingers: Sequence[int]) -> Chains:
        """The chains of these fingers in their order."""
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
        place: (n, 3) where the padded pose has the components of n turns w.
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
    found = np.full((many, 3, POSE_SIZE), zero)
    found[..., ROOT_POSITION] = np.where(np.eye(3), one, zero)
    for level in range(1 + LEVELS):
        for finger in range(many):
            columns = place[0] if level == 0 else place[1 + many * (level - 1) + finger]
            if columns[0] != ZERO:
                found[finger][:, columns] = blocks[level, finger]
    return found
