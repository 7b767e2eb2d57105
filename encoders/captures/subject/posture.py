"""The subject's anatomy: 27 hinge angles, their covariance, and the posture at rest."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from encoders.captures.subject.configuration import SubjectConfiguration
from models.arithmetic import Array
from models.pose import POSE_SIZE
from models.rotations import exp
from models.skeleton import Skeleton

FREEDOMS = 27
"""Anatomic degrees of freedom: root 6, thumb 5, four for each other finger."""

FLEXION, TWIST, ABDUCTION = np.array([-1.0, 0, 0]), np.array([0, 1.0, 0]), np.array([0, 0, 1.0])
"""Axes in the bones' frames: a positive flexion closes the hand."""

_THUMB = 6
"""First freedom of the thumb: CMC flexion, abduction, twist, MCP flexion, abduction."""
_FINGERS = (11, 15, 19, 23)
"""First freedom of the other fingers: MCP flexion, MCP abduction, PIP, DIP."""


@dataclass(frozen=True)
class Anatomy:
    """A subject's hand: its hinges and the covariance of its postures.

    Attributes:
        hinges: (48, 27) matrix from degrees of freedom to the pose: q = hinges @ theta. The joints
            with two and three degrees of freedom combine them as components of one rotation vector,
            as eye and shoulder nearly do (Listing's law). Columns of the root are units.
        covariance: (27, 27) of the posture the subject aims at.
    """

    hinges: Array
    covariance: Array


def anatomy(
    rng: np.random.Generator, skeleton: Skeleton, configuration: SubjectConfiguration
) -> Anatomy:
    """Draws a subject's anatomy; hinge axes differ from the bones' own by a few degrees at
    random."""
    hinges = np.zeros((POSE_SIZE, FREEDOMS))
    hinges[:6, :6] = np.eye(6)
    for freedom, (bone, axis) in enumerate(_freedoms(), start=6):
        tilt = np.clip(rng.normal(0, configuration.hinge_tilt, 3), -0.06, 0.06)
        rows = slice(6 + 3 * bone, 9 + 3 * bone)
        hinges[rows, freedom] = exp(tilt) @ axis
    if hinges.shape[0] != 6 + 3 * len(skeleton.bones):
        raise AssertionError("the table of freedoms is that of 14 bones")
    return Anatomy(hinges, _covariance(configuration))


def _freedoms() -> list[tuple[int, Array]]:
    """Bone and axis of every degree of freedom of the fingers."""
    thumb = [(0, FLEXION), (0, ABDUCTION), (0, TWIST), (1, FLEXION), (1, ABDUCTION)]
    fingers = [
        (2 + 3 * finger + bone, axis)
        for finger in range(4)
        for bone, axis in ((0, FLEXION), (0, ABDUCTION), (1, FLEXION), (2, FLEXION))
    ]
    return [*thumb, *fingers]


def _covariance(configuration: SubjectConfiguration) -> Array:
    """Covariance (27, 27): six synergies, and a remainder in which neighbouring fingers move alike.

    Because of these correlations a lifted finger is not free: given the touching ones, the most
    likely posture moves it along (enslaving).
    """
    c = configuration
    loadings = _synergies() * np.array(c.synergy_spread)[:, None]
    covariance = loadings.T @ loadings
    root = np.array([*c.root_position_spread, *c.root_rotation_spread])
    covariance[range(6), range(6)] += root**2
    thumb = np.arange(_THUMB, _THUMB + 5)
    covariance[thumb, thumb] += np.array(c.thumb_spread) ** 2
    distance = np.abs(np.subtract.outer(np.arange(4), np.arange(4)))
    for k, spread in enumerate(c.finger_spread):
        rows = np.array(_FINGERS) + k
        covariance[np.ix_(rows, rows)] += spread**2 * c.neighbour**distance
    return covariance


def _synergies() -> Array:
    """Loadings (6, 27) of the synergies, the largest of each 1."""
    out = np.zeros((6, FREEDOMS))
    flex_all, knuckles, gradient, opposing, spreading, thumb_flexion = out
    for finger, start in enumerate(_FINGERS):
        side = (-1.0, -0.35, 0.35, 1.0)[finger]
        flex_all[start : start + 4] = 0.8, 0.0, 1.0, 0.65
        knuckles[start : start + 4] = 1.0, 0.0, -0.9, -0.55
        gradient[start : start + 4] = 0.9 * side, 0.0, side, 0.6 * side
        # Counterclockwise seen from the back of the hand is towards the thumb.
        spreading[start + 1] = -0.5 * side
    flex_all[_THUMB : _THUMB + 5] = 0.4, 0.0, 0.0, 0.7, 0.0
    opposing[_THUMB : _THUMB + 5] = 0.3, -1.0, 0.6, 0.2, 0.0
    spreading[_THUMB : _THUMB + 5] = 0.0, 1.0, 0.0, -0.2, 0.0
    thumb_flexion[_THUMB : _THUMB + 5] = 0.8, 0.0, 0.0, 1.0, 0.0
    return out


def lifting(curled: bool) -> Array:
    """Units (5, 27) by which a lifted finger's joints turn, finger by finger.

    Most people stretch a finger to lift it from the surface; some curl it.
    """
    out = np.zeros((5, FREEDOMS))
    out[0, _THUMB : _THUMB + 5] = (0.6, 0, 0, 0.8, 0) if curled else (-0.9, 0, 0, -0.5, 0)
    for finger, start in enumerate(_FINGERS, start=1):
        out[finger, start : start + 4] = (-0.2, 0, 1.6, 1.0) if curled else (-1.0, 0, -0.4, -0.2)
    return out
