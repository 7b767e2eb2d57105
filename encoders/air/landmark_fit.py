"""Fits the pose of a hand of known size to its landmarks in a picture.

The engine that finds the landmarks locates each joint well in the picture, and poorly in depth: the
distances between its joints change from picture to picture. In the fit, bones have fixed lengths,
joints stay in their ranges, and the last joint of each finger follows the middle joint. Seen by the
camera, the points of the fitted pose lie at the landmarks. A single picture leaves some angles
open: a finger may point a little towards the camera or away from it. These angles follow from the
engine's guess of depth, from usual postures, and from the previous picture.

The fit is one least-squares problem of 48 unknowns, solved by a few Gauss-Newton steps from the
previous pose. Landmarks that fit badly count less (Cauchy's weights). Joints stay in their ranges:
a joint that would leave its range is fixed at its end, and the other joints compensate for it. A
few more steps bend the thumb alone, since a pinch moves it far from the middle of its ranges.

The fit to a headset's joints (`encoders.air.joint_fit`) takes the same steps (`bounded_step`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from math import radians, sqrt
from typing import NamedTuple

import mujoco
import numpy as np

from encoders.paalm.coupling import TWO_THIRDS, Coupling
from models.arithmetic import (
    Array,
    Mask,
    eigen,
    length,
    small_product,
    solve_positive,
    squared_lengths,
    stacked_applied,
    transposed_times,
)
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp, log, quaternion_exp, quaternion_log
from models.single_pose import SinglePose
from models.skeleton import Skeleton

WRIST = 0
KNUCKLES = (5, 9, 13, 17)
PALM = (WRIST, *KNUCKLES)
"""Landmarks whose distances from each other do not depend on the fingers' postures."""
OF_POINTS = (WRIST, 1, 2, *(k + i for k in KNUCKLES for i in range(3)), 4, 8, 12, 16, 20)
"""Landmark of each point of `HandPoints`: wrist, 14 joints, 5 tips."""

_KNUCKLE_POINTS = (3, 6, 9, 12)

TIP_BEYOND = 0.5
"""The engine puts a tip's landmark farther out along the bone than the centre of our tip's sphere:
by this share of the sphere's radius."""


class HandPoints:
    """The points of one right hand that have a landmark, and their derivative.

    Args:
        skeleton: A right hand.
    """

    def __init__(self, skeleton: Skeleton) -> None:
        last = {id(bone) for bone in skeleton.last_bones.values()}
        longer = tuple(
            replace(b, length=b.length + TIP_BEYOND * b.radius) if id(b) in last else b
            for b in skeleton.bones
        )
        self._pose = SinglePose(replace(skeleton, bones=longer))
        self._wrist = np.zeros((1, 3, POSE_SIZE))
        self._wrist[0, :, ROOT_POSITION] = np.eye(3)
        self.count = len(OF_POINTS)

    def points(self, q: Array) -> Array:
        """Points (20, 3) m of a pose (48,)."""
        joints, tips = self._pose.joints_and_tips(q)
        return np.concatenate([q[None, ROOT_POSITION], joints, tips])

    def points_and_jacobian(self, q: Array) -> tuple[Array, Array]:
        """Points (20, 3), and their derivative (20, 3, 48).

        Derivatives with respect to the root's rotation follow the convention of
        `SinglePose.joints_and_jacobian`. Those with respect to its position use the axes of the
        frame of `q`.
        """
        points, jacobian = self._pose.joints_and_jacobian(q)
        whole = np.concatenate([q[None, ROOT_POSITION], points])
        return whole, np.concatenate([self._wrist, jacobian])

    def palm(self) -> Array:
        """Points (5, 3) m of the palm's landmarks in the hand's own frame."""
        points = self.points(np.zeros(POSE_SIZE))
        return points[[0, *_KNUCKLE_POINTS]]


_PALM = list(PALM)
NEAREST = 0.05
"""Least distance of a guessed hand from the lens (m)."""


def first_guess(palm: Array, rays: Array, world: Array) -> Array:
    """A pose (48,) in the camera's frame with all joints at rest.

    Args:
        palm: (5, 3) m, the palm's points in the hand's own frame.
        rays: (21, 2) x/z and y/z of the landmarks in the picture.
        world: (21, 3) landmarks in space along the camera's axes; only the orientation of the palm
            is used.
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
    """The translation (3,) m after which points (n, 3) m lie most nearly on rays (n, 2).

    The equations x + tx = u (z + tz) are linear in the translation.
    """
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
"""Makes the equations solvable if all landmarks are one point; its effect on a real hand is
negligible."""


_POINTS = list(OF_POINTS)
_DEGREE = radians(1.0)
_THUMB_POINTS = [2, 15]
"""The thumb's second joint and its tip among the fitted points."""
_THUMB_JOINTS = slice(0, 6)
_THUMB = slice(JOINTS.start, JOINTS.start + 6)
"""The thumb's joints in the 42 joint values, and in a pose."""


