"""Converts PAALM's angles and palm to the pose `q` of the sandbox's hand."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from encoders.paalm.angles import FRAMES
from encoders.paalm.palm import Palm
from models import arithmetic
from models.arithmetic import Array, stacked_applied, stacked_product
from models.frames import FINGERS, Vector
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION, mirrored, within_limits
from models.rotations import log_of_axes, matrix_to_quaternion, quaternion_log
from models.skeleton import ADULT, Skeleton

PALM_CENTRE = (0.0, 0.055, -0.005)
"""Palm centre (m) of the average hand in the hand's frame, between wrist and knuckles on the palmar
side. Devices do not document the exact position of their palm centre."""

_HALF = 0.5 * np.deg2rad(1.0)
"""Half a degree in rad, because quaternions contain half the angle."""
_COLUMNS = (0, 2, 3)
"""Columns of a table of angles with the flexion of a finger's first, second and third bone."""


class HandPoser:
    """Computes poses of a hand with one skeleton, with all joints in one array operation.

    A bone is rotated from its rest by flexion about its x axis and then, for a finger's first bone,
    by spread about its z axis. The rotation between the bone's rest and the frame of these angles
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
            # A 0 is appended to the table as the spread of all bones but the first.
            spread.append(4 * last + 1 if first else 4 * len(FINGERS))
            between.append(stacked_product(bone.rest.T, FRAMES[last]) if first else bone.rest.T)
        self._flexion, self._spread = np.array(flexion), np.array(spread)
        # Matrices (n, 4, 4) that multiply by the constant quaternion from the left.
        w, x, y, z = matrix_to_quaternion(np.array(between)).T
        self._between = np.array(
            [[w, -x, -y, -z], [x, w, -z, y], [y, z, w, -x], [z, -y, x, w]]
        ).transpose(2, 0, 1)

    def __call__(
        self,
        tables: ArrayLike,
        palms: Sequence[Palm],
        side: str = "right",
        device: Vector = (0.0, 0.0, 0.0),
        size: float = 1.0,
    ) -> Array:
        """Poses (n, 48) of tables (n, 5, 4) and n palms; see `hand_pose`."""
        angles = np.zeros((len(palms), 4 * len(FINGERS) + 1))
        angles[:, :-1] = np.asarray(tables, float).reshape(-1, 4 * len(FINGERS))
        half = _HALF * angles
        cosines, sines = arithmetic.cos(half), arithmetic.sin(half)
        bent, spread = cosines[:, self._flexion], cosines[:, self._spread]
        bent_s, spread_s = -sines[:, self._flexion], sines[:, self._spread]
        # (bent + bent_s i) (spread + spread_s k)
        turn = np.stack(
            [bent * spread, bent_s * spread, -bent_s * spread_s, bent * spread_s], axis=-1
        )
        q = np.empty((len(palms), POSE_SIZE))
        vectors = quaternion_log(stacked_applied(self._between, turn))
        q[:, JOINTS] = vectors.reshape(len(palms), POSE_SIZE - JOINTS.start)
        for pose, palm in zip(q, palms, strict=True):
            pose[ROOT_POSITION], pose[ROOT_ROTATION] = _root(palm, side, device, size)
        q = within_limits(q, self._skeleton)
        return mirrored(q) if side == "left" else q


def _root(palm: Palm, side: str, device: Vector, size: float) -> tuple[Vector, Vector]:
    """Position (m) and rotation vector (rad) of the root for a palm.

    For a left palm, the root is that of its mirror image, a right hand.
    """
    flip = -1.0 if side == "left" else 1.0
    a, f, d = palm.across, palm.forward, palm.dorsal
    across, forward, dorsal = (
        (flip * a[0], a[1], a[2]),
        (flip * f[0], f[1], f[2]),
        (flip * d[0], d[1], d[2]),
    )
    u, v, w = (size * c for c in PALM_CENTRE)
    ox, oy, oz = (o + at for o, at in zip(palm.origin, device, strict=True))
    position = (
        flip * ox - (across[0] * u + forward[0] * v + dorsal[0] * w),
        oy - (across[1] * u + forward[1] * v + dorsal[1] * w),
        oz - (across[2] * u + forward[2] * v + dorsal[2] * w),
    )
    return position, log_of_axes(across, forward, dorsal)


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

    For a left hand, the pose is that of the mirrored skeleton. The thumb's last joint is left out,
    since the skeleton does not have it.

    Args:
        table: (5, 4) degrees, see `encoders.paalm.angles`.
        palm: The palm in the device's frame.
        side: `right` or `left`.
        device: Position (m) of the device in the world; its axes are the world's.
        skeleton: Skeleton of a right hand, also if `side` is `left`.
        size: Length of the posed hand relative to the skeleton.
    """
    make = _ADULT if skeleton is ADULT else HandPoser(skeleton)
    return make(np.asarray(table, float)[None], [palm], side, device, size)[0]
