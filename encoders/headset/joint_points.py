"""Which point of our hand is which joint of a seen hand, and how far each is to be trusted.

A headset reports a thumb with a joint more than ours has: its IP joint. Ours is fixed, so the
thumb's tip is fitted instead (`models.skeleton`).
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from models.arithmetic import Array, distance
from models.frames import FINGERS, TrackedHand
from models.pose import POSE_SIZE, ROOT_POSITION
from models.single_pose import SinglePose
from models.skeleton import Skeleton

WRIST, THUMB, KNUCKLES, TIPS = 0, 1, (3, 6, 9, 12), 15
"""Places in the list of points: the wrist, the thumb's first joint, the fingers' first joints, and
the first of the five tips."""
PALM = (WRIST, *KNUCKLES)
"""Points that keep their distances whatever the fingers do."""
COUNT = TIPS + len(FINGERS)
SPREAD = np.array([0.012, 0.010, 0.006, *(0.004, 0.003, 0.003) * 4, *(0.001,) * 5])
"""(20,) m, standard deviations of the points: tips must be where the person's are, since they hold
things; the wrist and the thumb's root lie elsewhere in a device's hand than in ours."""

_JOINTS: dict[int, tuple[int | None, ...]] = {0: (THUMB, THUMB + 1, None)}
_JOINTS |= {label: (k, k + 1, k + 2) for label, k in enumerate(KNUCKLES, start=1)}
"""Finger -> point of each of its joints; None for the thumb's IP joint."""


class JointPoints:
    """The points of one right hand that a headset reports, and their derivative.

    Args:
        skeleton: A right hand.
    """

    def __init__(self, skeleton: Skeleton) -> None:
        self._pose = SinglePose(skeleton)
        self._wrist = np.zeros((1, 3, POSE_SIZE))
        self._wrist[0, :, ROOT_POSITION] = np.eye(3)

    def points(self, q: Array) -> Array:
        """Points (20, 3) m of a pose (48,)."""
        joints, tips = self._pose.joints_and_tips(q)
        return np.concatenate([q[None, ROOT_POSITION], joints, tips])

    def points_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Points (20, 3), and their derivative (20, 3, 48).

        By the root's rotation it is as in `SinglePose.joints_and_jacobian`, and by its position
        along the world's axes.
        """
        points, jacobian = self._pose.joints_and_jacobian(q)
        whole = np.concatenate([q[None, ROOT_POSITION], points])
        return whole, np.concatenate([self._wrist, jacobian])


def seen_points(hand: TrackedHand) -> Array:
    """(20, 3) m, points of a seen hand; those that it lacks are not a number."""
    points = np.full((COUNT, 3), np.nan)
    if hand.wrist is not None:
        points[WRIST] = hand.wrist
    for finger in hand.fingers:
        if finger.finger is None or finger.joints is None:
            continue
        for place, joint in zip(_JOINTS[finger.finger], finger.joints[:-1], strict=True):
            if place is not None:
                points[place] = joint
        points[TIPS + finger.finger] = finger.joints[-1]
    return points


def seen_size(hand: TrackedHand, skeleton: Skeleton) -> float | None:
    """Length of a seen hand relative to a skeleton: the middle one of its fingers' bones' ratios.

    None if no finger has its joints.
    """
    lengths = {f: [b.length for b in skeleton.bones if b.finger == f] for f in range(len(FINGERS))}
    ratios = []
    for finger in hand.fingers:
        if finger.finger and finger.joints is not None:
            # The last bone ends at the skin on some devices, and within the tip on others.
            bones = list(pairwise(finger.joints))[:-1]
            own = lengths[finger.finger][:-1]
            ratios += [distance(a, b) / ours for (a, b), ours in zip(bones, own, strict=True)]
    ratios.sort()
    return ratios[len(ratios) // 2] if ratios else None
