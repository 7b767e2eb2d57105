"""Poses of a hand that holds a box between two fingertips."""

from __future__ import annotations

import numpy as np

from encoders.correction import FingertipCorrection
from models.arithmetic import Array
from models.kinematics import Kinematics
from models.objects import Box
from models.skeleton import ADULT

GUESS_COVARIANCE = np.diag([0.025**2] * 3 + [0.25**2] * 45)
"""Covariance (m2, rad2) of the first guess of the pose, which is very uncertain."""

COMFORTABLE_AXIS = np.deg2rad(52.0)
"""Angle (rad) from the hand's x axis to the line from thumb to index fingertip, in the palm's
plane."""


def pinch_poses(box: Box, squeeze: float = 0.003, opening: float = 0.005) -> tuple[Array, Array]:
    """Returns two poses (48,) of a right hand with thumb and index finger at opposite faces of a
    box.

    Args:
        box: The box in its first position.
        squeeze: Depth (m) of the fingertips inside the faces in the second pose.
        opening: Distance (m) of the fingertips from the faces in the first pose.
    """
    kinematics = Kinematics(ADULT)
    correction = FingertipCorrection(kinematics.skeleton, GUESS_COVARIANCE)
    labels = [0, 1]
    centre = np.asarray(box.position)
    along = np.array([np.cos(box.yaw), np.sin(box.yaw), 0.0])
    guess = np.zeros(48)
    guess[5] = box.yaw - COMFORTABLE_AXIS
    guess[:3] = centre - kinematics.tips(guess)[labels].mean(axis=0)
    poses = []
    for gap in (opening, -squeeze):
        reach = box.half_size[0] + gap + ADULT.tip_radius[labels]
        targets = centre + np.outer([-reach[0], reach[1]], along)
        corrected = correction.correct(guess, labels, targets)
        assert corrected.error < 0.001
        poses.append(corrected.q)
    return poses[0], poses[1]
