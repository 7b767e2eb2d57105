"""The simulated subject. All its takes of one day form a capture.

Methods are tested on the subject's judged days (`Subject`). The subject's hand takes the most
likely posture with its fingertips over the touches. A simulated screen measures the touches, and a
simulated capture system measures the poses.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from typing import Any

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.captures.subject.configuration import FROZEN, SEED, SubjectConfiguration
from encoders.captures.subject.gestures import Take, path, smooth_noise, takes_of
from models.arithmetic import Array
from models.errors import InputError
from models.frames import FINGERS
from models.kinematics import Kinematics, Placement
from models.pose import BALL_JOINTS, JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION, within_limits
from models.rotations import exp, log
from models.skeleton import ADULT, Skeleton
from models.surface import METRES_PER_INCH, Surface

FREEDOMS = 27
"""Anatomic degrees of freedom: root 6, thumb 5, four for each other finger."""

FLEXION, TWIST, ABDUCTION = np.array([-1.0, 0, 0]), np.array([0, 1.0, 0]), np.array([0, 0, 1.0])
"""Axes of rotation in the bones' frames; a positive rotation about FLEXION closes the hand."""

_THUMB = 6
"""First freedom of the thumb: CMC flexion, abduction, twist, MCP flexion, abduction."""
_FINGERS = (11, 15, 19, 23)
"""First freedom of the other fingers: MCP flexion, MCP abduction, PIP, DIP."""


@dataclass(frozen=True)
class Anatomy:
    """A subject's hand: its hinges and the covariance of its postures.

    Attributes:
        hinges: (48, 27) matrix from degrees of freedom to the pose: q = hinges @ theta. In joints
            with two or three degrees of freedom, the degrees of freedom are components of a single
            rotation vector. This is nearly true of the human eye and shoulder (Listing's law).
            Columns of the root are unit vectors.
        covariance: (27, 27) covariance of the intended posture.
    """

    hinges: Array
    covariance: Array


def anatomy(
    rng: np.random.Generator, skeleton: Skeleton, configuration: SubjectConfiguration
) -> Anatomy:
    """Draws a subject's anatomy. Hinge axes differ at random from the bones' axes by a few
    degrees."""
    hinges = np.zeros((POSE_SIZE, FREEDOMS))
    hinges[:6, :6] = np.eye(6)
    for freedom, (bone, axis) in enumerate(_freedoms(), start=6):
        tilt = np.clip(rng.normal(0, configuration.hinge_tilt, 3), -0.06, 0.06)
        rows = slice(6 + 3 * bone, 9 + 3 * bone)
        hinges[rows, freedom] = exp(tilt) @ axis
    if hinges.shape[0] != 6 + 3 * len(skeleton.bones):
        raise AssertionError("the skeleton must have the 14 bones of the table of freedoms")
    return Anatomy(hinges, _covariance(configuration))


def _freedoms() -> list[tuple[int, Array]]:
    """Bone and axis of every degree of freedom of the fingers."""
    thumb = [(0, FLEXION), (0, ABDUCTION), (0, TWIST), (1, FLEXION), (1, ABDUCTION)]
    fingers = [
        (2 + 3 * finger + bone, axis)
        for finger in range(4)
        for bone, axis in ((0, FLEXION), (0, ABDUCTION), (1, FLEXION), (2, FLEXION))
    ]
    return [*thumb, *fingers]


def _covariance(configuration: SubjectConfiguration) -> Array:
    """Covariance (27, 27) of the intended posture: six synergies, and a remainder that is
    correlated between neighbouring fingers.

    Because of these correlations, a lifted finger moves along with the touching fingers in the most
    likely posture (enslaving).
    """
    c = configuration
    loadings = _synergies() * np.array(c.synergy_spread)[:, None]
    covariance = loadings.T @ loadings
    root = np.array([*c.root_position_spread, *c.root_rotation_spread])
    covariance[range(6), range(6)] += root**2
    thumb = np.arange(_THUMB, _THUMB + 5)
    covariance[thumb, thumb] += np.array(c.thumb_spread) ** 2
    distance = np.abs(np.subtract.outer(np.arange(4), np.arange(4)))
    for k, spread in enumerate(c.finger_spread):
        rows = np.array(_FINGERS) + k
        covariance[np.ix_(rows, rows)] += spread**2 * c.neighbour**distance
    return covariance


