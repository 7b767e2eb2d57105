"""The flesh of the built-in hand with its creases: a signed distance field over its skeleton.

Positions are in metres, in the palm's frame at the zero pose. Distances are negative inside. At the
zero pose the fingers are half bent, so that no joint can rotate by much more than 65 degrees from
it, and the skin is never stretched far.

Each finger is blended into the palm separately, and not into other fingers, so that neighbouring
fingers stay apart. Every finger has its own creases: across every joint on the palmar side, and
folds over the knuckles on the back. The palm has its lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array
from models.frames import FINGERS
from models.kinematics import Kinematics
from models.pose import POSE_SIZE
from models.skeleton import ADULT, Skeleton
from training.skin.shapes import Limb, between, cut, ellipsoid, groove, melt, rounded_cone, step

WRIST_HALF = (0.0262, 0.0168)
"""Half width and half thickness (m) of the wrist."""
WRIST_MIDDLE = -0.0066
"""Height (m) of the wrist's axis over the palm's origin."""
WRIST_END = -0.066
"""Position (m) along y of the end of the forearm. The cuff hides this end."""

FINGER_WIDTH = 1.05
"""Ratio of a finger's width to its thickness."""
WEB = 0.34
"""Position of the webs along the first phalanges, as a share of their length."""
THUMB_IP = 0.50
"""Position of the thumb's last joint, as a share of the length of the thumb's last bone. The
skeleton does not have this joint."""

MELT_FINGER, MELT_THUMB = 0.007, 0.015
"""Widths (m) of the blend of a finger into the palm, and of that of the thumb."""


