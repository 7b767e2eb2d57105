"""Hands as a headset reports their joints, by our own forward model."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from encoders.air.joint_fit import KNUCKLES, THUMB, TIPS, JointPoints
from models.arithmetic import Array
from models.frames import TrackedHand
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION
from models.skeleton import ADULT, Skeleton
from sandbox.devices.webxr.joints import seen_hand
from sandbox.server.protocol import JOINTS_OF_A_HAND, SeenJoints

TWISTS = np.array(
    [
        3 * i + axis
        for i, bone in enumerate(ADULT.bones)
        if bone.finger > 0
        for axis in ((1,) if i in ADULT.first_bone else (1, 2))
    ]
)
"""Components of the joints that positions tell poorly: twist, and sideways play of hinges."""


def any_pose(rng: np.random.Generator) -> Array:
    """(48,) a pose anywhere, its joints within nine tenths of their ranges, without twist."""
    q = np.zeros(POSE_SIZE)
    q[ROOT_POSITION] = rng.uniform(-0.2, 0.2, 3)
    q[ROOT_ROTATION] = rng.normal(0.0, 0.8, 3)
    joints = rng.uniform(0.9 * ADULT.lower, 0.9 * ADULT.upper)
    joints[TWISTS] = 0.0
    q[JOINTS] = joints
    return q


def points(q: Array, skeleton: Skeleton = ADULT) -> Array:
    """(20, 3) m, points of a right hand in a pose (48,)."""
    return JointPoints(skeleton).points(q)


def seen(points: Array, side: str = "right") -> TrackedHand:
    """A hand with points (20, 3) as a headset's page reports it."""
    places = np.zeros((JOINTS_OF_A_HAND, 3))
    places[0] = points[0]
    places[1:3], places[4] = points[THUMB : THUMB + 2], points[TIPS]
    places[3] = 0.5 * (places[2] + places[4])
    for finger, first in enumerate(KNUCKLES, start=1):
        places[5 * finger] = 0.5 * (points[0] + points[first])
        places[5 * finger + 1 : 5 * finger + 4] = points[first : first + 3]
        places[5 * finger + 4] = points[TIPS + finger]
    joints = [(x, y, z) for x, y, z in places.tolist()]
    hand = seen_hand(SeenJoints("left" if side == "left" else "right", joints))
    assert hand is not None
    return hand


def joints(seed: int = 1, side: str = "right", size: float = 1.0) -> dict[str, object]:
    """A hand as a page sends it, without the fingers' metacarpals."""
    hand = seen(points(any_pose(np.random.default_rng(seed)), ADULT.scaled(size)), side)
    assert hand.wrist is not None
    places: list[Sequence[float] | None] = [None] * JOINTS_OF_A_HAND
    places[0] = hand.wrist
    for finger in hand.fingers:
        first = 1 if finger.finger == 0 else 5 * (finger.finger or 0) + 1
        assert finger.joints is not None
        places[first : first + 4] = finger.joints
    return {"side": side, "joints": places}
