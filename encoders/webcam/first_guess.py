"""A first guess of a hand's place: the palm turned as the engine's landmarks say, at the distance
at which it is as large as in the picture."""

from __future__ import annotations

import numpy as np

from encoders.webcam.landmarks import PALM
from models.arithmetic import (
    Array,
    eigen,
    length,
    solve_positive,
    stacked_applied,
    transposed_times,
)
from models.pose import POSE_SIZE, ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp, quaternion_log

_PALM = list(PALM)
NEAREST = 0.05
"""m, least distance of a guessed hand from the lens."""


def first_guess(palm: Array, rays: Array, world: Array) -> Array:
    """A pose (48,) in the camera's frame with all joints at rest.

    Args:
        palm: (5, 3) m, the palm's points in the hand's own frame.
        rays: (21, 2) x/z and y/z of the landmarks in the picture.
        world: (21, 3) landmarks in space in the camera's axes; only their turn is used.
    """
    q = np.zeros(POSE_SIZE)
    q[ROOT_ROTATION] = turn_between(palm, world[_PALM])
    turned = stacked_applied(exp(q[ROOT_ROTATION]), palm)
    q[ROOT_POSITION] = place_of(turned, rays[_PALM])
    return q


def turn_between(a: Array, b: Array) -> Array:
    """The rotation vector (3,) that turns points a (n, 3) most nearly into points b (n, 3).

    Horn, Closed-form solution of absolute orientation using unit quaternions (1987).
    """
    a, b = a - a.mean(axis=0), b - b.mean(axis=0)
    s = transposed_times(np.ascontiguousarray(a), np.ascontiguousarray(b))
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = s.tolist()
    n = np.array(
        [
            [xx + yy + zz, yz - zy, zx - xz, xy - yx],
            [yz - zy, xx - yy - zz, xy + yx, zx + xz],
            [zx - xz, xy + yx, yy - xx - zz, yz + zy],
            [xy - yx, zx + xz, yz + zy, zz - xx - yy],
        ]
    )
    _, vectors = eigen(n)
    quaternion = vectors[:, 0]
    return quaternion_log(quaternion / length(quaternion))


def place_of(points: Array, rays: Array) -> Array:
    """The translation (3,) m after which points (n, 3) m are seen along rays (n, 2), as nearly as
    possible: x + tx = u (z + tz), linear in the translation."""
    n = len(points)
    rows = np.zeros((2 * n, 3))
    rows[:n, 0] = rows[n:, 1] = 1.0
    rows[:n, 2], rows[n:, 2] = -rays[:, 0], -rays[:, 1]
    wanted = np.concatenate(
        [rays[:, 0] * points[:, 2] - points[:, 0], rays[:, 1] * points[:, 2] - points[:, 1]]
    )
    square = transposed_times(rows, rows)
    square[np.diag_indices(3)] += _LEAST
    right = transposed_times(rows, wanted[:, None])[:, 0]
    place = solve_positive(square, np.ascontiguousarray(right))
    place[2] = max(place[2], NEAREST)
    return place


_LEAST = 1e-9
"""Keeps the equations solvable where all landmarks are one point; moves a real hand by nothing."""
