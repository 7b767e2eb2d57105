"""Handedness: which side a hand is of, by the volume that its fingers span, with its sign.

Three directions of a hand are as long as one: across the knuckles from its last finger to the
index, along the straight fingers, and the way that fingertips go when fingers bend. Their triple
product is a volume between -1 and 1, positive for right hands and negative for left ones. It does
not depend on the size of the hand or its proportions, which differ between robots and people more
than their sides do. It changes its sign if the fingers are given from the other side on, so their
order is looked at, too: the thumb's tip is nearest to that of the index finger.
"""

from __future__ import annotations

import math
from itertools import combinations

import numpy as np

from models.arithmetic import Array, length
from models.frames import FINGERS
from models.pose import JOINTS, POSE_SIZE
from models.robot.robot_model import RobotModel
from models.single_pose import SinglePose
from models.skeleton import Skeleton

STRAIGHT, BENT = 0.1, 0.7
"""Shares of the range of flexion."""
NEARER = 0.03
"""Share of its distance by which a thumb's tip must be nearer to a finger's to lie on its side."""
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


def order_of(robot: RobotModel) -> list[int]:
    """The numbers of the fingers without the thumb, 1 to n - 1, as they lie in the hand.

    The first is the one beside the thumb. If the thumb is about as far from both outer fingers, it
    is that with the smaller number.
    """
    knuckles, tips = robot.bent(STRAIGHT)
    fingers = range(1, len(knuckles))
    ends = max(
        combinations(fingers, 2), key=lambda pair: length(knuckles[pair[1]] - knuckles[pair[0]])
    )
    across = knuckles[ends[1]] - knuckles[ends[0]]
    order = sorted(fingers, key=lambda finger: float(np.sum(knuckles[finger] * across)))
    near, far = (length(tips[0] - tips[order[end]]) for end in (0, -1))
    beside = near > far if abs(near - far) > NEARER * max(near, far) else order[0] > order[-1]
    return order[::-1] if beside else order


def person_volume(person: Skeleton, fingers: int = len(FINGERS)) -> float:
    """The volume of a person's hand, by the first of its fingers, the thumb among them."""
    knuckles = np.array([person.bones[bone].anchor for bone in person.first_bone])
    straight, bent = (SinglePose(person).tips(flexed(person, share)) for share in (STRAIGHT, BENT))
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