def _synergies() -> Array:
    """Loadings (6, 27) of the synergies; the largest loading of each synergy is 1."""
    out = np.zeros((6, FREEDOMS))
    flex_all, knuckles, gradient, opposing, spreading, thumb_flexion = out
    for finger, start in enumerate(_FINGERS):
        side = (-1.0, -0.35, 0.35, 1.0)[finger]
        flex_all[start : start + 4] = 0.8, 0.0, 1.0, 0.65
        knuckles[start : start + 4] = 1.0, 0.0, -0.9, -0.55
        gradient[start : start + 4] = 0.9 * side, 0.0, side, 0.6 * side
        # Positive abduction, counterclockwise seen from the back of the hand, is towards the thumb.
        spreading[start + 1] = -0.5 * side
    flex_all[_THUMB : _THUMB + 5] = 0.4, 0.0, 0.0, 0.7, 0.0
    opposing[_THUMB : _THUMB + 5] = 0.3, -1.0, 0.6, 0.2, 0.0
    spreading[_THUMB : _THUMB + 5] = 0.0, 1.0, 0.0, -0.2, 0.0
    thumb_flexion[_THUMB : _THUMB + 5] = 0.8, 0.0, 0.0, 1.0, 0.0
    return out


def lifting(curled: bool) -> Array:
    """Rotation (5, 27) of the joints of each lifted finger, in units of `lift_posture`.

    A finger is lifted from the surface by stretching it, or by curling it.
    """
    out = np.zeros((5, FREEDOMS))
    out[0, _THUMB : _THUMB + 5] = (0.6, 0, 0, 0.8, 0) if curled else (-0.9, 0, 0, -0.5, 0)
    for finger, start in enumerate(_FINGERS, start=1):
        out[finger, start : start + 4] = (-0.2, 0, 1.6, 1.0) if curled else (-1.0, 0, -0.4, -0.2)
    return out


ITERATIONS = 20

_FIRST_PRECISION = 0.02
"""Precision (m) of targets in the first iteration. With the required precision, a hand far from its
targets would overshoot."""

_STEP = 0.15
"""Largest rotation (rad) of a joint in one iteration, so that tips move nearly linearly."""

_WALL = np.deg2rad(0.5)
"""Softness (rad) of the wall that keeps a joint in its range."""

_BEFORE_LIMIT = np.deg2rad(2.0)
"""Angle (rad) between the wall and the anatomic limit, as room for errors of measurement."""


class PostureSolver:
    """Computes the most likely posture with given fingertips, for many frames at once.

        theta = argmin  sum over fingertips |tip - target|^2 / precision^2
                        + (theta - aim)' S^-1 (theta - aim) + a wall at the joints' limits

    by Gauss-Newton. Poses are therefore not polynomials of the touches: tips are trigonometric in
    the joints, the solution contains an inverse matrix, and the aim does not follow from the
    touches alone.

    Args:
        kinematics: Kinematics of the skeleton.
        anatomy: The joints' hinges, and the covariance of postures.
    """

    def __init__(self, kinematics: Kinematics, anatomy: Anatomy) -> None:
        self._kinematics, self._hinges = kinematics, anatomy.hinges
        self._precision = np.linalg.inv(anatomy.covariance)
        skeleton = kinematics.skeleton
        self._lower = skeleton.lower + _BEFORE_LIMIT
        self._upper = skeleton.upper - _BEFORE_LIMIT

    def solve(self, aim: Array, targets: Array, precision: Array) -> Array:
        """Computes postures (n, 27).

        Args:
            aim: (n, 27) intended posture.
            targets: (n, 5, 3) m, targets of the fingertips, in the frame of the root's freedoms.
            precision: (n, 5, 3) m, required precision of each coordinate; infinite for a free
                coordinate.
        """
        theta = aim.copy()
        joints = self._hinges[JOINTS]
        for i in range(ITERATIONS):
            # In the first half, the tolerance shrinks geometrically to a thousandth of its first
            # value, but not below `precision`.
            share = min(1.0, 2 * i / ITERATIONS)
            sd = np.maximum(precision, _FIRST_PRECISION * 1e-3**share)
            weight = (1 / sd**2).reshape(len(aim), 15)
            q = theta @ self._hinges.T
            tips, by_pose = self._kinematics.tips_and_jacobian(q)
            J = by_pose.reshape(len(aim), 15, -1) @ self._hinges
            miss = (targets - tips).reshape(len(aim), 15)
            over = self._over(q[:, JOINTS])
            blocked = (over != 0) / _WALL**2
            weighted = np.swapaxes(J * weight[..., None], -1, -2)
            H = self._precision + weighted @ J
            H += np.einsum("nj,ja,jb->nab", blocked, joints, joints, optimize=True)
            g = (weighted @ miss[..., None])[..., 0] + (aim - theta) @ self._precision
            g -= (blocked * over) @ joints
            step = np.linalg.solve(H, g[..., None])[..., 0]
            largest = np.abs(step[:, 3:]).max(axis=1, keepdims=True)
            theta = theta + step * np.minimum(1.0, _STEP / np.maximum(largest, _STEP))
        return theta

    def _over(self, joints: Array) -> Array:
        """Signed angles (n, 42) rad beyond the walls."""
        return np.maximum(joints - self._upper, 0) + np.minimum(joints - self._lower, 0)