@dataclass(frozen=True)
class FitSettings:
    """Weights of the fit, as standard deviations.

    Attributes:
        picture: Spread of a landmark in the picture (m, at the hand's distance).
        loose: Spread of the landmarks of the wrist and of the thumb's root (m). The engine places
            both differently in the hand than our skeleton does.
        depth: Spread of the engine's depth of a landmark relative to the hand's middle (m).
        outlier: Factor on `picture` beyond which a landmark begins to count less.
        twist, aside: Spread of a finger's first bone about its axis and sideways (degrees).
        play: Spread of twist and sideways play of the other joints (degrees).
        bend: Spread of flexion about the usual flexion (degrees).
        usual: Usual flexion (degrees) at a finger's first and middle joint.
        thumb: Spread of the thumb's joints about their middle, while all joints are fitted
            (degrees).
        thumb_bend: Spread of the flexion of the thumb's joints (degrees), once the rest of the hand
            is fitted and fixed. A pinch bends them to the ends of their ranges. With so much
            freedom in the first fit, the poor landmarks of the thumb would turn the palm.
        follow: Spread of the last joint's flexion about the flexion that `coupling` gives
            (degrees).
        neighbour: Spread of the difference between the flexions of neighbouring fingers (degrees).
        coupling: Flexion of the last joint as a linear function of that of the middle joint.
        linear: Spread of the wrist's speed across the camera's axis between two pictures (m/s).
        toward: Spread of the wrist's speed along the camera's axis (m/s).
        angular: Spread of the speeds of rotation of wrist and joints (rad/s).
        steps: Number of Gauss-Newton steps from the previous pose.
        first_steps: Number of Gauss-Newton steps from the first guess.
        thumb_steps: Additional steps for the thumb.
        doubt: Error (m) of a picture beyond which the fit is repeated from the first guess. The
            repeated fit is used if it is clearly better.
    """

    picture: float = 0.005
    loose: float = 0.008
    depth: float = 0.1
    outlier: float = 1.5
    twist: float = 5.0
    aside: float = 6.0
    play: float = 1.5
    bend: float = 45.0
    usual: tuple[float, float] = (15.0, 25.0)
    thumb: float = 12.0
    thumb_bend: float = 35.0
    follow: float = 12.0
    neighbour: float = 40.0
    coupling: Coupling = TWO_THIRDS
    linear: float = 0.5
    toward: float = 1.5
    angular: float = 8.0
    steps: int = 4
    thumb_steps: int = 3
    first_steps: int = 15
    doubt: float = 0.010


class Fit(NamedTuple):
    """A fitted pose.

    Attributes:
        pose: (48,) of a right hand in the camera's frame.
        error: Root mean square distance (m) between points and their landmarks in the picture, at
            the hand's distance.
    """

    pose: Array
    error: float


