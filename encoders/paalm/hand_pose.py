"""Converts PAALM's angles and palm to the pose `q` of the sandbox's hand."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from encoders.paalm.angles import FRAMES
from encoders.paalm.palm import Palm
from models.arithmetic import functions
from models.arithmetic.arrays import Array
from models.arithmetic.products import stacked_applied, stacked_product
from models.frames import FINGERS, Vector
from models.limits import within_limits
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION, mirrored
from models.rotations import log_of_axes, matrix_to_quaternion, quaternion_log
from models.skeleton import ADULT, Skeleton

PALM_CENTRE = (0.0, 0.055, -0.005)
"""m, palm centre of the average hand in its own frame: between wrist and knuckles, on the palm's
side. Devices do not document the exact place of a palm's centre."""

_COLUMNS = (0, 2, 3)
"""Columns of a table of angles that bend a finger's first, second and third bone."""


class HandPoser:
    """Computes poses of one skeleton's hand, all joints in one calculation.

    A bone is rotated from its rest by flexion about its x axis and then, for a finger's first bone,
    by spread about its z axis. The rotation between the bone's rest and the frame of those angles
    is constant.

    Args:
        skeleton: A right hand.
    """

    def __init__(self, skeleton: Skeleton = ADULT) -> None:
        self._skeleton = skeleton
        flexion, spread, between = [], [], []
        row, last = 0, -1
        for bone in skeleton.bones:
            first = bone.finger != last
            row, last = (0 if first else row + 1), bone.finger
            flexion.append(4 * last + _COLUMNS[row])
            # Behind the table is an angle 0, the spread of all bones but the first.
            spread.append(4 * last + 1 if first else 4 * len(FINGERS))
            between.append(stacked_product(bone.rest.T, FRAMES[last]) if first else bone.rest.T)
        self._which = np.array([flexion, spread])
        self._half = np.deg2rad(np.array([[-0.5], [0.5]]))
        self._angles = np.zeros(4 * len(FINGERS) + 1)
        # (n, 4, 4): the product with the constant quaternion from the left.
        w, x, y, z = matrix_to_quaternion(np.array(between)).T
        self._between = np.array(
            [[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]
        ).transpose(2, 0, 1)
        self._turn = np.empty((len(flexion), 4))

    def __call__(
        self,
        table: ArrayLike,
        palm: Palm,
        side: str = "right",
        device: Vector = (0.0, 0.0, 0.0),
        size: float = 1.0,
    ) -> Array:
        """The pose (48,); arguments are those of `hand_pose`."""
        self._angles[:-1] = np.asarray(table, float).ravel()
        half = self._angles.take(self._which) * self._half
        (bent, spread), (bent_s, spread_s) = functions.cos(half), functions.sin(half)
        turn = self._turn
        # (bent + bent_s i) (spread + spread_s k)
        np.multiply(bent, spread, turn[:, 0])
        np.multiply(bent_s, spread, turn[:, 1])
        np.multiply(-bent_s, spread_s, turn[:, 2])
        np.multiply(bent, spread_s, turn[:, 3])
        q = np.empty(POSE_SIZE)
        q[JOINTS] = quaternion_log(stacked_applied(self._between, turn)).ravel()
        # A left hand's pose is the mirror image of a right one's.
        flip = -1.0 if side == "left" else 1.0
        a, f, d = palm.across, palm.forward, palm.dorsal
        across, forward, dorsal = (
            (flip * a[0], a[1], a[2]),
            (flip * f[0], f[1], f[2]),
            (flip * d[0], d[1], d[2]),
        )
        q[ROOT_ROTATION] = log_of_axes(across, forward, dorsal)
        u, v, w = (size * c for c in PALM_CENTRE)
        ox, oy, oz = (o + at for o, at in zip(palm.origin, device, strict=True))
        q[ROOT_POSITION] = (
            flip * ox - (across[0] * u + forward[0] * v + dorsal[0] * w),
            oy - (across[1] * u + forward[1] * v + dorsal[1] * w),
            oz - (across[2] * u + forward[2] * v + dorsal[2] * w),
        )
        q = within_limits(q, self._skeleton)
        return mirrored(q) if side == "left" else q


_ADULT = HandPoser(ADULT)


def hand_pose(
    table: ArrayLike,
    palm: Palm,
    side: str = "right",
    device: Vector = (0.0, 0.0, 0.0),
    skeleton: Skeleton = ADULT,
    size: float = 1.0,
) -> Array:
    """The pose (48,) in the world, within the skeleton's limits.

    A left hand's pose is the mirror image of a right hand's, as everywhere. The thumb's last joint
    is left out, since the skeleton does not have it.

    Args:
        table: (5, 4) degrees, see `encoders.paalm.angles`.
        palm: The palm in the device's frame.
        side: `right` or `left`; the skeleton is always given as a right hand.
        device: m, position of the device in the world; its axes are the world's.
        skeleton: A right hand.
        size: Length of the posed hand relative to the skeleton.
    """
    make = _ADULT if skeleton is ADULT else HandPoser(skeleton)
    return make(table, palm, side, device, size)
