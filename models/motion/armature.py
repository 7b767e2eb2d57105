"""The hand in motion formats: a wrist, fourteen joints below it, and keys of their rotations.

Formats differ in the frames of joints. BVH and ASF define none: at zero rotation every joint has
the frame of the file. So each writer chooses a *zero pose*: fingers straight and side by side,
the thumb at its reference pose, the whole hand turned so that the first letter of the Euler order
is flexion and the last the back of the hand (`zero_frame`). Angles are then anatomical, and far
from the poles of their order.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array
from models.errors import MotionError
from models.hand import SceneHand
from models.pose import ROOT_POSITION, ROOT_ROTATION, joint_vectors
from models.rotations import exp
from models.skeleton import Skeleton

WRIST = "wrist"
"""Name of the root."""

Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""File from world where up is y: x right, y up, z towards the person."""
Z_UP = np.eye(3)
"""File from world where up is z: x right, y away from the person, z up; the world itself."""

ORDERS = ("XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")
"""Euler orders; turns apply in this order about axes that turn along."""

CHUNK = 512
"""Keys per batch: enough to be quick, few enough to need little memory."""


class Keys(NamedTuple):
    """Poses of one hand at n moments, in the world.

    Attributes:
        root: (n, 3) m, the wrist.
        turns: (n, 15, 3, 3) rotations parent from joint: the palm's in the world, then the bones'.
    """

    root: Array
    turns: Array


@dataclass(frozen=True)
class Armature:
    """Fifteen joints, parents before children: the wrist, then the skeleton's bones in its order.

    Attributes:
        skeleton: The skeleton that has these bones.
    """

    skeleton: Skeleton

    @classmethod
    def of_hand(cls, hand: SceneHand) -> Armature:
        """The armature of a hand of a scene.

        Raises:
            MotionError: The hand has no skeleton.
        """
        if hand.skeleton is None:
            raise MotionError("this hand has no skeleton to export", where=hand.name)
        return cls(hand.skeleton)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the joints."""
        return (WRIST, *(bone.name for bone in self.skeleton.bones))

    @cached_property
    def parents(self) -> tuple[int, ...]:
        """Index of each joint's parent, -1 for the wrist."""
        out = [-1]
        for i, bone in enumerate(self.skeleton.bones):
            same = i and self.skeleton.bones[i - 1].finger == bone.finger
            out.append(i if same else 0)
        return tuple(out)

    @cached_property
    def children(self) -> tuple[tuple[int, ...], ...]:
        """Children of each joint."""
        return tuple(
            tuple(j for j, parent in enumerate(self.parents) if parent == i)
            for i in range(len(self.parents))
        )

    @cached_property
    def offsets(self) -> Array:
        """Positions (15, 3) m of each joint in its parent's frame."""
        return np.array([(0.0, 0.0, 0.0), *(bone.anchor for bone in self.skeleton.bones)])

    @cached_property
    def ends(self) -> Array:
        """Fingertips (15, 3) m in the frames of the last joints; NaN for other joints."""
        out = np.full((len(self.names), 3), np.nan)
        for j, bone in enumerate(self.skeleton.bones, start=1):
            if not self.children[j]:
                out[j] = (0.0, bone.length, 0.0)
        return out

    def keys(self, q: ArrayLike) -> Keys:
        """Keys of world poses (n, 48)."""
        q = np.asarray(q, float)
        vectors = np.concatenate([q[:, None, ROOT_ROTATION], joint_vectors(q)], axis=1)
        return self.of_turns(q[:, ROOT_POSITION], exp(vectors))

    def of_turns(self, root: Array, turns: Array) -> Keys:
        """Keys from wrists (n, 3) and rotations (n, 15, 3, 3) of palm and joints from their
        rest."""
        return Keys(root, self._rests @ turns)

    def place(self, keys: Keys) -> tuple[Array, Array]:
        """Positions of joints (n, 15, 3) and fingertips (n, 5, 3), m in the world."""
        positions = np.empty((*keys.turns.shape[:2], 3))
        frames = np.empty(keys.turns.shape)
        positions[:, 0], frames[:, 0] = keys.root, keys.turns[:, 0]
        for j, parent in enumerate(self.parents[1:], start=1):
            above = frames[:, parent]
            positions[:, j] = positions[:, parent] + above @ self.offsets[j]
            frames[:, j] = above @ keys.turns[:, j]
        last = [j for j in range(len(self.names)) if not self.children[j]]
        tips = positions[:, last] + (frames[:, last] @ self.ends[last][..., None])[..., 0]
        return positions, tips

    def zero(self, order: str) -> Array:
        """Rotations (15, 3, 3) file from joint, in the zero pose of an Euler order.

        Turns from it, in the file's frame, are `zero[parent] @ turns @ zero.T`.
        """
        base = zero_frame(order)
        out = np.tile(base, (len(self.names), 1, 1))
        # The thumb's frame is rotated so far relative to the palm's that its angles would pass the
        # poles of the order; relative to its reference pose, no legal rotation exceeds 65 degrees.
        for j, bone in enumerate(self.skeleton.bones, start=1):
            if bone.finger == 0:
                out[j] = out[self.parents[j]] @ bone.rest
        return out

    def relative(self, keys: Keys, zero: Array, up: Array) -> tuple[Array, Array]:
        """Wrist (n, 3) m and turns (n, 15, 3, 3) from a zero pose, in the frame of a file.

        Args:
            keys: In the world.
            zero: From `zero`.
            up: File from world: `Y_UP` or `Z_UP`.
        """
        above = zero[list(self.parents)].copy()
        above[0] = up
        return keys.root @ up.T, above @ keys.turns @ np.swapaxes(zero, -1, -2)

    @cached_property
    def _rests(self) -> Array:
        return np.stack([np.eye(3), *(bone.rest for bone in self.skeleton.bones)])


def zero_frame(order: str) -> Array:
    """Rotation (3, 3) file from hand in the zero pose of an Euler order.

    The first letter's axis is that of flexion (the hand's x), the last one's points out of the back
    of the hand (z), the middle one's along the fingers (y) or against them. With `ZXY` the hand
    lies flat, palm down, its fingers along +x.

    Orders that begin with Y would put a flat hand at their pole, since up is Y in the files that
    have an order; for them the last letter is the fingers' axis and the middle one the axis out of
    the back.
    """
    if order not in ORDERS:
        raise MotionError("not an Euler order", got=order, expected=", ".join(ORDERS))
    first, middle, last = ("XYZ".index(letter) for letter in order)
    out = np.zeros((3, 3))
    out[first, 0] = 1.0
    along, back = (last, middle) if order[0] == "Y" else (middle, last)
    out[back, 2] = 1.0
    out[along, 1] = 1.0
    out[along, 1] = np.linalg.det(out)
    return out


def chunks(armature: Armature, q: Array) -> Iterator[Keys]:
    """Yields keys of world poses (n, 48) in batches."""
    for a in range(0, len(q), CHUNK):
        yield armature.keys(q[a : a + CHUNK])
