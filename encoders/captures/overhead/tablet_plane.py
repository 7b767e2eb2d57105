"""Homography from a camera's picture to the touch surface, and the camera's position.

A camera without distortion maps a plane to its picture by a homography, which has eight parameters.
The four corners of the surface in the picture determine the homography. Touches determine it, too:
when five touches are down, only one assignment to the five fingertips in the picture is close to a
rotation with a scale. From this start, two steps alternate: all touches are paired with fingertips,
and the homography is fitted to the pairs.

A finger touches with its pad, which lies between the tip and the last joint in the picture. The
pad's position, as a share of the way from the tip to the joint, is fitted together with the
homography.

The homography of a plane of known size also gives the camera's position and its field of view.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import permutations
from math import atan, degrees, sqrt
from typing import NamedTuple

import numpy as np

from encoders.air.camera import VIEWS, Camera
from models.arithmetic import Array
from models.errors import CaptureError, InputError
from models.frames import FINGERS

MOST_MISS = 0.012
"""Largest median distance (m) of touches from their fingers' pads: half the distance between
neighbouring fingers."""
MIRRORED = 0.6
"""A picture counts as mirrored if the median distance between touches and fingers in its mirror
image is less than this share of the median distance in the picture itself."""

_SHARES = tuple(np.linspace(-0.2, 0.8, 11).tolist())
_FIRST_SHARE = 0.3
_LEAST_LOOKS, _MOST_LOOKS = 20, 400
_SEEDS = 12
_ROUNDS = 8
_AFFINE_ROUNDS = 3
_NEAR = 0.004
"""Scale (m) of the Cauchy weights: pairs farther apart than this count less."""


class Moment(NamedTuple):
    """Hand landmarks and touches at one time.

    Attributes:
        tips: (5, 2) px, fingertips.
        joints: (5, 2) px, the last joint of each finger.
        touches: (n, 2) m, x right and y down.
    """

    tips: Array
    joints: Array
    touches: Array

    def pads(self, share: float) -> Array:
        """Finger pads (5, 2) px, at a share of the way from the fingertip to the last joint."""
        return self.tips + share * (self.joints - self.tips)


@dataclass(frozen=True)
class TabletPlane:
    """Location of the surface in a camera's picture.

    Attributes:
        matrix: (3, 3) homography from pixels to m on the surface, x right and y down.
        share: Position of the pads between tip (0) and last joint (1).
        miss: Median distance (m) between touches and pads; NaN without touches.
        pairs: Number of touches to which the plane was fitted.
    """

    matrix: Array
    share: float = _FIRST_SHARE
    miss: float = float("nan")
    pairs: int = 0

    def on_surface(self, pixels: Array) -> Array:
        """Points (..., 2) m on the surface at pixels (..., 2)."""
        return applied(self.matrix, pixels)

    def pads(self, tips: Array, joints: Array) -> Array:
        """Finger pads (..., 5, 2) m on the surface, from landmarks (..., 5, 2) px."""
        return self.on_surface(tips + self.share * (joints - tips))


def applied(matrix: Array, points: Array) -> Array:
    """Points (..., 2) transformed by a homography (3, 3)."""
    flat = points @ matrix[:2, :2].T + matrix[:2, 2]
    return np.asarray(flat / (points @ matrix[2, :2] + matrix[2, 2])[..., None])


def homography(here: Array, there: Array, weight: Array | None = None) -> Array:
    """Homography (3, 3) that maps points `here` (n, 2) to `there` (n, 2) with the least squared
    error; n is at least 4.

    Hartley and Zisserman, Multiple View Geometry (2004), algorithm 4.2: both sets are normalised
    first.
    """
    a, b = _scaling(here), _scaling(there)
    x, y = applied(a, here).T
    u, v = applied(b, there).T
    one, zero = np.ones_like(x), np.zeros_like(x)
    w = np.sqrt(np.ones_like(x) if weight is None else weight)
    rows = np.concatenate(
        [
            np.stack([x, y, one, zero, zero, zero, -u * x, -u * y, -u], axis=1) * w[:, None],
            np.stack([zero, zero, zero, x, y, one, -v * x, -v * y, -v], axis=1) * w[:, None],
        ]
    )
    least = np.linalg.eigh(rows.T @ rows)[1][:, 0].reshape(3, 3)
    found = np.linalg.inv(b) @ least @ a
    return np.asarray(found / found[2, 2])


def _scaling(points: Array) -> Array:
    middle = points.mean(axis=0)
    scale = np.sqrt(2.0) / max(float(np.linalg.norm(points - middle, axis=1).mean()), 1e-12)
    return np.array([[scale, 0.0, -scale * middle[0]], [0.0, scale, -scale * middle[1]], [0, 0, 1]])


def plane_of_corners(corners: Array, size: Array) -> TabletPlane:
    """Locates the surface in the picture from its corners.

    Args:
        corners: (4, 2) px: top left, top right, bottom right, bottom left, named from the view of
            the person at the surface.
        size: (2,) m, width and height of the surface.

    Raises:
        InputError: The corners cannot be those of a rectangle, or they run the wrong way round.
    """
    width, height = size.tolist()
    there = np.array([[0.0, 0.0], [width, 0.0], [width, height], [0.0, height]])
    sides = np.roll(corners, -1, axis=0) - corners
    following = np.roll(sides, -1, axis=0)
    turns = sides[:, 0] * following[:, 1] - sides[:, 1] * following[:, 0]
    area = 0.5 * abs(float(turns[0] + turns[2]))
    if not np.isfinite(corners).all() or not ((turns > 0).all() or (turns < 0).all()) or area < 100:
        raise InputError(
            "these are not the corners of a rectangle in a picture",
            where="--corners",
            got="; ".join(f"{x:g}/{y:g}" for x, y in corners.tolist()),
            expected="top left, top right, bottom right, bottom left, in pixels",
        )
    if (turns < 0).all():
        raise InputError(
            "the corners run the wrong way round: the camera's picture is mirrored, or two corners "
            "are swapped",
            where="--corners",
            remedy="Tick in the camera's page that it mirrors its picture, or mark corners again",
        )
    return TabletPlane(homography(corners, there))


def plane_of_touches(moments: Sequence[Moment], start: TabletPlane | None = None) -> TabletPlane:
    """Locates the surface in the picture from touches and the fingers that make them.

    Args:
        moments: Pairs of hand landmarks and touches.
        start: The surface located by its corners. Only a shift of some mm and the pads' share are
            then fitted. The shift is needed because fingertips lie above the glass. None fits the
            whole homography and the pads' share.

    Raises:
        CaptureError: Touches and fingers do not match, or there are too few.
    """
    used = _some([m for m in moments if len(m.touches) >= 2 or start is not None])
    if len(used) < _LEAST_LOOKS:
        raise CaptureError(
            "too few touches to find the surface in the picture",
            got=f"{len(used)} moments with a hand in the picture and two fingers down",
            expected=f"at least {_LEAST_LOOKS}, some of them with all five fingers",
            remedy="Touch all over the surface, with several fingers at a time",
        )
    if start is not None:
        plane = _refined(used, start, fixed=True)
    else:
        plane = _refined(used, _first(used), fixed=False)
    if not plane.miss <= MOST_MISS:
        raise CaptureError(
            "touches and fingers in the picture do not match",
            got=f"{1000 * plane.miss:.0f} mm between them (median)",
            expected=f"under {1000 * MOST_MISS:g} mm",
            remedy="Check --side, --surface and that neither camera nor tablet was moved",
        )
    return plane


def _some(moments: list[Moment]) -> list[Moment]:
    if len(moments) <= _MOST_LOOKS:
        return moments
    return [moments[i] for i in np.linspace(0, len(moments) - 1, _MOST_LOOKS).astype(int)]


def _first(moments: list[Moment]) -> TabletPlane:
    """First estimate: a rotation, scale and shift, from the moments with the most touches.

    Raises:
        CaptureError: The picture is mirrored, or three fingers are never down together.
    """
    most = sorted(range(len(moments)), key=lambda i: -len(moments[i].touches))
    many = [i for i in most if len(moments[i].touches) >= 3]
    if not many:
        raise CaptureError(
            "the surface cannot be located in the picture: three fingers are never down together",
            remedy="Tap with all five fingers first, or mark the tablet's corners",
        )
    top = [i for i in many if len(moments[i].touches) == len(moments[many[0]].touches)]
    seeds = [top[i] for i in np.unique(np.linspace(0, len(top) - 1, _SEEDS).astype(int))]
    best: dict[bool, tuple[float, Array]] = {}
    for mirrored in (False, True):
        for seed in seeds:
            matrix = _similarity(moments[seed], mirrored)
            miss = float(np.median(_misses(moments, matrix)))
            if mirrored not in best or miss < best[mirrored][0]:
                best[mirrored] = miss, matrix
    if best[True][0] < MIRRORED * best[False][0]:
        raise CaptureError(
            "the camera's picture is mirrored",
            got=f"touches are {1000 * best[False][0]:.0f} mm from fingers, and "
            f"{1000 * best[True][0]:.0f} mm in the mirror image",
            remedy="Tick in the camera's page that it mirrors its picture, or add --webcam "
            "mirrored; check --side",
        )
    return TabletPlane(best[False][1])


def _similarity(moment: Moment, mirrored: bool) -> Array:
    """Rotation, scale and shift, as a homography (3, 3), that bring fingers nearest to the touches.

    All assignments of fingers to touches are tried.
    """
    count = len(moment.touches)
    orders = np.array(list(permutations(range(len(FINGERS)), count)))
    pads = moment.pads(_FIRST_SHARE) * ([-1.0, 1.0] if mirrored else [1.0, 1.0])
    here = pads[orders] @ np.array([1.0, 1j])
    there = moment.touches @ np.array([1.0, 1j])
    a = here - here.mean(axis=1, keepdims=True)
    b = there - there.mean()
    turn = (a.conj() * b).sum(axis=1) / (np.abs(a) ** 2).sum(axis=1)
    miss = (np.abs(b - turn[:, None] * a) ** 2).sum(axis=1)
    i = int(miss.argmin())
    shift = there.mean() - turn[i] * here[i].mean()
    c, s = turn[i].real, turn[i].imag
    matrix = np.array([[c, -s, shift.real], [s, c, shift.imag], [0.0, 0.0, 1.0]])
    return matrix @ np.diag([-1.0 if mirrored else 1.0, 1.0, 1.0])


def _misses(moments: list[Moment], matrix: Array) -> Array:
    """Distances (R,) m between each touch and its finger."""
    return np.concatenate([_paired(m, TabletPlane(matrix))[1] for m in moments])


def _paired(moment: Moment, plane: TabletPlane) -> tuple[Array, Array]:
    """Assigns different fingers (n,) to touches with the least sum of distances; also returns the
    distances (n,) m."""
    pads = plane.pads(moment.tips, moment.joints)
    off = np.linalg.norm(moment.touches[:, None] - pads, axis=2)
    count = min(len(off), len(FINGERS))
    orders = _ORDERS[count]
    sums = off[np.arange(count), orders].sum(axis=1)
    fingers = orders[int(sums.argmin())]
    return fingers, off[np.arange(count), fingers]


_ORDERS = {
    n: np.array(list(permutations(range(len(FINGERS)), n))) for n in range(1, len(FINGERS) + 1)
}


def _refined(moments: list[Moment], plane: TabletPlane, fixed: bool) -> TabletPlane:
    """Alternates between pairing touches with fingers and fitting the plane and the pads' share."""
    for turn in range(_ROUNDS):
        tips, joints, touches = [], [], []
        for moment in moments:
            fingers, _ = _paired(moment, plane)
            tips.append(moment.tips[fingers])
            joints.append(moment.joints[fingers])
            touches.append(moment.touches[: len(fingers)])
        pairs = np.concatenate(tips), np.concatenate(joints), np.concatenate(touches)
        kind = "shift" if fixed else "affine" if turn < _AFFINE_ROUNDS else "all"
        plane = min((_fitted(*pairs, plane, share, kind) for share in _SHARES), key=_cost)
    return plane