SUBJECT, DAY, TAKE = 0, 1, 2
"""Keys of random number streams: one for the subject, one for each day, one for each take."""

_PAUSE = 2.0
"""Time (s) between two takes."""

_FREE = 0.05
"""Precision (m) of the position along the surface, at the start of a finger's landing."""

Progress = Callable[[float], None]

TRAINING_DAY = 0
"""Day on whose capture encoders are trained; all later days are for tests."""


def simulate(
    configuration: SubjectConfiguration,
    seed: int,
    day: int,
    progress: Progress | None = None,
    skeleton: Skeleton = ADULT,
    lean: Array | None = None,
) -> Capture:
    """Captures a simulated subject.

    Args:
        configuration: Settings of subjects.
        seed: Seed of the subject: its hinges and all its actions.
        day: 0 plays the training script. Every later day is free play, with markers placed anew.
        progress: Called with the share done, 0 to 1.
        skeleton: The subject's hand. The same seed has the same habits with any skeleton.
        lean: (27,) independent variables of unit variance. The covariance of postures converts them
            to the deviation of the resting posture from the zero pose. None for no deviation.

    Returns:
        The capture; equal arguments give equal captures. `meta["simulated"]` is True.

    Raises:
        InputError: Seed or day is negative.
    """
    for name, value in (("seed", seed), ("day", day)):
        if value < 0:
            raise InputError(f"the {name} is out of range", got=value, expected="0 or more")
    person = _Person(configuration, seed, skeleton, lean)
    session = _Session(person, day)
    takes = takes_of(day, np.random.default_rng([seed, DAY, day, 1]), configuration)
    parts = []
    clock, next_id, done = 0.0, 0, 0
    total = sum(len(t.down) for t in takes)
    for number, take in enumerate(takes):
        rng = np.random.default_rng([seed, TAKE, day, number])
        xy, q = session.record(rng, take)
        ids, next_id = _contact_ids(take.down, next_id)
        xy = np.where(take.down[..., None], xy, np.nan)
        parts.append((clock + take.times, np.full(len(q), number), ids, xy, q))
        clock += take.times[-1] + _PAUSE
        done += len(q)
        if progress:
            progress(done / total)
    meta = {
        "simulated": True,
        "subject": f"simulated {seed}",
        "seed": seed,
        "day": day,
        "side": "right",
        "skeleton": skeleton.name,
        "surface_in": [person.surface.width_in, person.surface.height_in],
        "rate_hz": takes[0].rate,
        "configuration": configuration.as_json(),
    }
    time, trial, ids, xy, q = (np.concatenate(column) for column in zip(*parts, strict=True))
    return Capture(time, trial, ids, xy, q, meta)