class LandmarkFit:
    """Fits one right hand to one picture after another.

    Args:
        skeleton: The right hand's skeleton, of the person's size.
        settings: Weights of the fit.
    """

    def __init__(self, skeleton: Skeleton, settings: FitSettings | None = None) -> None:
        self.settings = s = settings or FitSettings()
        self._points = HandPoints(skeleton)
        self._palm = self._points.palm()
        self._palm_size = _spread(self._palm)
        self._lower, self._upper = skeleton.lower, skeleton.upper
        self._prior, self._usual = _prior(skeleton, s)
        self._thumb_usual = self._usual[_THUMB_JOINTS]
        free = np.array([s.thumb_bend, s.thumb, s.thumb, s.thumb_bend, s.play, s.play])
        self._thumb_prior = 1.0 / (free * _DEGREE * free * _DEGREE)
        # Landmarks: the wrist and the thumb's root are loose.
        weight = np.full(self._points.count, 1.0 / s.picture)
        weight[:2] = 1.0 / s.loose
        self._weight = weight
        self.reset()

    def reset(self) -> None:
        """Forgets the previous picture."""
        self._pose: Array | None = None

    @property
    def pose(self) -> Array | None:
        """The pose (48,) of the last picture, in the camera's frame, before the thumb's own steps;
        None before the first picture."""
        return self._pose

    def fit(self, rays: Array, world: Array, dt: float) -> Fit:
        """Fits the next picture.

        Args:
            rays: (21, 2) x/z and y/z of the landmarks in the camera's frame.
            world: (21, 3) m, the engine's guess in space, in the camera's axes.
            dt: Time (s) since the previous picture; not used for the first picture.
        """
        s = self.settings
        depth = self._depth(rays, world)
        if self._pose is None:
            solution = self._solve(self._guess(rays, world), rays, depth, None, s.first_steps)
        else:
            speeds = np.full(POSE_SIZE, s.angular, float)
            speeds[ROOT_POSITION] = s.linear, s.linear, s.toward
            still = 1.0 / (speeds * max(dt, _LEAST_TIME))
            solution = self._solve(self._pose, rays, depth, still, s.steps)
            if solution.error > s.doubt:
                again = self._solve(self._guess(rays, world), rays, depth, None, s.first_steps)
                solution = again if again.error < _BETTER * solution.error else solution
        # The next picture begins from the pose before the thumb's own steps.
        self._pose = solution.pose
        return self._with_thumb(solution.pose, rays)

    def _guess(self, rays: Array, world: Array) -> Array:
        toward = _turn_to_ray(rays)
        return first_guess(self._palm, rays, stacked_applied(toward, world))

    def _depth(self, rays: Array, world: Array) -> Array:
        """Distances (20,) m by which points are farther along the line of sight than their mean."""
        scale = self._palm_size / max(_spread(world[list(PALM)]), _LEAST_PALM)
        z = min(max(scale, _SCALES[0]), _SCALES[1]) * world[_POINTS, 2]
        return z - z.mean()

    def _solve(
        self, start: Array, rays: Array, depth: Array, still: Array | None, steps: int
    ) -> Fit:
        s, q = self.settings, start.copy()
        seen = rays[_POINTS]
        sight = _turn_to_ray(rays)[:, 2]
        before = start
        for _ in range(steps):
            points, jacobian = self._points.points_and_jacobian(q)
            z = np.maximum(points[:, 2], _NEAREST)
            along = points[:, :2] / z[:, None]
            aside = (along - seen) * z[:, None]
            weight = self._weight * _cauchy(squared_lengths(aside), s.outlier * s.picture)
            rows = (jacobian[:, :2] - along[:, :, None] * jacobian[:, 2:]) * weight[:, None, None]
            misses = aside * weight[:, None]
            deep = stacked_applied(points, np.broadcast_to(sight, points.shape)[0])
            deep_rows = (
                jacobian[:, 0] * sight[0] + jacobian[:, 1] * sight[1] + jacobian[:, 2] * sight[2]
            )
            deep_misses = (deep - deep.mean() - depth) / s.depth
            deep_rows = (deep_rows - deep_rows.mean(axis=0)) / s.depth
            everything = np.concatenate([rows.reshape(-1, POSE_SIZE), deep_rows])
            missed = np.concatenate([misses.ravel(), deep_misses])
            square = transposed_times(everything, everything)
            down = transposed_times(everything, missed[:, None])[:, 0]
            square[JOINTS, JOINTS] += self._prior
            down[JOINTS] += stacked_applied(self._prior, q[JOINTS] - self._usual)
            if still is not None:
                square[np.diag_indices(POSE_SIZE)] += still * still
                down += still * still * _moved(q, before)
            square[np.diag_indices(POSE_SIZE)] += _DAMPING
            step = bounded_step(q, square, down, self._lower, self._upper)
            q = self._stepped(q, step)
            if float(np.abs(step).max()) < _STILL:
                break
        points = self._points.points(q)
        z = np.maximum(points[:, 2], _NEAREST)
        aside = (points[:, :2] / z[:, None] - seen) * z[:, None]
        return Fit(q, sqrt(float(squared_lengths(aside).mean())))

    def _with_thumb(self, pose: Array, rays: Array) -> Fit:
        """The pose (48,) with a freer thumb; the rest of the hand is fixed."""
        s, q = self.settings, pose
        seen = rays[_POINTS][_THUMB_POINTS]
        for _ in range(s.thumb_steps):
            points, jacobian = self._points.points_and_jacobian(q)
            points, jacobian = points[_THUMB_POINTS], jacobian[_THUMB_POINTS][:, :, _THUMB]
            z = np.maximum(points[:, 2], _NEAREST)
            along = points[:, :2] / z[:, None]
            aside = (along - seen) * z[:, None]
            weight = self._weight[_THUMB_POINTS]
            weight = weight * _cauchy(squared_lengths(aside), s.outlier * s.picture)
            rows = (jacobian[:, :2] - along[:, :, None] * jacobian[:, 2:]) * weight[:, None, None]
            rows = np.ascontiguousarray(rows.reshape(-1, len(self._thumb_prior)))
            square, down = np.eye(POSE_SIZE), np.zeros(POSE_SIZE)
            square[_THUMB, _THUMB] = transposed_times(rows, rows)
            square[_THUMB, _THUMB] += np.diag(self._thumb_prior)
            misses = (aside * weight[:, None]).reshape(-1, 1)
            down[_THUMB] = transposed_times(rows, np.ascontiguousarray(misses))[:, 0]
            down[_THUMB] += self._thumb_prior * (q[_THUMB] - self._thumb_usual)
            step = bounded_step(q, square, down, self._lower, self._upper)
            q = self._stepped(q, step)
            if float(np.abs(step).max()) < _STILL:
                break
        points = self._points.points(q)
        z = np.maximum(points[:, 2], _NEAREST)
        aside = (points[:, :2] / z[:, None] - rays[_POINTS]) * z[:, None]
        return Fit(q, sqrt(float(squared_lengths(aside).mean())))

    def _stepped(self, q: Array, step: Array) -> Array:
        moved = stepped(q, step, self._lower, self._upper)
        moved[2] = max(float(moved[2]), _NEAREST)
        return moved


