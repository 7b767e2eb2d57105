"""Converts points on a hand, markers or joints, to poses of our skeleton and to touches."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.captures.conversion.conversion_report import ConversionReport, ConversionRules
from encoders.captures.conversion.fingers import LabelledTrack
from encoders.captures.conversion.joint_track import JointTrack
from encoders.captures.conversion.sites import PALM, Site
from encoders.captures.conversion.surface_frame import ON_PLANE, SurfaceFrame, frame_from_fingertips
from encoders.captures.conversion.touch_log import ContactTrack
from models.arithmetic import Array
from models.errors import CaptureError
from models.frames import FINGERS
from models.kinematics import Kinematics
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION, joint_vectors
from models.rotations import exp, exp_and_left_jacobian, log, skew
from models.skeleton import Skeleton

ACCURACY = 0.0015
"""Accuracy (m) of an observed point. It weighs the points against the pull of joints to
mid-range."""

_ROUNDS, _STEPS = 25, 2
"""Number of rounds, and of Gauss-Newton steps in each round. A round first estimates the poses of
the key frames, then the size of the hand and the places of the points on their bones."""

_FINAL_STEPS = 8
"""Number of Gauss-Newton steps of a frame, starting from the pose of the nearest key frame."""

_KEYS = 150
"""Number of key frames. The hand's size and the places of the points are estimated from them."""

_CHUNK = 500
"""Number of frames solved at once, limited by memory."""

_LONGEST_STEP = 0.4
"""Largest rotation (rad) of a joint in one Gauss-Newton step."""

_TRUST = 0.005
"""Standard deviation (m) of a point's mean observed position on its bone. The mean over all frames
counts as one observation."""

_SIZES = (0.6, 1.5)
"""Least and greatest size of a hand relative to the skeleton's."""


@dataclass(frozen=True)
class FittedHand:
    """A skeleton of the fitted size with its poses.

    Attributes:
        skeleton: Skeleton scaled to the person's hand.
        scale: Size of this skeleton relative to the given skeleton.
        surprise: (M,) distances of the points from their expected places on their bones, in
            standard deviations.
        q: (T, 48) poses in the frame of the points; NaN in frames with too few points.
        residual: (T, M) m, distance between observed and modelled points; NaN where a point was
            not seen.
    """

    skeleton: Skeleton
    scale: float
    surprise: Array
    q: Array
    residual: Array


def fit_skeleton(
    points: Array,
    sites: Sequence[Site],
    skeleton: Skeleton,
    progress: Callable[[float], None] | None = None,
) -> FittedHand:
    """Fits a right hand to points.

    Args:
        points: (T, M, 3) m, NaN where a point was not seen.
        sites: M places of the points on the hand.
        skeleton: Skeleton to be scaled.
        progress: Called with the share done, 0 to 1.

    Raises:
        CaptureError: No frame shows the whole hand, or its size is impossible.
    """
    usable = _whole_enough(points, sites, skeleton)
    frames = np.flatnonzero(usable)
    if not len(frames):
        raise CaptureError(
            "the hand is never seen whole",
            where="points",
            got=f"none of {len(points)} frames",
            expected="three points of the palm and one of every finger in a frame",
            remedy="Check the mapping for missing points, or record the whole hand",
        )
    keys = frames[np.unique(np.linspace(0, len(frames) - 1, _KEYS).round().astype(int))]
    model = _Model(sites, skeleton)
    q = model.start(points[keys])
    for i in range(_ROUNDS):
        for _ in range(_STEPS):
            q = model.step(q, points[keys])
        model.adapt(q, points[keys])
        if progress:
            progress(0.4 * (i + 1) / _ROUNDS)
    if not _SIZES[0] < model.scale < _SIZES[1]:
        raise CaptureError(
            "the hand has an impossible size",
            got=f"{model.scale:.2f} times the size of an adult hand",
            expected=f"{_SIZES[0]} to {_SIZES[1]} times",
            remedy="Check the unit of length, the side and the mapping",
        )
    out = np.full((len(points), POSE_SIZE), np.nan)
    residual = np.full(points.shape[:2], np.nan)
    for a in range(0, len(frames), _CHUNK):
        chunk = frames[a : a + _CHUNK]
        nearest = np.abs(keys[None, :] - chunk[:, None]).argmin(axis=1)
        poses, seen = q[nearest], points[chunk]
        # The hand may have moved since the nearest key frame, so its root is estimated again. The
        # joints start from the key frame.
        poses = model.placed_root(poses, seen)
        for _ in range(_FINAL_STEPS):
            poses = model.step(poses, seen)
        out[chunk] = poses
        residual[chunk] = np.linalg.norm(seen - model.place(poses), axis=2)
        if progress:
            progress(0.4 + 0.6 * min(1.0, (a + _CHUNK) / len(frames)))
    return FittedHand(model.kinematics.skeleton, model.scale, model.surprise, out, residual)