@dataclass(frozen=True)
class Subject:
    """A simulated subject whose configuration is frozen.

    Judged days are the days on which methods are tested. Their numbers are derived from the
    configuration and a day seed by SHA-256. The numbers can therefore not be chosen, and they
    change whenever the configuration changes.

    Attributes:
        name: The subject's name.
        seed: Seed of the person in its built-in captures.
        configuration: The configuration as JSON values.
        day: Creates a capture from day number and progress callback.
    """

    name: str
    seed: int
    configuration: dict[str, Any]
    day: Callable[[int, Progress | None], Capture]

    @property
    def digest(self) -> str:
        """SHA-256 of configuration and seed, hexadecimal."""
        text = json.dumps([self.name, self.seed, self.configuration], sort_keys=True)
        return sha256(text.encode()).hexdigest()

    def judged_days(self, count: int, day_seed: int) -> list[int]:
        """Numbers of the first `count` judged days for a day seed; none is the training day."""
        days = []
        for i in range(count):
            drawn = sha256(f"{self.digest} {day_seed} {i}".encode()).digest()
            days.append(TRAINING_DAY + 1 + int.from_bytes(drawn[:3], "big"))
        return days

    def plays(self, capture: Capture) -> bool:
        """True if a capture is the training day of this subject in its current configuration."""
        meta = capture.meta
        return bool(
            meta.get("seed") == self.seed
            and meta.get("day") == TRAINING_DAY
            and json_values(meta.get("configuration")) == self.configuration
        )


@cache
def first_subject() -> Subject:
    """The subject whose training day trains the built-in encoders for a single person."""

    def day(number: int, progress: Progress | None = None) -> Capture:
        return simulate(FROZEN, SEED, number, progress)

    return Subject("first", SEED, json_values(FROZEN.as_json()), day)


def json_values(values: Any) -> Any:
    """Values as JSON returns them: tuples become lists."""
    return json.loads(json.dumps(values))


class _Person:
    """Constants of all days: the hand and its posture at rest."""

    def __init__(
        self,
        configuration: SubjectConfiguration,
        seed: int,
        skeleton: Skeleton = ADULT,
        lean: Array | None = None,
    ) -> None:
        self.configuration, self.seed = configuration, seed
        self.surface = Surface()
        self.kinematics = Kinematics(skeleton)
        rng = np.random.default_rng([seed, SUBJECT])
        self.anatomy = anatomy(rng, skeleton, configuration)
        self.solver = PostureSolver(self.kinematics, self.anatomy)
        # Factor that converts independent unit variables to deviations of posture.
        self.habit = np.linalg.cholesky(self.anatomy.covariance).T
        self.rest, self.layout = self._rest(np.zeros(FREEDOMS) if lean is None else lean)

    def _rest(self, lean: Array) -> tuple[Array, Array]:
        """Posture (27,) with all fingertips on the surface, and their positions (5, 2) m.

        Both are relative to the middle of the fingertips. The posture is as near as possible to the
        zero pose, shifted by the subject's lean.
        """
        aim = (lean @ self.habit)[None]
        aim[0, 2] = -self.kinematics.tips(np.zeros(POSE_SIZE))[:, 2].mean()
        targets = np.zeros((1, len(FINGERS), 3))
        targets[..., 2] = self.configuration.tip_height
        precision = np.full(targets.shape, np.inf)
        precision[..., 2] = self.configuration.contact_precision
        theta = self.solver.solve(aim, targets, precision)[0]
        tips = self.kinematics.tips(self.anatomy.hinges @ theta)[:, :2]
        theta[:2] -= tips.mean(axis=0)
        return theta, tips - tips.mean(axis=0)