_LEAST_TIME = 0.001
"""Least time between two pictures (s)."""
_BETTER = 0.8
"""The fit from the first guess is used only if its error is below this share of the error of the
fit from the previous pose."""
_LEAST_PALM, _SCALES = 0.01, (0.5, 2.0)
"""Least size (m) of the palm in the engine's landmarks, and limits of the factor that scales the
engine's depths to our hand."""
_NEAREST = 0.03
"""Least distance of a point from the lens (m)."""
_DAMPING = 1e-3
_STILL = 1e-5
"""Largest component (m or rad) of a step below which the search ends."""
_CENTRED = 1e-9
"""Tangent of the angle from the middle of the picture, below which a hand counts as centred."""


def _prior(skeleton: Skeleton, s: FitSettings) -> tuple[Array, Array]:
    """Prior of the joints: precision (42, 42) in 1/rad2, and the most likely joints (42,) rad."""
    count = 3 * len(skeleton.bones)
    rows: list[Array] = []
    wanted: list[float] = []

    def add(terms: dict[int, float], value: float, spread: float) -> None:
        """Adds a row: the sum of terms equals the value (rad) within a spread (degrees)."""
        row = np.zeros(count)
        for i, factor in terms.items():
            row[i] = factor
        rows.append(row / (spread * _DEGREE))
        wanted.append(value / (spread * _DEGREE))

    first = skeleton.first_bone.tolist()
    for i, bone in enumerate(skeleton.bones):
        x, y, z = 3 * i, 3 * i + 1, 3 * i + 2
        knuckle, thumb = i in first, bone.finger == 0
        if thumb:
            add({x: 1.0}, 0.0, s.thumb)
        elif i - first[bone.finger] < len(s.usual):
            # Flexion is the flexion at rest minus the rotation about x.
            bent = s.usual[i - first[bone.finger]] * _DEGREE
            add({x: 1.0}, _flexion(skeleton, i) - bent, s.bend)
        add({y: 1.0}, 0.0, s.thumb if thumb and knuckle else s.twist if knuckle else s.play)
        add({z: 1.0}, 0.0, s.thumb if thumb and knuckle else s.aside if knuckle else s.play)
    slope, offset = s.coupling.slope, s.coupling.offset * _DEGREE
    for knuckle in first[1:]:
        pip, dip = knuckle + 1, knuckle + 2
        at_rest = (_flexion(skeleton, pip), _flexion(skeleton, dip))
        value = at_rest[1] - slope * at_rest[0] - offset
        add({3 * dip: 1.0, 3 * pip: -slope}, value, s.follow)
    for one, other in pairwise(first[1:]):
        for bone_of in range(2):
            add({3 * (one + bone_of): 1.0, 3 * (other + bone_of): -1.0}, 0.0, s.neighbour)
    A, b = np.array(rows), np.array(wanted)
    precision = transposed_times(A, A)
    usual = solve_positive(
        precision.copy(), np.ascontiguousarray(transposed_times(A, b[:, None])[:, 0])
    )
    return precision, usual