def _whole_enough(points: Array, sites: Sequence[Site], skeleton: Skeleton) -> NDArray[np.bool_]:
    """Booleans (T,): frames with three points on the palm and one on every finger."""
    seen = np.asarray(np.isfinite(points).all(axis=2))
    owner = np.array([-1 if s.bone == PALM else skeleton.bones[s.bone].finger for s in sites])
    enough = seen[:, owner < 0].sum(axis=1) >= 3
    for finger in range(5):
        enough &= seen[:, owner == finger].any(axis=1)
    return np.asarray(enough)


class _Model:
    """Model of points on a skeleton of variable size, from which poses are estimated."""

    def __init__(self, sites: Sequence[Site], skeleton: Skeleton) -> None:
        self._adult = skeleton
        self._bone = np.array([site.bone for site in sites])
        self._guess = np.array([site.at for site in sites])
        self._spread = np.array([site.spread for site in sites])
        self._shrink = self._spread**2 / (self._spread**2 + _TRUST**2)
        self._moved = np.zeros((len(sites), 3))
        self.scale = 1.0
        self.kinematics = Kinematics(skeleton)
        parent = _parents(skeleton)
        self._moves = np.zeros((len(sites), len(skeleton.bones)), bool)
        for m, bone in enumerate(self._bone):
            while bone != PALM:
                self._moves[m, bone] = True
                bone = parent[bone]
        self._middle = np.concatenate([np.zeros(6), (skeleton.lower + skeleton.upper) / 2])
        # The root is not pulled. A joint's range counts as four standard deviations.
        self._pull = np.concatenate([np.zeros(6), 16 / (skeleton.upper - skeleton.lower) ** 2])

    @property
    def places(self) -> Array:
        """Points (M, 3) m in the frames of their bones."""
        return self.scale * self._guess + self._moved

    @property
    def surprise(self) -> Array:
        """Distances (M,) of the points from their expected places, in standard deviations."""
        return np.asarray(np.linalg.norm(self._moved, axis=1) / self._spread)

    def place(self, q: Array) -> Array:
        """Points (n, M, 3) m at poses (n, 48)."""
        origin, rotation, _, _ = self._frames(q)
        return origin + (rotation @ self.places[:, :, None])[..., 0]

    def start(self, points: Array) -> Array:
        """Poses (n, 48) with joints in mid-range and the roots of `placed_root`."""
        return self.placed_root(np.tile(self._middle, (len(points), 1)), points)

    def placed_root(self, q: Array, points: Array) -> Array:
        """Poses with the joints of `q` (n, 48) and the roots that bring the modelled points nearest
        to the observed points (n, M, 3) m."""
        q = q.copy()
        q[:, :6] = 0.0
        ours = self.place(q)
        weight = (~np.isnan(points).any(axis=2)).astype(float)
        weight *= np.where(self._bone == PALM, 4.0, 1.0)
        weight /= weight.sum(axis=1, keepdims=True)
        seen = np.nan_to_num(points)
        a = (weight[..., None] * ours).sum(axis=1)
        b = (weight[..., None] * seen).sum(axis=1)
        spread = np.einsum("tm,tmi,tmj->tij", weight, seen - b[:, None], ours - a[:, None])
        u, _, vt = np.linalg.svd(spread)
        flip = np.sign(np.linalg.det(u @ vt))
        u[:, :, 2] *= flip[:, None]
        turn = u @ vt
        q[:, ROOT_ROTATION] = log(turn)
        q[:, ROOT_POSITION] = b - (turn @ a[..., None])[..., 0]
        return q

    def step(self, q: Array, points: Array) -> Array:
        """Makes one Gauss-Newton step of the poses, within the joints' ranges."""
        off, J = self._off_and_jacobian(q, points)
        weighted = np.swapaxes(J, -1, -2) / ACCURACY**2
        H = weighted @ J + np.diag(self._pull + 1e-9)
        g = (weighted @ off[..., None])[..., 0] + self._pull * (self._middle - q)
        step = np.linalg.solve(H, g[..., None])[..., 0]
        longest = np.abs(step[:, 3:]).max(axis=1, keepdims=True)
        q = q + step * np.minimum(1.0, _LONGEST_STEP / np.maximum(longest, _LONGEST_STEP))
        q[:, JOINTS] = np.clip(q[:, JOINTS], self._adult.lower, self._adult.upper)
        q[:, ROOT_ROTATION] = log(exp(q[:, ROOT_ROTATION]))
        return q

    def adapt(self, q: Array, points: Array) -> None:
        """Estimates the hand's size and the places of the points on their bones, given poses."""
        origin, rotation, _, _ = self._frames(q)
        seen = np.asarray(np.isfinite(points).all(axis=2))
        root = q[:, None, ROOT_POSITION]
        body = origin + self.scale * (rotation @ self._guess[:, :, None])[..., 0] - root
        unit = body / self.scale
        rest = points - root - (rotation @ self._moved[:, :, None])[..., 0]
        count = np.maximum(seen.sum(axis=1), 1)[:, None, None]
        mask = seen[..., None]
        # Each frame's mean is subtracted, so that the root's position does not affect the size.
        unit_off = np.where(mask, unit - np.where(mask, unit, 0).sum(1, keepdims=True) / count, 0)
        rest_off = np.where(mask, rest - np.where(mask, rest, 0).sum(1, keepdims=True) / count, 0)
        self.scale = float((unit_off * rest_off).sum() / (unit_off**2).sum())
        self.scale = float(np.clip(self.scale, *_SIZES))
        self.kinematics = Kinematics(self._adult.scaled(self.scale))
        origin, rotation, _, _ = self._frames(q)
        local = np.swapaxes(rotation, -1, -2) @ (points - origin)[..., None]
        error = local[..., 0] - self.scale * self._guess
        mean = np.where(mask, error, 0).sum(axis=0) / np.maximum(mask.sum(axis=0), 1)
        self._moved = self._shrink[:, None] * mean

    def _frames(self, q: Array) -> tuple[Array, Array, Array, Array]:
        """Origins (n, M, 3) and rotations (n, M, 3, 3) of each point's bone, then positions of all
        joints and rotations of all bones."""
        placement = self.kinematics.place(q)
        palm = exp(q[:, ROOT_ROTATION])[:, None]
        # The palm is stored behind the last bone, at index -1.
        origins = np.concatenate([placement.joints, q[:, None, ROOT_POSITION]], axis=1)
        rotations = np.concatenate([placement.rotations, palm], axis=1)
        return (
            origins[:, self._bone],
            rotations[:, self._bone],
            placement.joints,
            placement.rotations,
        )

    def _off_and_jacobian(self, q: Array, points: Array) -> tuple[Array, Array]:
        """Offsets (n, 3 M) m from modelled to observed points, and the derivative (n, 3 M, 48) of
        the modelled points; both are 0 for a point that is not seen."""
        origin, rotation, joints, bones = self._frames(q)
        placed = origin + (rotation @ self.places[:, :, None])[..., 0]
        n, m = placed.shape[:2]
        J = np.zeros((n, m, 3, POSE_SIZE))
        J[..., ROOT_POSITION] = np.eye(3)
        _, left = exp_and_left_jacobian(q[:, ROOT_ROTATION])
        J[..., ROOT_ROTATION] = -skew(placed - q[:, None, ROOT_POSITION]) @ left[:, None]
        # exp(w + d) = exp(w) exp(R d) to first order in d, where R is the left Jacobian at -w. The
        # rotation R d is in the bone's frame.
        _, right = exp_and_left_jacobian(-joint_vectors(q))
        axes = bones @ right
        for j in range(joints.shape[1]):
            moved = np.flatnonzero(self._moves[:, j])
            arm = placed[:, moved] - joints[:, None, j]
            J[:, moved, :, 6 + 3 * j : 9 + 3 * j] = -skew(arm) @ axes[:, None, j]
        off = points - placed
        unseen = np.isnan(off)
        off[unseen] = 0.0
        J[unseen.any(axis=2)] = 0.0
        return off.reshape(n, 3 * m), J.reshape(n, 3 * m, POSE_SIZE)