class _Session:
    """Constants of one day."""

    def __init__(self, person: _Person, day: int) -> None:
        self.person = person
        c = person.configuration
        rng = np.random.default_rng([person.seed, DAY, day, 0])
        width, height = person.surface.size
        self.elbow = np.array([width / 2, -height - c.elbow_distance])
        self.style = np.zeros(FREEDOMS)
        self.yaw = 0.0
        self.error = np.zeros(POSE_SIZE)
        if day > 0:
            self.elbow = self.elbow + rng.normal(0, c.day_elbow, 2)
            self.style = c.day_style * rng.normal(size=FREEDOMS)
            self.yaw = float(rng.normal(0, c.day_yaw))
            self.error = day_error(rng, c)

    def record(self, rng: np.random.Generator, take: Take) -> tuple[Array, Array]:
        """Measured touches (n, 5, 2) m on the surface and measured poses (n, 48) of a take."""
        person = self.person
        c, times = person.configuration, take.times
        fingers: NDArray[np.bool_] = np.any(take.down, axis=0)
        way = path(rng, times, take.amplitudes, fingers, person.layout, person.surface, c)
        yaw = c.arm_turn * way.turn + self.yaw + c.elbow * self._forearm(way.place)
        pressed = _pressed(take.down, times, c.transition)

        aim = self._aim(rng, times, pressed)
        targets, precision = self._targets(rng, times, pressed)
        # The posture is solved in a frame that turns with the hand, where the root's rotation
        # hardly changes.
        to_hand = exp(_about_z(-yaw))[:, None, :2, :2]
        offset = way.targets - way.place[:, None, :]
        targets[..., :2] = (to_hand @ offset[..., None])[..., 0]
        theta = person.solver.solve(aim, targets, precision)

        q = theta @ person.anatomy.hinges.T
        turned = exp(_about_z(yaw))
        q[:, ROOT_ROTATION] = log(turned @ exp(q[:, ROOT_ROTATION]))
        q[:, ROOT_POSITION] = (turned @ q[:, ROOT_POSITION, None])[..., 0]
        q[:, :2] += way.place
        xy = touches(rng, person.kinematics.place(q), person.kinematics.skeleton, c)
        return xy, measured_pose(rng, times, q, self.error, person.kinematics, c)

    def _forearm(self, place: Array) -> Array:
        """Direction (n,) rad from the elbow to positions (n, 2) m; 0 is straight away from the
        person, and positive is to the left."""
        reach = place - self.elbow
        return np.arctan2(-reach[:, 0], reach[:, 1])

    def _aim(self, rng: np.random.Generator, times: Array, pressed: Array) -> Array:
        """Posture (n, 27) that the subject would take if touches did not constrain it."""
        person, c = self.person, self.person.configuration
        sway = c.sway * smooth_noise(rng, times, c.sway_time, (FREEDOMS,))
        habit = self.style + c.style * rng.normal(size=FREEDOMS) + sway
        lift = c.lift_posture * lifting(curled=bool(rng.random() < c.curl_share))
        deviation = habit @ person.habit
        deviation[:, :6] *= c.root_variety
        return person.rest + deviation + (1 - pressed) @ lift

    def _targets(
        self, rng: np.random.Generator, times: Array, pressed: Array
    ) -> tuple[Array, Array]:
        """Targets (n, 5, 3) m of the fingertips, and their tolerances (n, 5, 3) m.

        Only the heights are set here. The tolerance of a landing finger shrinks gradually, so that
        joints do not jump.
        """
        c = self.person.configuration
        height = rng.uniform(*c.lift_height, len(FINGERS))
        height = height * (1 + 0.15 * smooth_noise(rng, times, c.sway_time, (len(FINGERS),)))
        targets = np.zeros((*pressed.shape, 3))
        targets[..., 2] = c.tip_height + (1 - pressed) * np.maximum(height, 0.5 * c.lift_height[0])
        precision = np.empty(targets.shape)
        loose = (c.lift_precision / c.contact_precision) ** (1 - pressed)
        precision[..., 2] = c.contact_precision * loose
        looser = (_FREE / c.contact_precision) ** (1 - pressed)
        precision[..., :2] = np.where(pressed > 0, c.contact_precision * looser, np.inf)[..., None]
        return targets, precision


def _about_z(angle: Array) -> Array:
    """Rotation vectors (n, 3) about the surface's normal."""
    return angle[:, None] * np.array([0.0, 0.0, 1.0])


def _pressed(down: NDArray[np.bool_], times: Array, transition: float) -> Array:
    """Values (n, 5): 1 while a finger touches, falling to 0 within `transition` (s) before and
    after the touch."""
    out = np.zeros(down.shape)
    for finger in range(down.shape[1]):
        touching = times[down[:, finger]]
        if len(touching):
            away = np.abs(times[:, None] - touching).min(axis=1)
            share = np.clip(1 - away / transition, 0, 1)
            out[:, finger] = share**2 * (3 - 2 * share)
    return out


