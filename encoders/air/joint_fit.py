"""Fits the pose of a hand of known size to the joints that a headset reports.

The palm is laid on the reported wrist and knuckles, and every bone is rotated into the direction
between the reported joints at its ends. A few Gauss-Newton steps then move the points of our hand
to the reported points. Tips are met nearly exactly. Other points are met only approximately, since
our bones differ in length from the person's. Joints stay in their ranges. Angles that do not follow
from positions, such as the twist of a stretched finger, stay in the middle of their ranges.

Each frame is solved separately, so a replay may begin anywhere.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import atan2, radians
from typing import NamedTuple

import numpy as np

from encoders.air.landmark_fit import bounded_step, stepped, turn_between
from models.arithmetic import (
    Array,
    Mask,
    distance,
    length,
    small_product,
    squared_lengths,
    stacked_applied,
    transposed_times,
)
from models.frames import FINGERS, TrackedHand
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp
from models.single_pose import SinglePose
from models.skeleton import Skeleton

WRIST, THUMB, KNUCKLES, TIPS = 0, 1, (3, 6, 9, 12), 15
"""Indices in the list of points: the wrist, the thumb's first joint, the fingers' first joints, and
the first of the five tips."""
PALM = (WRIST, *KNUCKLES)
"""Points whose distances from each other do not depend on the fingers' postures."""
COUNT = TIPS + len(FINGERS)
SPREAD = np.array([0.012, 0.010, 0.006, *(0.004, 0.003, 0.003) * 4, *(0.001,) * 5])
"""Standard deviations (20,) m of the points. Those of the tips are smallest, since tips hold
objects. The wrist and the thumb's root lie elsewhere in a device's hand than in ours."""

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

        Derivatives with respect to the root's rotation follow the convention of
        `SinglePose.joints_and_jacobian`. Those with respect to its position use the world's axes.
        """
        points, jacobian = self._pose.joints_and_jacobian(q)
        whole = np.concatenate([q[None, ROOT_POSITION], points])
        return whole, np.concatenate([self._wrist, jacobian])


def seen_points(hand: TrackedHand) -> Array:
    """Points (20, 3) m of a reported hand; NaN for missing points."""
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
    """Length of a reported hand relative to a skeleton: the median of the ratios of its fingers'
    bones.

    The thumb is not used. None if the joints of no other finger are reported.
    """
    lengths = {f: [b.length for b in skeleton.bones if b.finger == f] for f in range(len(FINGERS))}
    ratios = []
    for finger in hand.fingers:
        if finger.finger and finger.joints is not None:
            # The last bone is left out: it ends at the skin or within the tip, depending on the
            # device.
            bones = list(pairwise(finger.joints))[:-1]
            own = lengths[finger.finger][:-1]
            ratios += [distance(a, b) / ours for (a, b), ours in zip(bones, own, strict=True)]
    ratios.sort()
    return ratios[len(ratios) // 2] if ratios else None


@dataclass(frozen=True)
class JointFitSettings:
    """Weights of the fit, and its largest number of steps.

    Attributes:
        twist: Standard deviation of the twist of a finger's first bone (degrees).
        play: Standard deviation of twist and sideways play of a finger's other joints (degrees).
        thumb: Standard deviation of the thumb's joints about their middle (degrees).
        free: Standard deviation of angles that the joints' positions determine well (degrees).
        steps: Largest number of Gauss-Newton steps.
    """

    twist: float = 6.0
    play: float = 2.0
    thumb: float = 60.0
    free: float = 1000.0
    steps: int = 4


class JointsFitted(NamedTuple):
    """A fitted pose.

    Attributes:
        pose: (48,) in the frame of the points.
        error: Root mean square distance (m) of the tips from the reported tips.
    """

    pose: Array
    error: float


class JointFit:
    """Fits one right hand.

    Args:
        skeleton: The right hand's skeleton, of the person's size.
        settings: Weights of the fit.
    """

    def __init__(self, skeleton: Skeleton, settings: JointFitSettings | None = None) -> None:
        self.settings = s = settings or JointFitSettings()
        self._skeleton, self._points = skeleton, JointPoints(skeleton)
        self._palm = self._points.points(np.zeros(POSE_SIZE))[list(PALM)]
        self._lower, self._upper = skeleton.lower, skeleton.upper
        self._prior = _prior(skeleton, s)

    def fit(self, seen: Array) -> JointsFitted | None:
        """Fits a hand; None without the wrist and at least three knuckles.

        Args:
            seen: (20, 3) m, points of a right hand from `seen_points`, NaN where a point is
                missing.
        """
        there: Mask = np.isfinite(squared_lengths(seen))
        palm = there[list(PALM)]
        if not palm[0] or int(palm.sum()) < len(KNUCKLES):
            return None
        q = self._laid(seen[list(PALM)], palm)
        self._turn_bones(q, seen, there)
        weight = np.where(there, 1.0 / SPREAD, 0.0)
        wanted = np.where(there[:, None], seen, 0.0)
        for _ in range(self.settings.steps):
            points, jacobian = self._points.points_and_jacobian(q)
            rows = (jacobian * weight[:, None, None]).reshape(-1, POSE_SIZE)
            missed = ((points - wanted) * weight[:, None]).reshape(-1, 1)
            square = transposed_times(rows, rows)
            down = transposed_times(rows, missed)[:, 0]
            square[np.diag_indices(POSE_SIZE)] += self._prior
            down[JOINTS] += self._prior[JOINTS] * q[JOINTS]
            step = bounded_step(q, square, down, self._lower, self._upper)
            q = stepped(q, step, self._lower, self._upper)
            if float(np.abs(step).max()) < _STILL:
                break
        tips = (self._points.points(q) - wanted)[TIPS:][there[TIPS:]]
        error = float(np.sqrt(squared_lengths(tips).mean())) if len(tips) else 0.0
        return JointsFitted(q, error)

    def _laid(self, palm: Array, there: Mask) -> Array:
        """The rest pose (48,), rotated and moved so that its knuckles lie on those of the reported
        palm (5, 3)."""
        q = np.zeros(POSE_SIZE)
        own = self._palm[there]
        q[ROOT_ROTATION] = turn_between(own, palm[there])
        turned = stacked_applied(exp(q[ROOT_ROTATION]), own)
        # If the palms differ in length, the wrists differ and the knuckles coincide.
        q[ROOT_POSITION] = (palm[there][1:] - turned[1:]).mean(axis=0)
        return q

    def _turn_bones(self, q: Array, seen: Array, there: Mask) -> None:
        """Turns every bone into the direction of its reported joints, by the smallest rotation.

        Changes `q`.
        """
        frame, finger = exp(q[ROOT_ROTATION]), -1
        for i, bone in enumerate(self._skeleton.bones):
            if bone.finger != finger:
                finger, frame = bone.finger, exp(q[ROOT_ROTATION])
            frame = small_product(frame, bone.rest)
            last = bone is self._skeleton.last_bones[finger]
            start, end = 1 + i, TIPS + finger if last else 2 + i
            if there[start] and there[end]:
                part = slice(JOINTS.start + 3 * i, JOINTS.start + 3 * i + 3)
                along = stacked_applied(frame.T, seen[end] - seen[start])
                turn = _shortest(along)
                bounds = self._lower[3 * i : 3 * i + 3], self._upper[3 * i : 3 * i + 3]
                q[part] = np.minimum(np.maximum(turn, bounds[0]), bounds[1])
                frame = small_product(frame, exp(q[part]))


_STILL = 1e-5
"""Length (m or rad) of a step below which the search ends."""


def _shortest(along: Array) -> Array:
    """The smallest rotation (3,), as a rotation vector, that turns y into a direction (3,)."""
    x, y, z = along.tolist()
    across = length(np.array([x, z]))
    if across == 0.0:
        return np.zeros(3)
    angle = atan2(across, y) / across
    return np.array([z * angle, 0.0, -x * angle])


def _prior(skeleton: Skeleton, s: JointFitSettings) -> Array:
    """Precisions (48,) in 1/rad2 of the joints' components about their middle; 0 for the root."""
    spread = []
    for i, bone in enumerate(skeleton.bones):
        if bone.finger == 0:
            spread += [s.thumb] * 3
        elif i in skeleton.first_bone:
            spread += [s.free, s.twist, s.free]
        else:
            spread += [s.free, s.play, s.play]
    prior = np.zeros(POSE_SIZE)
    prior[JOINTS] = [radians(degrees) ** -2 for degrees in spread]
    return prior