def _parents(skeleton: Skeleton) -> list[int]:
    """Index of every bone's parent; `PALM` for the first bone of a finger."""
    fingers = [bone.finger for bone in skeleton.bones]
    return [i - 1 if i and fingers[i - 1] == f else PALM for i, f in enumerate(fingers)]


_KEPT = 2e-6
"""Time (s) from the last pose of a touch to the end of the touch, so that this pose lies within the
touch. It is twice the tolerance with which `assemble` compares times."""

ON_SURFACE = 0.006
"""Height (m) of a touching fingertip's centre: its radius minus the compression of the flesh."""

POOR_FIT = 0.010
"""Root mean square distance (m) between observed and modelled points beyond which a frame is
dropped."""

SURPRISE = 3.0
"""Largest distance of a point from its expected place, in standard deviations. A greater distance
is an error of the mapping or of the side."""

LETS_GO = 1.5
"""Height at which a touch ends, divided by the height at which it begins. The difference stops
touches from flickering."""


def joints_from_points(
    time: Array,
    points: Mapping[str, Array],
    sites: Mapping[str, Site],
    frame: SurfaceFrame | None,
    skeleton: Skeleton,
    report: ConversionReport,
    *,
    left: bool = False,
    tolerance: float = ON_PLANE,
    progress: Callable[[float], None] | None = None,
) -> JointTrack:
    """Computes poses of a hand from recorded points.

    Args:
        time: (T,) s.
        points: Positions (T, 3) m by name, in the recorder's frame, NaN where not seen.
        sites: Places on the hand by the same names.
        frame: Frame of the surface; None estimates the plane on which fingertips rest.
        skeleton: Our skeleton, whose size is fitted.
        report: Receives residuals and counts.
        left: True for a left hand, which is mirrored into a right hand.
        tolerance: Distance (m) from an estimated plane within which a fingertip rests on it.
        progress: Called with the share done, 0 to 1.

    Raises:
        CaptureError: The hand is not seen, does not fit, or does not rest on a plane.
    """
    names = list(sites)
    recorded = np.stack([points[name] for name in names], axis=1)
    chosen = [sites[name] for name in names]
    palm = np.array([site.bone == PALM for site in chosen])
    outermost = [] if frame is not None else _tip_points(chosen, skeleton)
    if frame is None:
        middle = _middle(recorded[:, palm])
        frame = frame_from_fingertips(recorded[:, outermost], middle, tolerance)
    placed = frame.points(recorded)
    if left:
        placed = placed * [-1.0, 1.0, 1.0]
    hand = fit_skeleton(placed, chosen, skeleton, progress)
    odd = int(hand.surprise.argmax())
    if hand.surprise[odd] > SURPRISE:
        raise CaptureError(
            "a point is not at its expected place on the hand",
            got=f"{names[odd]} as {chosen[odd].name}",
            remedy="Check the mapping for swapped names, and the side (--side)",
        )
    with np.errstate(invalid="ignore"):
        seen = ~np.isnan(hand.residual)
        squares = np.where(seen, hand.residual, 0.0) ** 2
        rms = np.sqrt(squares.sum(axis=1) / np.maximum(seen.sum(axis=1), 1))
    whole = ~np.isnan(hand.q).any(axis=1)
    fits = whole & (rms <= POOR_FIT)
    report.drop_parts("poses without enough points", int((~whole).sum()))
    poor = int((whole & ~fits).sum())
    report.drop_parts(f"poses that missed their points by more than {1000 * POOR_FIT:g} mm", poor)
    if fits.sum() < 2:
        raise CaptureError(
            "the skeleton does not fit the points",
            got=f"{1000 * float(np.median(rms[whole])):.0f} mm apart",
            expected=f"at most {1000 * POOR_FIT:g} mm",
            remedy="Check the mapping, the side (--side) and the unit",
        )
    used = squares[fits]
    report.notes["hand_scale"] = round(hand.scale, 4)
    report.notes["residual_mm"] = round(1000 * float(np.sqrt(used.sum() / seen[fits].sum())), 2)
    worst = np.sqrt(used.sum(axis=0) / np.maximum(seen[fits].sum(axis=0), 1))
    report.notes["worst_point"] = names[int(worst.argmax())]
    report.notes["worst_point_mm"] = round(1000 * float(worst.max()), 2)
    joints = JointTrack(time[fits], hand.q[fits], hand.skeleton)
    if not outermost:
        return joints
    with np.errstate(invalid="ignore"):
        return _on_the_surface(joints, np.abs(placed[fits][:, outermost, 2]) < tolerance)


