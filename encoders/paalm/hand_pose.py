"""From PAALM's angles and palm to the pose `q` of the sandbox's hand."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from encoders.paalm.angles import FRAMES
from encoders.paalm.palm import Palm
from models.frames import Vector
from models.limits import within_limits
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION, mirrored
from models.rotations import exp, log
from models.skeleton import ADULT, Skeleton

Array = NDArray[np.float64]

PALM_CENTRE = (0.0, 0.055, -0.005)
"""m, of the average hand in its own frame: between wrist and knuckles, on the palm's side. Where
exactly a device has a palm's centre is not documented."""

_MIRROR = np.array([-1.0, 1.0, 1.0])


def hand_pose(
    table: ArrayLike,
    palm: Palm,
    side: str = "right",
    device: Vector = (0.0, 0.0, 0.0),
    skeleton: Skeleton = ADULT,
    size: float = 1.0,
) -> Array:
    """The pose (48,) in the world, within the skeleton's limits.

    A left pose is the mirror image of what a right hand would do behind the mirror, as everywhere.
    The thumb's last joint, which the skeleton has not, is left out.

    Args:
        table: (5, 4) degrees, see `encoders.paalm.angles`.
        palm: In the device's frame.
        side: `right` or `left`; the skeleton is always given as a right hand.
        device: m, where the device is in the world; its axes are the world's.
        skeleton: A right hand.
        size: Length of the hand that takes the pose against the skeleton.
    """
    angles = np.deg2rad(np.asarray(table, float))
    rotation, origin = palm.rotation, np.add(palm.origin, device)
    if side == "left":
        rotation, origin = _MIRROR[:, None] * rotation, _MIRROR * origin
    q = np.zeros(POSE_SIZE)
    q[ROOT_ROTATION] = log(rotation)
    q[ROOT_POSITION] = origin - rotation @ np.multiply(size, PALM_CENTRE)
    turns = []
    before = np.eye(3)
    last = -1
    for bone in skeleton.bones:
        if bone.finger != last:
            last, column, before = bone.finger, 1, np.eye(3)
            flexion, spread = angles[last, 0], angles[last, 1]
            now = FRAMES[last] @ exp((-flexion, 0.0, 0.0)) @ exp((0.0, 0.0, spread))
        else:
            column += 1
            now = before @ exp((-angles[last, column], 0.0, 0.0))
        turns.append(bone.rest.T @ before.T @ now)
        before = now
    q[JOINTS] = log(np.array(turns)).reshape(-1)
    q = within_limits(q, skeleton)
    return mirrored(q) if side == "left" else q
