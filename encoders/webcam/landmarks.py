"""Which landmark of a picture is which point of our hand.

The thumb's IP joint (landmark 3) has no counterpart: our thumb's last joint is fixed, and its tip
is fitted instead.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from models.arithmetic import Array
from models.pose import POSE_SIZE, ROOT_POSITION
from models.single_pose import SinglePose
from models.skeleton import Skeleton

WRIST = 0
KNUCKLES = (5, 9, 13, 17)
PALM = (WRIST, *KNUCKLES)
"""Landmarks that keep their distances whatever the fingers do."""
OF_POINTS = (WRIST, 1, 2, *(k + i for k in KNUCKLES for i in range(3)), 4, 8, 12, 16, 20)
"""Landmark of each point of `HandPoints`: wrist, 14 joints, 5 tips."""

_KNUCKLE_POINTS = (3, 6, 9, 12)

TIP_BEYOND = 0.5
"""Share of a fingertip's radius by which the engine's landmark of a tip lies beyond the centre of
our tip's sphere, along the bone."""


class HandPoints:
    """The points of one right hand that have a landmark, and their derivative.

    Args:
        skeleton: A right hand.
    """

    def __init__(self, skeleton: Skeleton) -> None:
        last = {id(bone) for bone in skeleton.last_bones.values()}
        longer = tuple(
            replace(b, length=b.length + TIP_BEYOND * b.radius) if id(b) in last else b
            for b in skeleton.bones
        )
        self._pose = SinglePose(replace(skeleton, bones=longer))
        self._wrist = np.zeros((1, 3, POSE_SIZE))
        self._wrist[0, :, ROOT_POSITION] = np.eye(3)
        self.count = len(OF_POINTS)

    def points(self, q: Array) -> Array:
        """Points (20, 3) m of a pose (48,)."""
        joints, tips = self._pose.joints_and_tips(q)
        return np.concatenate([q[None, ROOT_POSITION], joints, tips])

    def points_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Points (20, 3), and their derivative (20, 3, 48).

        By the root's rotation it is as in `SinglePose.joints_and_jacobian`, and by its position
        along the axes of the pose's frame.
        """
        points, jacobian = self._pose.joints_and_jacobian(q)
        whole = np.concatenate([q[None, ROOT_POSITION], points])
        return whole, np.concatenate([self._wrist, jacobian])

    def palm(self) -> Array:
        """Points (5, 3) m of the palm's landmarks in the hand's own frame."""
        points = self.points(np.zeros(POSE_SIZE))
        return points[[0, *_KNUCKLE_POINTS]]
