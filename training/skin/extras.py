"""Separate surfaces on the skin: nails, cuff and sleeve.

Positions are in metres, in the palm's frame at the zero pose, as in `field`.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.arithmetic import Array
from training.skin.field import WRIST_HALF, WRIST_MIDDLE, HandField

Faces = NDArray[np.int64]

NAIL_RINGS, NAIL_SIDES = 6, 28
NAIL_RAISED, NAIL_SUNK = 0.00042, 0.0011
"""Height (m) of the nail above the skin in the middle, and depth (m) below the skin at the rim.
With less depth, the skin would show through."""
NAIL_SQUARE = 2.7
"""Exponent of the superellipse of the outline; 2 is an ellipse."""
CUFF_SIDES = 56


def nail(field: HandField, finger: int) -> tuple[Array, Faces, Array]:
    """A nail: vertices (n, 3) m, triangles (m, 3), and values (n,) from 0 on the nail's bed to 1 at
    its free edge."""
    limb = field.fingers[finger][-1]
    r, wide = limb.radius, 1.12 if finger == 0 else 1.0
    tilt = np.deg2rad(17.0)
    out = limb.axes @ np.array([0.0, np.sin(tilt), np.cos(tilt)])
    ahead = limb.axes @ np.array([0.0, np.cos(tilt), -np.sin(tilt)])
    half_wide, half_long = 0.74 * wide * r, 0.82 * r
    middle = limb.start + limb.axes @ np.array([0.0, limb.length - 0.20 * r, 0.0])

    rows = [np.zeros((1, 2))]
    for ring in range(1, NAIL_RINGS + 1):
        angle = 2 * np.pi * np.arange(NAIL_SIDES) / NAIL_SIDES
        circle = np.stack([np.cos(angle), np.sin(angle)], axis=1)
        size = np.sum(np.abs(circle) ** NAIL_SQUARE, axis=1) ** (-1.0 / NAIL_SQUARE)
        # Rings are closer towards the rim, where the nail bends down.
        share = 1.0 - (1.0 - ring / NAIL_RINGS) ** 1.6
        rows.append(share * circle * size[:, None])
    flat = np.concatenate(rows)
    start = (
        middle
        + flat[:, :1] * half_wide * limb.axes[:, 0]
        + flat[:, 1:] * half_long * ahead
        + 2.5 * r * out
    )
    down = _onto(field, start, -out, 3.6 * r)
    rim = np.linalg.norm(flat, ord=NAIL_SQUARE, axis=1)
    # The middle of the nail is above the skin, and its rim below it.
    lift = NAIL_RAISED - (NAIL_RAISED + NAIL_SUNK) * rim**7
    places = down + lift[:, None] * out
    edge = np.clip((flat[:, 1] - 0.66) / 0.10, 0.0, 1.0)
    return places, _fan(NAIL_RINGS, NAIL_SIDES), edge


def _onto(field: HandField, start: Array, direction: Array, far: float) -> Array:
    """Points at which rays meet the skin, or come nearest to it."""
    walked = np.zeros(len(start))
    for _ in range(30):
        walked = np.minimum(walked + 0.9 * field(start + walked[:, None] * direction), far)
    return start + walked[:, None] * direction


def _fan(rings: int, sides: int) -> Faces:
    """Counterclockwise triangles of a disc, which consists of a middle and rings around it."""
    triangles = [(0, 1 + i, 1 + (i + 1) % sides) for i in range(sides)]
    for ring in range(rings - 1):
        a, b = 1 + ring * sides, 1 + (ring + 1) * sides
        for i in range(sides):
            j = (i + 1) % sides
            triangles += [(a + i, b + i, b + j), (a + i, b + j, a + j)]
    return np.array(triangles, np.int64)


CUFF_PROFILE = (
    (-0.0395, 0.0006),
    (-0.0385, 0.0018),
    (-0.0380, 0.0034),
    (-0.0388, 0.0048),
    (-0.0405, 0.0055),
    (-0.0500, 0.0058),
    (-0.0580, 0.0058),
)
SLEEVE_PROFILE = (
    (-0.0500, 0.0030),
    (-0.0478, 0.0050),
    (-0.0470, 0.0070),
    (-0.0476, 0.0088),
    (-0.0495, 0.0097),
    (-0.0600, 0.0100),
    (-0.0750, 0.0104),
    (-0.0830, 0.0106),
    (-0.0850, 0.0090),
    (-0.0856, 0.0040),
    (-0.0856, -0.0080),
)
"""Points of the profiles of cuff and sleeve, from the inside outwards: position (m) along the
forearm, and height (m) above the wrist's skin."""


def tube(profile: ArrayLike, closed: bool) -> tuple[Array, Faces]:
    """Elliptic tube around the wrist: vertices (n, 3) m and triangles (m, 3).

    Args:
        profile: Points as in `CUFF_PROFILE`.
        closed: True closes the end of the tube at the last point.
    """
    angle = 2 * np.pi * np.arange(CUFF_SIDES) / CUFF_SIDES
    rings = []
    for y, height in np.asarray(profile, float):
        rings.append(
            np.stack(
                [
                    (WRIST_HALF[0] + height) * np.cos(angle),
                    np.full(CUFF_SIDES, y),
                    (WRIST_HALF[1] + height) * np.sin(angle) + WRIST_MIDDLE,
                ],
                axis=1,
            )
        )
    triangles = []
    for ring in range(len(rings) - 1):
        a, b = ring * CUFF_SIDES, (ring + 1) * CUFF_SIDES
        for i in range(CUFF_SIDES):
            j = (i + 1) % CUFF_SIDES
            triangles += [(a + i, b + j, b + i), (a + i, a + j, b + j)]
    points = np.concatenate(rings)
    if closed:
        last = (len(rings) - 1) * CUFF_SIDES
        points = np.concatenate([points, points[last:].mean(axis=0, keepdims=True)])
        triangles += [
            (last + i, last + (i + 1) % CUFF_SIDES, len(points) - 1) for i in range(CUFF_SIDES)
        ]
    return points, np.array(triangles, np.int64)