def _middle(palm: Array) -> Array:
    """Mean (T, 3) of points of the palm (T, n, 3); NaN in frames that lack a point.

    If every frame lacks a point, for example because a marker was lost, each frame has the mean of
    the points that it shows.
    """
    middle: Array = palm.mean(axis=1)
    if not np.isnan(middle).any(axis=1).all():
        return middle
    seen = np.asarray(~np.isnan(palm).any(axis=2))
    count = seen.sum(axis=1)[:, None]
    sums = np.where(seen[:, :, None], palm, 0.0).sum(axis=1)
    return np.where(count > 0, sums / np.maximum(count, 1), np.nan)


def _tip_points(sites: list[Site], skeleton: Skeleton) -> list[int]:
    """Index (5,) of each finger's outermost point."""
    out = []
    for finger in range(len(FINGERS)):
        last = max(i for i, bone in enumerate(skeleton.bones) if bone.finger == finger)
        on_it = [i for i, site in enumerate(sites) if site.bone == last]
        if not on_it:
            raise CaptureError(
                "no point on a fingertip, so no surface can be estimated",
                got=f"none on the last bone of the {FINGERS[finger]}",
                remedy="Give the surface's corners in the --mapping file",
            )
        out.append(max(on_it, key=lambda i: float(sites[i].at[1])))
    return out