def _cost(plane: TabletPlane) -> float:
    return plane.miss


def _fitted(
    tips: Array, joints: Array, touches: Array, plane: TabletPlane, share: float, kind: str
) -> TabletPlane:
    pads = tips + share * (joints - tips)
    matrix = plane.matrix
    miss = np.linalg.norm(applied(matrix, pads) - touches, axis=1)
    for _ in range(3):
        weight = 1.0 / (1.0 + (miss / _NEAR) ** 2)
        if kind == "all":
            matrix = homography(pads, touches, weight)
        elif kind == "affine":
            matrix = _affine(pads, touches, weight)
        else:
            off = touches - applied(matrix, pads)
            moved = np.eye(3)
            moved[:2, 2] = (weight[:, None] * off).sum(axis=0) / weight.sum()
            matrix = moved @ matrix
        miss = np.linalg.norm(applied(matrix, pads) - touches, axis=1)
    return replace(
        plane, matrix=matrix, share=share, miss=float(np.median(miss)), pairs=len(touches)
    )


def _affine(here: Array, there: Array, weight: Array) -> Array:
    root = np.sqrt(weight)[:, None]
    rows = np.column_stack([here, np.ones(len(here))])
    coefficients = np.linalg.lstsq(rows * root, there * root, rcond=None)[0]
    matrix = np.eye(3)
    matrix[:2] = coefficients.T
    return matrix


