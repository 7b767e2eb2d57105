"""The hand in motion formats: a wrist, fourteen joints below it, and keys of their rotations.

Formats differ in the frames of joints. BVH and ASF define no joint frames: at zero rotation every
joint has the frame of the file. Each writer therefore chooses a *zero pose*, with the fingers
straight and side by side and the thumb at its reference pose. The whole hand is rotated so that the
first axis of the Euler order is the flexion axis, and its last axis points out of the back of the
hand (`zero_frame`). Angles are then anatomical, and far from the poles of their order.
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
"""Name of the root joint."""

Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
"""Rotation from the world's frame to that of a file with y up: x right, y up, z towards the
person."""
Z_UP = np.eye(3)
"""Rotation from the world's frame to that of a file with z up. Its axes are the world's: x right, y
away from the person, z up."""

ORDERS = ("XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX")
"""Euler orders. The three rotations apply from left to right, each about an axis that the earlier
rotations have rotated (intrinsic rotations)."""

CHUNK = 512
"""Keys per batch; larger batches need more memory and are hardly faster."""


class Keys(NamedTuple):
    """Poses of one hand at n moments, in the world.

    Attributes:
        root: (n, 3) m, the wrist.
        turns: (n, 15, 3, 3) rotations: first world from palm, then parent from joint for each bone.
    """

    root: Array
    turns: Array


@dataclass(frozen=True)
class Armature:
    """Fifteen joints, parents before children: the wrist, then the joints of the skeleton's bones.

    Attributes:
        skeleton: The skeleton, whose order of bones is the order of the joints.
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
        """Indices of each joint's children."""
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
        """Fingertips (15, 3) m, each in the frame of its finger's last joint. The rows of all other
        joints are NaN."""
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
        """Keys from wrist positions and rotations relative to the rest pose.

        Args:
            root: (n, 3) m, wrists in the world.
            turns: (n, 15, 3, 3) rotations of the palm in the world and of each joint from its rest.
        """
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

        A joint's rotation from the zero pose, in the file's frame, is
        `zero[parent] @ turns @ zero.T`.
        """
        base = zero_frame(order)
        out = np.tile(base, (len(self.names), 1, 1))
        # The thumb is rotated so far from the palm that its angles would pass the poles of the
        # Euler order. Relative to its reference pose, its angles stay within 65 degrees.
        for j, bone in enumerate(self.skeleton.bones, start=1):
            if bone.finger == 0:
                out[j] = out[self.parents[j]] @ bone.rest
        return out

    def relative(self, keys: Keys, zero: Array, up: Array) -> tuple[Array, Array]:
        """Wrist positions and rotations from the zero pose, in the frame of a file.

        Args:
            keys: Keys in the world.
            zero: (15, 3, 3) zero pose, as `zero` returns it.
            up: (3, 3) file from world: `Y_UP` or `Z_UP`.

        Returns:
            Wrists (n, 3) m and rotations (n, 15, 3, 3).
        """
        above = zero[list(self.parents)].copy()
        above[0] = up
        return keys.root @ up.T, above @ keys.turns @ np.swapaxes(zero, -1, -2)

    @cached_property
    def _rests(self) -> Array:
        return np.stack([np.eye(3), *(bone.rest for bone in self.skeleton.bones)])


def zero_frame(order: str) -> Array:
    """Rotation (3, 3) file from hand in the zero pose of an Euler order.

    The first letter names the file's axis for flexion (the hand's x), the last letter the axis out
    of the back of the hand (z), and the middle letter the axis along the fingers (y), in either
    direction. With `ZXY` the hand lies flat, palm down, with its fingers along +x.

    For orders that begin with Y, the last letter names the fingers' axis, and the middle letter the
    axis out of the back of the hand. Y is up in files that have an Euler order. Without this swap,
    a flat hand would be at the pole of the order.

    Raises:
        MotionError: The order is not in `ORDERS`.
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
    """Yields the keys of world poses (n, 48) in batches of at most `CHUNK`."""
    for a in range(0, len(q), CHUNK):
        yield armature.keys(q[a : a + CHUNK])