def _flexion(skeleton: Skeleton, bone: int) -> float:
    """Angle (rad) by which a joint is bent at rest."""
    return -float(log(skeleton.bones[bone].rest)[0])


def _cauchy(squares: Array, scale: float) -> Array:
    """Square roots of Cauchy's weights for squared residuals (n,)."""
    weights: Array = 1.0 / np.sqrt(1.0 + squares / (scale * scale))
    return weights


def _moved(q: Array, before: Array) -> Array:
    """Movement (48,) of a pose, with the root's rotation in its own frame."""
    moved = q - before
    product, conjugate = np.zeros(4), np.zeros(4)
    mujoco.mju_negQuat(conjugate, quaternion_exp(before[ROOT_ROTATION]))
    mujoco.mju_mulQuat(product, conjugate, quaternion_exp(q[ROOT_ROTATION]))
    moved[ROOT_ROTATION] = quaternion_log(product)
    return moved


def _turn_to_ray(rays: Array) -> Array:
    """(3, 3) rotation from the axis of the camera to the line of sight to the hand's middle.

    The engine treats a hand as if it were in the middle of the picture.
    """
    x, y = rays.mean(axis=0).tolist()
    long = sqrt(x * x + y * y + 1.0)
    across = sqrt(x * x + y * y)
    if across < _CENTRED:
        return np.eye(3)
    # The turn about the axis (-y, x, 0) whose cosine is 1 / long and sine is across / long.
    k = np.array([[0.0, 0.0, x], [0.0, 0.0, y], [-x, -y, 0.0]]) / across
    turned: Array = np.eye(3) + (across / long) * k + (1.0 - 1.0 / long) * small_product(k, k)
    return turned


def _spread(points: Array) -> float:
    """Root mean square distance (m) of points (n, 3) m from their mean."""
    return sqrt(float(squared_lengths(points - points.mean(axis=0)).mean()))


LONGEST = 0.5
"""Largest change (m or rad) of any component of a pose in one step."""
_ROUNDS = 4
"""Largest number of rounds in which joints are fixed at the ends of their ranges."""
_AT_END = 1e-9
"""Angle (rad) within which a joint is at the end of its range."""


def bounded_step(q: Array, square: Array, down: Array, lower: Array, upper: Array) -> Array:
    """The Gauss-Newton step (48,) of a pose.

    A joint at the end of its range is fixed if the step would move it further out.

    Args:
        q: (48,) pose.
        square: (48, 48) positive definite, J'J of the residuals.
        down: (48,) J'r of the residuals.
        lower: (42,) rad, lower ends of the joints' ranges.
        upper: (42,) rad, upper ends of the joints' ranges.
    """
    held = np.zeros(POSE_SIZE, bool)
    for _ in range(_ROUNDS):
        step = _solved(square, down, held)
        joints = q[JOINTS] + step[JOINTS]
        out = (joints < lower) & (q[JOINTS] <= lower + _AT_END)
        out |= (joints > upper) & (q[JOINTS] >= upper - _AT_END)
        out &= ~held[JOINTS]
        if not out.any():
            break
        held[JOINTS] |= out
    return np.minimum(np.maximum(step, -LONGEST), LONGEST)


def stepped(q: Array, step: Array, lower: Array, upper: Array) -> Array:
    """The pose (48,) after a step; the root turns in its own frame."""
    moved = q + step
    moved[ROOT_ROTATION] = _turned(q[ROOT_ROTATION], step[ROOT_ROTATION])
    moved[JOINTS] = np.minimum(np.maximum(moved[JOINTS], lower), upper)
    return moved


def _solved(square: Array, down: Array, held: Mask) -> Array:
    """The step (48,) that solves the equations; its fixed components are 0."""
    S, r = square.copy(), -down
    if held.any():
        S[held] = 0.0
        S[:, held] = 0.0
        S[held, held] = 1.0
        r[held] = 0.0
    return solve_positive(S, r)


def _turned(w: Array, turn: Array) -> Array:
    """The rotation vector (3,) of exp(w) exp(turn)."""
    product = np.zeros(4)
    mujoco.mju_mulQuat(product, quaternion_exp(w), quaternion_exp(turn))
    mujoco.mju_normalize4(product)
    return quaternion_log(product)
