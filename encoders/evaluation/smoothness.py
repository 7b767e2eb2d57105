"""Smoothness of estimated poses: while the same fingers touch, and when one comes or goes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from encoders.capture import Capture
from models.arithmetic import Array
from models.pose import JOINTS, joint_vectors
from models.rotations import geodesic_angle

_GAP = 1.5
"""Mean periods between frames beyond which they do not count as consecutive."""


@dataclass(frozen=True)
class Smoothness:
    """Changes of poses between frames; an array is empty where a capture has no such moment.

    Attributes:
        acceleration: (n,) degrees/s2, mean absolute second difference of the 42 joint components,
            for every three frames in a row with the same contacts.
        jump: (m,) degrees, mean absolute change of the 42 joint components between the two frames
            at which the set of contacts changed.
        largest_joint: (m,) degrees, largest rotation of a joint there.
        wrist_jump: (m,) cm, movement of the wrist there.
    """

    acceleration: Array
    jump: Array
    largest_joint: Array
    wrist_jump: Array


def smoothness(q: Array, capture: Capture) -> Smoothness:
    """Smoothness of poses (T, 48), one for every frame of a capture."""
    joints = np.rad2deg(q[:, JOINTS])
    steps = np.diff(capture.time)
    follows = np.diff(capture.trial) == 0
    period = float(np.median(steps[follows])) if follows.any() else np.inf
    follows &= (steps > 0) & (steps < _GAP * period)
    same = (capture.ids[1:] == capture.ids[:-1]).all(axis=1)

    steady = follows & same
    triple = steady[1:] & steady[:-1]
    second = (joints[2:] - 2.0 * joints[1:-1] + joints[:-2])[triple] / period**2

    changed = np.flatnonzero(follows & ~same)
    before, after = q[changed], q[changed + 1]
    turned = np.rad2deg(geodesic_angle(joint_vectors(before), joint_vectors(after)))
    return Smoothness(
        np.abs(second).mean(axis=1),
        np.abs(joints[changed + 1] - joints[changed]).mean(axis=1),
        turned.max(axis=1),
        100.0 * np.linalg.norm((after - before)[:, :3], axis=1),
    )


def joined(parts: list[Smoothness]) -> Smoothness:
    """Combines the smoothness of several captures."""
    return Smoothness(
        np.concatenate([p.acceleration for p in parts]),
        np.concatenate([p.jump for p in parts]),
        np.concatenate([p.largest_joint for p in parts]),
        np.concatenate([p.wrist_jump for p in parts]),
    )