def _on_the_surface(joints: JointTrack, resting: NDArray[np.bool_]) -> JointTrack:
    """Shifts the poses so that resting fingertips touch the surface.

    The surface was estimated from markers, which lie above the fingertips' centres.

    Args:
        joints: The poses.
        resting: (J, 5) booleans, True where a fingertip rests on the surface.
    """
    q = joints.q.copy()
    q[:, 2] += ON_SURFACE - np.median(joints.tips[..., 2][resting])
    return JointTrack(joints.time, q, joints.skeleton)


def touches_from_tips(
    joints: JointTrack, threshold: float, rules: ConversionRules, report: ConversionReport
) -> list[LabelledTrack]:
    """Derives labelled touches, on the poses' clock, from fingertips near the surface.

    Args:
        joints: Poses in the frame of the surface.
        threshold: A touch begins when a fingertip's centre is less than this height (m) above
            `ON_SURFACE`, its height in a touch. The touch ends at `LETS_GO` times this height.
        rules: `shortest`, `gap`.
        report: Receives the counts.
    """
    out = []
    height = joints.tips[..., 2] - ON_SURFACE
    xy = joints.tips[..., :2] * [1.0, -1.0]
    breaks = np.diff(joints.time, append=np.inf) > max(rules.gap, 1.5 * joints.period)
    number = 0
    for finger in range(len(FINGERS)):
        down = False
        begin = 0
        for i, z in enumerate(height[:, finger]):
            if not down and z < threshold:
                down, begin = True, i
            if down and (z > LETS_GO * threshold or breaks[i]):
                stop = i if z > LETS_GO * threshold else i + 1
                end = float(joints.time[i]) + (0.0 if stop == i else _KEPT)
                if stop <= begin or end - joints.time[begin] < rules.shortest:
                    report.drop_contacts(f"shorter than {1000 * rules.shortest:g} ms")
                else:
                    part = slice(begin, stop)
                    track = ContactTrack(number, joints.time[part], xy[part, finger], end)
                    out.append(LabelledTrack(track, finger, 0.0))
                    number += 1
                down = False
    return sorted(out, key=lambda one: one.track.start)
