"""Creases of the skin.

The fingers have creases across every joint on the palmar side, and folds over the knuckles on the
back. The palm has its lines. Positions are in metres, in the palm's frame at the zero pose.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from models.arithmetic import Array
from training.skin.shapes import Limb, between, groove, step

REACH = (0.011, 0.016)
"""Range of the distance (m) from the bone's axis over which a finger's crease fades out."""
BEND = ((-0.0013, 0.00050), (0.0014, 0.00038))
END = ((0.0, 0.00050),)
BASE = ((0.0, 0.00036),)
THUMB_BEND = ((0.0, 0.00050), (-0.0028, 0.00028))
"""Position (m) along the finger, relative to a joint, and depth (m) of creases on the palmar side:
at the middle joint, the last joint, the base of a finger, and the thumb's last joint."""
KNUCKLE = ((-0.0032, 0.00012), (-0.0010, 0.00022), (0.0012, 0.00019), (0.0034, 0.00010))
LAST_KNUCKLE = ((-0.0012, 0.00015), (0.0010, 0.00013))
THUMB_KNUCKLE = ((-0.0030, 0.00013), (-0.0006, 0.00022), (0.0018, 0.00013))
"""Position (m) and depth (m) of folds on the back: at the middle joint, the last joint, and the
thumb's last joint."""
WIDTH, BASE_WIDTH, FOLD_WIDTH = 0.0008, 0.0010, 0.0007
"""Widths (m) of creases, of creases at the base of a finger, and of folds."""
BASE_PLACE = 0.335
"""Position of a finger's first crease along its first bone, as a share of its length."""


@dataclass(frozen=True)
class Line:
    """A crease across a finger.

    Attributes:
        place: (3,) m, position on the finger's axis.
        along: (3,) direction of the finger there.
        back: (3,) direction out of the finger's back.
        depth: Depth (m) of the crease.
        width: Width (m) of the crease.
        dorsal: True for a crease on the back.
    """

    place: Array
    along: Array
    back: Array
    depth: float
    width: float
    dorsal: bool


def finger_lines(chain: Sequence[Limb], thumb_joint: float) -> list[Line]:
    """All creases of a finger with two bones (the thumb) or three.

    Args:
        chain: Bones of the finger.
        thumb_joint: Position of the thumb's last joint, as a share of the length of its last bone.
    """
    first, last = chain[0], chain[-1]
    if len(chain) == 2:
        joint = last.at(0, thumb_joint, 0)
        return [
            *_across(joint, last.axes, THUMB_BEND, WIDTH, False),
            *_across(last.at(0, 0.06, 0), between(first, last), ((0.0, 0.00045),), 0.0009, False),
            *_across(joint, last.axes, THUMB_KNUCKLE, FOLD_WIDTH, True),
        ]
    second = chain[1]
    pip, dip = between(first, second), between(second, last)
    return [
        *_across(first.at(0, BASE_PLACE, 0), first.axes, BASE, BASE_WIDTH, False),
        *_across(second.start, pip, BEND, WIDTH, False),
        *_across(last.start, dip, END, WIDTH, False),
        *_across(second.start, pip, KNUCKLE, FOLD_WIDTH, True),
        *_across(last.start, dip, LAST_KNUCKLE, FOLD_WIDTH, True),
    ]


def _across(
    place: Array, axes: Array, lines: Sequence[tuple[float, float]], width: float, dorsal: bool
) -> list[Line]:
    return [
        Line(place + shift * axes[:, 1], axes[:, 1], axes[:, 2], depth, width, dorsal)
        for shift, depth in lines
    ]


def relief_of(p: Array, lines: Sequence[Line], widen: float = 1.0) -> Array:
    """Depths (n,) m of a finger's creases at points (n, 3), widened by a factor."""
    depth = np.zeros(len(p))
    for line in lines:
        away = p - line.place
        height = away @ line.back
        # Folds on the back are short; palmar creases go halfway around the finger.
        side = step(height, 0.0035, 0.0075) if line.dorsal else step(-height, -0.0005, 0.0050)
        near = 1.0 - step(np.linalg.norm(away, axis=1), *REACH)
        cut = groove(away @ line.along, widen * line.width)
        depth = np.maximum(depth, line.depth * cut * side * near)
    return depth


def palm_relief(p: Array, widen: float = 1.0) -> Array:
    """Depths (n,) m of the lines of the palm and of the wrist's palmar side."""
    depth = np.zeros(len(p))
    inside = step(-p[:, 2], 0.006, 0.011)
    for points, strength, width in PALM_LINES:
        far = np.full(len(p), np.inf)
        for a, b in pairwise(points):
            along = b - a
            t = np.clip((p[:, :2] - a) @ along / (along @ along), 0.0, 1.0)
            far = np.minimum(far, np.linalg.norm(p[:, :2] - a - t[:, None] * along, axis=1))
        depth = np.maximum(depth, strength * groove(far, widen * width) * inside)
    return depth


def _curve(*points: tuple[float, float]) -> Array:
    """Smooth line (n, 2) m through points given in mm (Catmull-Rom spline)."""
    knots = np.array([points[0], *points, points[-1]], float) / 1000.0
    out = []
    for a, b, c, d in zip(knots, knots[1:], knots[2:], knots[3:], strict=False):
        for t in (0.0, 0.25, 0.5, 0.75):
            bend = (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3
            out.append(0.5 * (2 * b + (c - a) * t + bend))
    return np.array([*out, knots[-1]])


PALM_LINES = (
    (_curve((44, 62), (30, 68), (14, 75), (0, 82), (-10, 92)), 0.00042, 0.0013),
    (_curve((-36, 73), (-24, 72), (-8, 66), (10, 57), (24, 44)), 0.00042, 0.0013),
    (_curve((-36, 72), (-25, 68), (-13, 58), (-5, 42), (-3, 24), (-6, 10)), 0.00048, 0.0014),
    (_curve((-24, -3), (0, -1), (24, -4)), 0.00026, 0.0011),
    (_curve((-22, -8), (0, -7), (22, -9)), 0.00018, 0.0010),
)
"""Lines of the palm as seen from the back of the hand, each with depth and width, all in m: heart
line, head line, life line, and two lines at the wrist. They were drawn by eye."""
