"""Named joint angles, and their computation from the positions of joints.

A finger has the angles MCP flexion and spread, PIP flexion and DIP flexion. The thumb has CMC
flexion and spread, MCP flexion and IP flexion. All are in degrees. Flexion closes the hand; spread
is positive towards the thumb. The first joint is rotated by flexion first, about the palm's line of
knuckles, then by spread. In this order, neither angle is singular for any pose of a finger. A
finger that points along the palm has zero angles. The thumb has zero angles in its rest pose of
`models.skeleton`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from models import arithmetic
from models.arithmetic import Array, stacked_applied
from models.frames import FINGERS
from models.skeleton import ADULT

PARTS = ("flexion", "spread", "pip", "dip")
"""Columns of a table of angles (5, 4): the first joint's flexion and spread, then the flexion of
the second and the third joint."""

NAMES: tuple[tuple[str, str, str, str], ...] = (
    ("thumb_cmc_flexion", "thumb_cmc_spread", "thumb_mcp_flexion", "thumb_ip_flexion"),
    *(
        (f"{f}_mcp_flexion", f"{f}_mcp_spread", f"{f}_pip_flexion", f"{f}_dip_flexion")
        for f in FINGERS[1:]
    ),
)
"""Name of every angle, by finger and column."""

FRAMES: Array = np.stack([ADULT.bones[0].rest, *np.tile(np.eye(3), (4, 1, 1))])
"""Rotations (5, 3, 3) from a finger's frame to palm coordinates. In the finger's frame, y is the
direction of zero angles, and z points to the dorsal side."""


def by_name(table: ArrayLike) -> dict[str, float]:
    """The angles of a table (5, 4) by their names, finger by finger."""
    rows = np.asarray(table, float).tolist()
    names = [name for finger in NAMES for name in finger]
    return dict(zip(names, (angle for row in rows for angle in row), strict=True))


def angles_of_joints(joints: ArrayLike) -> Array:
    """Angles (..., 5, 4), degrees, of joints (..., 5, 4, 3) in palm coordinates.

    The joints are knuckle, PIP, DIP and tip of each finger. The angle at the joint before a bone of
    length 0 is 0, as for the third bone of a thumb with two bones. The angle between two bones is
    the full angle, not its part in the plane of flexion. It is positive towards the palm.
    """
    joints = np.asarray(joints, float)
    bones = np.einsum("fji,...fbj->...fbi", FRAMES, np.diff(joints, axis=-2))
    lengths = np.linalg.norm(bones, axis=-1, keepdims=True)
    bones = np.divide(bones, lengths, out=np.zeros_like(bones), where=lengths > 1e-9)
    first = bones[..., 0, :]
    flexion = np.arctan2(-first[..., 2], first[..., 1])
    spread = np.arcsin(np.clip(-first[..., 0], -1.0, 1.0))
    # The side on which a finger bends: perpendicular to its bone, towards the palm.
    palmar = np.stack([np.zeros_like(flexion), -np.sin(flexion), -np.cos(flexion)], axis=-1)
    out = [flexion, spread]
    for bone in (1, 2):
        before, after = bones[..., bone - 1, :], bones[..., bone, :]
        across = np.cross(before, after)
        bend = np.arctan2(np.linalg.norm(across, axis=-1), np.sum(before * after, axis=-1))
        # Now `palmar` is perpendicular to the bone before. Below it is made perpendicular to this
        # bone.
        side = np.sum(palmar * after, axis=-1)
        out.append(np.where(side < 0.0, -bend, bend))
        palmar = palmar - np.sum(palmar * after, axis=-1, keepdims=True) * after
        size = np.linalg.norm(palmar, axis=-1, keepdims=True)
        straight_on = size < 1e-6
        palmar = np.where(straight_on, -before, palmar / np.where(straight_on, 1.0, size))
        # At a bend of more than 90 degrees, the projection has the wrong sign.
        past = np.sum(before * after, axis=-1, keepdims=True) < 0.0
        palmar = np.where(past, -palmar, palmar)
    return np.rad2deg(np.stack(out, axis=-1))


def joints_of_angles(angles: ArrayLike, knuckles: ArrayLike, lengths: ArrayLike) -> Array:
    """Joints (..., 5, 4, 3) of angles (..., 5, 4) in degrees: the inverse of `angles_of_joints`.

    Args:
        angles: Degrees.
        knuckles: (5, 3) m, in palm coordinates.
        lengths: (5, 3) m, bones from the knuckle outwards.
    """
    f, s, p, d = np.moveaxis(np.deg2rad(np.asarray(angles, float)), -1, 0)
    lengths = np.asarray(lengths, float)
    bend = np.stack([np.zeros_like(p), p, p + d], axis=-1)
    flat = np.stack([np.zeros_like(bend), arithmetic.cos(bend), -arithmetic.sin(bend)], axis=-1)
    x, y, z = flat[..., 0], flat[..., 1], flat[..., 2]
    # exp(-f about x) exp(s about z)
    sx = x * arithmetic.cos(s)[..., None] - y * arithmetic.sin(s)[..., None]
    sy = x * arithmetic.sin(s)[..., None] + y * arithmetic.cos(s)[..., None]
    fy = sy * arithmetic.cos(f)[..., None] + z * arithmetic.sin(f)[..., None]
    fz = -sy * arithmetic.sin(f)[..., None] + z * arithmetic.cos(f)[..., None]
    local = np.stack([sx, fy, fz], axis=-1) * lengths[..., None]
    bones = stacked_applied(FRAMES[:, None], local)
    start = np.broadcast_to(np.asarray(knuckles, float), (*bones.shape[:-2], 3))
    return np.concatenate(
        [start[..., None, :], start[..., None, :] + np.cumsum(bones, axis=-2)], axis=-2
    )
