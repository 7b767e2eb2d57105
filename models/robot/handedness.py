"""Handedness: which side a hand is of, by the volume that its fingers span, with its sign.

Three directions of a hand are as long as one: across the knuckles from its last finger to the
index, along the straight fingers, and the way that fingertips go when fingers bend. Their triple
product is a volume between -1 and 1, positive for right hands and negative for left ones. It does
not depend on the size of the hand or its proportions, which differ between robots and people more
than their sides do.
"""

from __future__ import annotations

import math

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length
from models.frames import FINGERS
from models.one_pose import OnePose
from models.pose import JOINTS, POSE_SIZE
from models.robot.robot_model import RobotModel
from models.skeleton import Skeleton

STRAIGHT, BENT = 0.1, 0.7
"""Shares of the range of flexion."""
LEAST_WAY = 1e-6
"""m, below which a direction has none."""


def volume(knuckles: Array, straight: Array, bent: Array) -> float:
    """The volume with its sign, -1 to 1; NaN for fingers that do not bend, as without ranges.

    Args:
        knuckles: (n, 3) m, where the fingers begin, from the index finger on.
        straight: (n, 3) m, their tips when they are straight.
        bent: (n, 3) m, their tips when they are bent.
    """
    across = knuckles[0] - knuckles[-1]
    along = np.mean(straight - knuckles, axis=0)
    closing = np.mean(bent - straight, axis=0)
    sides = (across, along, closing)
    if min(length(side) for side in sides) < LEAST_WAY:
        return math.nan
    (a, b, c), (d, e, f), (g, h, i) = (side / np.sqrt(np.sum(side * side)) for side in sides)
    return float(a * (e * i - f * h) + b * (f * g - d * i) + c * (d * h - e * g))


def robot_volume(robot: RobotModel) -> float:
    """The volume of a robot's hand."""
    knuckles, straight = robot.bent(STRAIGHT)
    return volume(knuckles[1:], straight[1:], robot.bent(BENT)[1][1:])


def person_volume(person: Skeleton, fingers: int = len(FINGERS)) -> float:
    """The volume of a person's hand, by the first of its fingers, the thumb among them."""
    knuckles = np.array([person.bones[bone].anchor for bone in person.first_bone])
    straight, bent = (OnePose(person).tips(flexed(person, share)) for share in (STRAIGHT, BENT))
    own = slice(1, fingers)
    return volume(knuckles[own], straight[own], bent[own])


def flexed(person: Skeleton, share: float) -> Array:
    """The pose (48,) of a hand at the origin with all fingers bent alike.

    Args:
        person: The hand.
        share: How far, of the range of flexion.
    """
    q = np.zeros(POSE_SIZE)
    # Flexion of a bone is a negative turn about its x axis.
    q[JOINTS][::3] = (person.upper + share * (person.lower - person.upper))[::3]
    return q