def _contact_ids(down: NDArray[np.bool_], first: int) -> tuple[NDArray[np.int64], int]:
    """Contact ids (n, 5), and the next free id.

    A finger gets a new id whenever it lands, and has -1 while it is lifted. Fingers that land at
    the same moment get ids in the order of their labels. Callers that must not reveal labels
    shuffle the ids.
    """
    landed = down & ~np.vstack([np.zeros((1, down.shape[1]), bool), down[:-1]])
    order = first + np.cumsum(landed.ravel()).reshape(landed.shape) - 1
    ids = np.where(landed, order, -1)
    # Ids grow with time, so the latest landing is the greatest id so far.
    ids = np.maximum.accumulate(ids, axis=0)
    return np.where(down, ids, -1).astype(np.int64), first + int(landed.sum())


def touches(
    rng: np.random.Generator,
    placement: Placement,
    skeleton: Skeleton,
    configuration: SubjectConfiguration,
) -> Array:
    """Touches (n, 5, 2) m of all fingertips as a screen reports them (x right, y down).

    The flatter a finger lies, the farther the middle of the touch is from the tip. Positions are
    rounded to whole dots.
    """
    last = [*(skeleton.first_bone[1:] - 1), len(skeleton.bones) - 1]
    along = placement.rotations[..., last, :, :][..., 1]
    seen = (placement.tips - configuration.pad_roll * along)[..., :2]
    seen = seen + rng.normal(0, configuration.touch_noise, seen.shape)
    dot = METRES_PER_INCH / configuration.touch_resolution
    return np.round(seen / dot) * dot * np.array([1.0, -1.0])


def day_error(rng: np.random.Generator, configuration: SubjectConfiguration) -> Array:
    """Error (48,) that all poses of a day share, since the positions of markers differ from day to
    day."""
    out = np.empty(POSE_SIZE)
    out[ROOT_POSITION] = rng.normal(0, configuration.day_root[0], 3)
    out[ROOT_ROTATION] = rng.normal(0, configuration.day_root[1], 3)
    out[JOINTS] = rng.normal(0, configuration.day_joint, POSE_SIZE - 6)
    return out


def measured_pose(
    rng: np.random.Generator,
    times: Array,
    q: Array,
    day: Array,
    kinematics: Kinematics,
    configuration: SubjectConfiguration,
) -> Array:
    """Poses (n, 48) as a capture system reports them: with errors, and within anatomic limits.

    A capture system turns joints until the skeleton meets the markers, including those on the
    fingertips. Single joints may be wrong by degrees, but all joints together place the fingertips
    correctly.

    Args:
        rng: Source of the errors.
        times: (n,) s, times of the frames.
        q: (n, 48) true poses.
        day: (48,) constant error of the day.
        kinematics: Kinematics of the skeleton that is fitted to the markers.
        configuration: Sizes of the errors.
    """
    c = configuration
    error = np.tile(day, (len(q), 1))
    error[:, ROOT_POSITION] += rng.normal(0, c.root_noise[0], (len(q), 3))
    error[:, ROOT_ROTATION] += rng.normal(0, c.root_noise[1], (len(q), 3))
    skin = smooth_noise(rng, times, c.soft_tissue_time, (3 * BALL_JOINTS,))
    error[:, JOINTS] += c.soft_tissue * skin + rng.normal(0, c.joint_noise, skin.shape)
    variance = np.empty(POSE_SIZE)
    variance[ROOT_POSITION] = c.root_noise[0] ** 2 + c.day_root[0] ** 2
    variance[ROOT_ROTATION] = c.root_noise[1] ** 2 + c.day_root[1] ** 2
    variance[JOINTS] = c.soft_tissue**2 + c.joint_noise**2 + c.day_joint**2
    tips, by_pose = kinematics.tips_and_jacobian(q)
    out = q + error
    for _ in range(2):
        miss = (tips - kinematics.tips(out)).reshape(len(q), -1, 1)
        J = by_pose.reshape(len(q), -1, POSE_SIZE)
        spread = J * variance
        H = spread @ np.swapaxes(J, -1, -2) + c.tip_marker**2 * np.eye(J.shape[1])
        out = out + (np.swapaxes(spread, -1, -2) @ np.linalg.solve(H, miss))[..., 0]
    return within_limits(out, kinematics.skeleton)