def mirrored_plane(plane: TabletPlane, width: int) -> TabletPlane:
    """Converts a plane to the mirrored picture, with the surface's x negated.

    Args:
        plane: The plane in the picture.
        width: Width of the picture in px.
    """
    picture = np.array([[-1.0, 0.0, float(width)], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    matrix = np.diag([-1.0, 1.0, 1.0]) @ plane.matrix @ picture
    return replace(plane, matrix=matrix / matrix[2, 2])


LEAST_LEAN = 0.05
"""Least change of scale from the middle to the edge of the picture, relative to the scale, at which
a plane determines the field of view. Seen from straight above, a plane looks the same through any
lens."""


@dataclass(frozen=True)
class CameraPlace:
    """A camera in the 3-D surface frame (x right, y up the surface, z out of it).

    Attributes:
        camera: Field of view; the position stored in it is not used.
        rotation: (3, 3) rotation from the surface frame to the camera's frame.
        shift: (3,) m, the surface's origin in the camera's frame.
    """

    camera: Camera
    rotation: Array
    shift: Array

    @property
    def at(self) -> Array:
        """Position (3,) m of the lens in the surface frame."""
        return np.asarray(-self.rotation.T @ self.shift)

    def seen(self, points: Array) -> Array:
        """Transforms points (..., 3) m from the surface frame to the camera's frame."""
        return np.asarray(points @ self.rotation.T + self.shift)

    def unseen(self, points: Array) -> Array:
        """Transforms points (..., 3) m from the camera's frame to the surface frame."""
        return np.asarray((points - self.shift) @ self.rotation)


def place_of_camera(matrix: Array, size: tuple[int, int], camera: Camera) -> CameraPlace:
    """Position and orientation of a camera, from its homography to the surface.

    Args:
        matrix: (3, 3) from pixels to m on the surface, x right and y down.
        size: Width and height of the picture in px.
        camera: The camera, of which only the field of view is used.

    Raises:
        CaptureError: The homography shows the surface from below.
    """
    columns = np.linalg.inv(_lens(size, camera)) @ np.linalg.inv(matrix)
    scale = sqrt(float(np.linalg.norm(columns[:, 0]) * np.linalg.norm(columns[:, 1])))
    # The sign is chosen so that the surface is in front of the camera.
    columns = columns / (scale if columns[2, 2] > 0 else -scale)
    x, y = columns[:, 0], -columns[:, 1]
    u, _, v = np.linalg.svd(np.stack([x, y, np.cross(x, y)], axis=1))
    rotation = u @ np.diag([1.0, 1.0, float(np.linalg.det(u @ v))]) @ v
    place = CameraPlace(camera, rotation, columns[:, 2])
    if not np.isfinite(place.shift).all() or place.at[2] <= 0.0:
        raise CaptureError(
            "the surface in the picture is seen from below",
            got=np.round(place.at, 3).tolist(),
            remedy="The camera's picture may be mirrored, or corners may be swapped",
        )
    return place


def field_of_view(matrix: Array, size: tuple[int, int]) -> float | None:
    """Field of view (degrees) across the width of the picture, from the homography of a plane.

    The two axes of the plane are perpendicular and equally long in space. These facts give two
    equations for one unknown (Zhang, A flexible new technique for camera calibration, 2000). The
    result is None if the plane is seen from nearly straight above, since the picture is then the
    same for any lens. It is also None if the solution is not a plausible field of view.

    Args:
        matrix: (3, 3) homography from pixels to m on the plane.
        size: Width and height of the picture in px.
    """
    middle = np.array([[1.0, 0.0, 0.5 * size[0]], [0.0, 1.0, 0.5 * size[1]], [0.0, 0.0, 1.0]])
    h = np.linalg.inv(middle) @ np.linalg.inv(matrix)
    h = h / np.linalg.norm(h[:2, :2])
    # (x1 x2 + y1 y2) / f2 + z1 z2 = 0, and (|xy1|2 - |xy2|2) / f2 + z1^2 - z2^2 = 0.
    flat = np.array([h[:2, 0] @ h[:2, 1], h[:2, 0] @ h[:2, 0] - h[:2, 1] @ h[:2, 1]])
    deep = np.array([h[2, 0] * h[2, 1], h[2, 0] ** 2 - h[2, 1] ** 2])
    lean = float(np.linalg.norm(h[2, :2])) * 0.5 * size[0]
    if lean < LEAST_LEAN:
        return None
    inverse = -float(flat @ deep) / max(float(flat @ flat), 1e-30)
    if inverse <= 0.0:
        return None
    view = 2.0 * degrees(atan(0.5 * size[0] * sqrt(inverse)))
    return view if VIEWS[0] <= view <= VIEWS[1] else None


def _lens(size: tuple[int, int], camera: Camera) -> Array:
    f = camera.focal_length(size[0])
    return np.array([[f, 0.0, 0.5 * size[0]], [0.0, f, 0.5 * size[1]], [0.0, 0.0, 1.0]])