class HandField:
    """Signed distance field of the hand with its creases.

    Args:
        skeleton: A right hand. Shapes are designed for `ADULT`. The skin of `ADULT` is stretched to
            make that of other hands.

    Attributes:
        limbs: One limb per bone, in the skeleton's order.
        fingers: Limbs of each finger, thumb first.
    """

    def __init__(self, skeleton: Skeleton = ADULT) -> None:
        placed = Kinematics(skeleton).place(np.zeros(POSE_SIZE))
        self.skeleton = skeleton
        self.limbs = [
            Limb(placed.joints[i], placed.rotations[i], b.length, b.radius)
            for i, b in enumerate(skeleton.bones)
        ]
        self.fingers = [
            [limb for limb, b in zip(self.limbs, skeleton.bones, strict=True) if b.finger == f]
            for f in range(len(FINGERS))
        ]
        self.knuckles = [chain[0].start for chain in self.fingers]
        self._lines = [finger_lines(chain, THUMB_IP) for chain in self.fingers]

    def __call__(self, points: ArrayLike) -> Array:
        """Signed distances (n,) m of points (n, 3) to the skin."""
        return self.united(*self.parts(np.asarray(points, float)))

    def parts(self, p: Array) -> tuple[Array, list[Array]]:
        """Distances (n,) m of points (n, 3) to the palm and to each finger, including creases."""
        return self._palm(p), [self._one_finger(p, f) for f in range(len(FINGERS))]

    def _one_finger(self, p: Array, finger: int) -> Array:
        """Distances (n,) m to a finger. Far from the finger, they are approximated by distances to
        its bones."""
        bones = [
            rounded_cone(p, limb.at(0, 0, 0), limb.at(0, 1, 0), 0.0, 0.0)
            for limb in self.fingers[finger]
        ]
        rough = np.min(bones, axis=0) - 0.004
        near = np.flatnonzero(rough < 0.030)
        rough[near] = (self._finger if finger else self._thumb_of)(p[near], finger)
        return rough

    def united(self, palm: Array, fingers: list[Array]) -> Array:
        """Distances (n,) m to the whole hand, from the distances to its parts."""
        whole = melt(palm, fingers[0], MELT_THUMB)
        for finger in fingers[1:]:
            # A small blend between neighbours avoids a jagged edge where they meet.
            whole = melt(whole, melt(palm, finger, MELT_FINGER), 0.0006)
        return whole

    def webs(self) -> list[tuple[Array, Array, tuple[int, int]]]:
        """Both ends (m) of each web's edge, and the two fingers beside it."""
        webs = [
            (a[0].at(0, WEB, -0.25), b[0].at(0, WEB, -0.25), (f + 1, f + 2))
            for f, (a, b) in enumerate(pairwise(self.fingers[1:]))
        ]
        thumb, index = self.fingers[0][0].at(0.2, 0.62, 0.05), self.knuckles[1]
        return [(thumb, index * [1.02, 0.70, 1.0] - [0, 0, 0.007], (0, 1)), *webs]

    def normal(self, points: ArrayLike, reach: float = 2e-4) -> Array:
        """Unit normals (n, 3) that point out of the skin."""
        p = np.asarray(points, float)
        slope = np.stack([self(p + reach * e) - self(p - reach * e) for e in np.eye(3)], axis=1)
        return slope / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-12)

    # Finger: three phalanges, knuckles, pads, and a tip that is flat under its nail

    def _finger(self, p: Array, finger: int) -> Array:
        first, second, third = self.fingers[finger]
        body = self._phalanx(p, first, 1.10, 1.00)
        middle = self._phalanx(p, second, 1.03, 0.98)
        body = melt(body, middle, 0.003)
        # Knuckles are wider than the bones between them, and lie on the back.
        body = melt(
            body,
            ellipsoid(
                p,
                second.at(0, 0.02, 0.14),
                second.radius * np.array([1.12, 1.35, 1.00]),
                between(first, second),
            ),
            0.006,
        )
        body = melt(
            body,
            ellipsoid(
                p,
                third.at(0, 0.0, 0.10),
                third.radius * np.array([1.11, 1.20, 0.98]),
                between(second, third),
            ),
            0.005,
        )
        # Pads fill the palmar side between the creases.
        for limb, along, under, reach in ((first, 0.56, 0.34, 0.005), (second, 0.50, 0.30, 0.004)):
            half = [0.84 * limb.radius, 0.36 * limb.length, 0.81 * limb.radius]
            pad = ellipsoid(p, limb.at(0, along, -under), half, limb.axes)
            body = melt(body, pad, reach)
        body = melt(body, self._tip(p, third, 1.05, 0.0), 0.004)
        return body + relief_of(p, self._lines[finger])

    def _phalanx(self, p: Array, limb: Limb, first: float, last: float) -> Array:
        """Distance to the flesh around a bone, which is a little wider than thick.

        Args:
            p: (n, 3) m, points.
            limb: The bone.
            first, last: Radii at both ends, divided by the bone's radius.
        """
        r, local = limb.radius, limb.local(p) / [FINGER_WIDTH, 1.0, 1.0]
        start, end = [0.0, 0.0, 0.01 * r], [0.0, limb.length, 0.04 * r]
        return rounded_cone(local, start, end, first * r, last * r)

    def _thumb_of(self, p: Array, finger: int) -> Array:
        first, last = self.fingers[0]
        root = first.at(0.15, 0.15, -0.10)
        body = rounded_cone(p, root, first.at(0, 0.98, 0.0), 1.20 * first.radius, 0.0100)
        joint = ellipsoid(p, last.at(0, 0.0, 0.10), [0.0104, 0.0125, 0.0098], last.axes)
        body = melt(body, joint, 0.006)
        body = melt(
            body,
            rounded_cone(
                p,
                last.at(0, 0.0, 0.0),
                last.at(0, THUMB_IP, 0.02),
                1.20 * last.radius,
                1.04 * last.radius,
            ),
            0.005,
        )
        knuckle = ellipsoid(
            p, last.at(0, THUMB_IP, 0.08), last.radius * np.array([1.22, 1.35, 1.06]), last.axes
        )
        body = melt(body, knuckle, 0.004)
        body = melt(
            body, ellipsoid(p, last.at(0, 0.27, -0.30), [0.0084, 0.0115, 0.0076], last.axes), 0.005
        )
        body = melt(body, self._tip(p, last, 1.16, THUMB_IP), 0.004)
        return body + relief_of(p, self._lines[finger])

    def _tip(self, p: Array, limb: Limb, wide: float, start: float) -> Array:
        """Distance to the last phalanx: round at the pad, flat under the nail, narrower at the
        end."""
        r, local = limb.radius, limb.local(p)
        length = limb.length
        begin = start * length
        stem = rounded_cone(
            local * [1.0 / wide, 1.0, 1.0],
            [0, begin, 0.02 * r],
            [0, length - 0.1 * r, -0.03 * r],
            1.0 * r,
            0.95 * r,
        )
        pulp = ellipsoid(
            local, [0, length - 0.42 * r, -0.16 * r], [0.97 * wide * r, 1.40 * r, 0.86 * r]
        )
        bud = melt(stem, pulp, 0.0035)
        tilt = np.deg2rad(17.0)
        slope = local[:, 1] - (length - 0.55 * r)
        plane = (local[:, 2] - 0.80 * r) * np.cos(tilt) + slope * np.sin(tilt)
        return cut(bud, plane, 0.0032)

    # Palm, ball of the thumb, edge of the hand, webs, and the wrist

    def _palm(self, p: Array) -> Array:
        thumb, *knuckles = self.knuckles
        body = self._metacarpals(p, knuckles)
        body = melt(body, self._cushions(p, knuckles), 0.009)
        edge, *edges = self.webs()
        for (a, b), (start, end, _) in zip(pairwise(self.fingers[1:]), edges, strict=True):
            front = rounded_cone(p, start, end, 0.0050, 0.0050)
            back = rounded_cone(p, a[0].at(0, 0.12, 0.0), b[0].at(0, 0.12, 0.0), 0.0085, 0.0085)
            body = melt(body, melt(front, back, 0.010), 0.006)
        body = melt(body, self._thumb_web(p, thumb, edge[:2]), 0.012)
        body = melt(body, self._wrist(p), 0.020)
        return body + palm_relief(p)

    def _metacarpals(self, p: Array, knuckles: list[Array]) -> Array:
        body: Array | None = None
        for k in knuckles:
            root = np.array([0.60 * k[0], 0.012, -0.0045])
            ray = rounded_cone(p, root, k - [0.0, 0.003, 0.0026], 0.0135, 0.0102)
            # The head of the bone under the skin, and the tendon that runs to it.
            ray = melt(
                ray,
                ellipsoid(p, k + np.array([0, -0.0015, 0.0018]), [0.0084, 0.0105, 0.0088]),
                0.009,
            )
            start = np.array([0.45 * k[0], 0.020, 0.0062])
            end = k + np.array([0.0, -0.006, 0.0078])
            cord = rounded_cone(p, start, end, 0.0016, 0.0012)
            ray = melt(ray, cord, 0.005)
            body = ray if body is None else melt(body, ray, 0.012)
        assert body is not None
        return body

    def _cushions(self, p: Array, knuckles: list[Array]) -> Array:
        """Distance to the cushions on the palmar side."""
        thumb, little = self.fingers[0][0], knuckles[3]
        heel = rounded_cone(
            p, [0.0205, 0.014, -0.0095], [little[0] - 0.0045, 0.058, -0.0098], 0.0122, 0.0100
        )
        ball = ellipsoid(p, thumb.at(0.42, 0.42, -0.50), [0.0135, 0.0300, 0.0130], thumb.axes)
        body = melt(heel, ball, 0.010)
        for a, b in pairwise(knuckles):
            pad = ellipsoid(p, (a + b) / 2 + [0.0, 0.0005, -0.0098], [0.0125, 0.0125, 0.0075])
            body = melt(body, pad, 0.007)
        return body

    def _thumb_web(self, p: Array, thumb: Array, edge: tuple[Array, Array]) -> Array:
        first, index = self.fingers[0][0], self.knuckles[1]
        near = rounded_cone(
            p, first.at(0.0, 0.35, 0.0), index * [1.0, 0.45, 1.0] - [0, 0, 0.005], 0.0100, 0.0090
        )
        far = rounded_cone(p, *edge, 0.0052, 0.0062)
        root = rounded_cone(p, [-0.011, 0.010, -0.0085], thumb, 0.0132, 0.0125)
        return melt(melt(near, far, 0.012), root, 0.012)

    def _wrist(self, p: Array) -> Array:
        """Distance to the wrist: an elliptic tube, a little narrower towards the hand."""
        y = p[:, 1]
        flare = step(y, -0.045, 0.018)
        wide, thick = WRIST_HALF[0] * (1.0 + 0.16 * flare), WRIST_HALF[1] * (1.0 - 0.06 * flare)
        x, z = p[:, 0] / wide, (p[:, 2] - WRIST_MIDDLE) / thick
        far = np.sqrt(x * x + z * z)
        tube = far * (far - 1.0) / np.maximum(np.sqrt((x / wide) ** 2 + (z / thick) ** 2), 1e-9)
        # The head of the ulna.
        bone = ellipsoid(p, [0.0165, -0.021, 0.0012], [0.0092, 0.0120, 0.0098])
        tube = melt(tube, bone, 0.012)
        return cut(cut(tube, WRIST_END - y, 0.003), y - 0.014, 0.020)

    def relief(self, points: ArrayLike, widen: float = 1.0) -> Array:
        """Depths (n,) m of the creases at points on the skin, widened by a factor."""
        p = np.asarray(points, float)
        _, fingers = self.parts(p)
        nearest = np.argmin(np.stack(fingers), axis=0)
        # A crease belongs to one finger, even if another one is near.
        own = [relief_of(p, lines, widen) * (nearest == f) for f, lines in enumerate(self._lines)]
        return np.max([palm_relief(p, widen), *own], axis=0)


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
        furrow = groove(away @ line.along, widen * line.width)
        depth = np.maximum(depth, line.depth * furrow * side * near)
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
