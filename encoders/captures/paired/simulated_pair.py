"""Simulates a paired capture: a SIMULATED person touches a tablet while a Leap sees the hand.

The person is a simulated subject, with individual bones and without the errors of a capture system.
The hand is held open, taps three times, then makes the takes of the simulated subject, lifted
between them. Each device has its own clock, latency and jitter. The data are simulated, not
recorded. The truth is stored with the devices' data.

`encoders.paalm.simulated.forward` simulates the Leap's view, as if no tablet were in the way.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from encoders.capture import Capture
from encoders.captures import subject
from encoders.paalm.average import OPEN_SPREAD
from encoders.paalm.hand_pose import PALM_CENTRE, hand_pose
from encoders.paalm.palm import Palm
from encoders.paalm.simulated.air import AirTake
from encoders.paalm.simulated.forward import LeapTake, leap_take
from encoders.regression.bone_fit import perturbed_skeleton
from models.arithmetic import Array
from models.frames import FINGERS, Contact, TouchFrame
from models.kinematics import Kinematics
from models.pose import ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp, unwrapped
from models.skeleton import ADULT, Skeleton
from models.surface import Surface


@dataclass(frozen=True)
class PairedConfiguration:
    """Settings of a session and of the devices' errors. Lengths in m, times in s.

    Attributes:
        script: Time (s) on day 0 with fingers down, all 26 sets together.
        script_rate: Frame rate (Hz) of the subject on day 0.
        play: Time (s) on each later day with fingers down; the paper has 2,538 frames at 30 Hz.
        open_seconds: Time (s) of the open hand at the beginning.
        taps: Times (s) from the end of one tap to the next touch-down, uneven on purpose.
        tap: Time (s) for which a tap lasts.
        every: 1 uses all takes, n uses every n-th take; this leaves out some sets of fingers.
        pause: Least and greatest time (s) between takes.
        lift: Height of the hand's path between takes.
        size, bone, knuckle: Spread of the person's size and of the length of every bone, as shares,
            and of every coordinate of a knuckle (m).
        touch_rate, leap_rate: Frame rates (Hz).
        touch_latency, leap_latency: Constant part (s) of the time from an event to its arrival.
        jitter: Mean (s) of the random, exponentially distributed part of that time.
        drift: Share by which the Leap's clock is too slow.
        tilt: Rotation (rad) of the Leap's axes relative to the surface's: pitch, roll, yaw.
        at: Position (m) of the Leap in the surface's frame.
    """

    script: float = 150.0
    script_rate: float = 30.0
    play: float = 84.6
    open_seconds: float = 4.0
    taps: tuple[float, ...] = (0.55, 0.9, 0.4)
    tap: float = 0.15
    every: int = 1
    pause: tuple[float, float] = (0.7, 1.6)
    lift: float = 0.035
    size: float = 0.05
    bone: float = 0.04
    knuckle: float = 0.003
    touch_rate: float = 60.0
    leap_rate: float = 100.0
    touch_latency: float = 0.012
    leap_latency: float = 0.035
    jitter: float = 0.004
    drift: float = 60e-6
    tilt: tuple[float, float, float] = (0.07, -0.05, 0.20)
    at: tuple[float, float, float] = (0.09, -0.20, -0.10)


_LIFTED = 0
"""Stands for the id of a finger that does not tap."""
_TREMBLE = 2e-4
"""Noise (m) of the touches of taps; touches of takes have the subject's noise."""

FROZEN_PAIRED = PairedConfiguration()


@dataclass(frozen=True)
class PairedSession:
    """Data of both devices, and the truth.

    Attributes:
        touches: The tablet's touches; times on its own clock.
        touch_arrived: (n,) s, arrival times on the host's clock.
        leap: The Leap's frames; times on its own clock.
        leap_arrived: (m,) s, arrival times on the host's clock.
        surface: The tablet's surface.
        truth: The subject's capture: every touch with its finger, the true pose and time.
        labels: Id of a touch -> its finger.
        touch_delay, leap_delay: Mean delay from event to arrival (s).
        rotation, shift: The Leap's frame in the surface's frame.
        side: The hand, left or right.
        motion: The hand's true motion: times (n,) s and poses (n, 48) in the surface frame, between
            which the hand moves smoothly. A left hand is mirrored to a right hand.
        skeleton: The person's bones.
    """

    touches: tuple[TouchFrame, ...]
    touch_arrived: Array
    leap: LeapTake
    leap_arrived: Array
    surface: Surface
    truth: Capture
    labels: dict[int, int]
    touch_delay: float
    leap_delay: float
    rotation: Array
    shift: Array
    side: str
    motion: tuple[Array, Array]
    skeleton: Skeleton

    def poses_at(self, times: Array) -> Array:
        """True poses (m, 48) in the surface frame; a left hand is mirrored to a right hand."""
        return _at(times, *self.motion)

    @property
    def offset(self) -> float:
        """Mean arrival time of the Leap minus that of the touches, for the same event (s)."""
        return self.leap_delay - self.touch_delay


def simulate_paired(
    seed: int,
    day: int = 0,
    dialect: str = "v3",
    side: str = "right",
    configuration: PairedConfiguration = FROZEN_PAIRED,
    progress: Callable[[float], None] | None = None,
) -> PairedSession:
    """Simulates a session of one person; every seed is another person.

    Args:
        seed: Seed of the person and, together with the day, of the whole session.
        day: 0 is the training script; on later days, the subject plays freely.
        dialect: Version of the Leap software, `v3` or `v1`.
        side: The hand; a left hand is simulated as the mirror image of a right hand.
        configuration: Settings of session and devices.
        progress: Called with the share done, 0 to 1.
    """
    c = configuration
    rng = np.random.default_rng([seed, day, 0x70C3])
    truth, joints_of, centre, skeleton = _person(seed, day, c, progress)
    if c.every > 1:
        truth = truth.select(np.isin(truth.trial, np.unique(truth.trial)[:: c.every]))
    time, q, starts = _motion(rng, truth, c)
    surface = Surface()
    width = float(surface.size[0])
    moved = np.concatenate(
        [t + truth.time[truth.trial == k] - truth.time[truth.trial == k][0] for k, t in starts]
    )
    truth = replace(truth, time=moved)
    touches = _touched(rng, truth, starts, time, c)
    if side == "left":
        touches = tuple(_mirrored(f, width) for f in touches)
    # The device is rotated and shifted. A left hand is mirrored.
    x, y, z = c.tilt
    rotation = exp([0.0, 0.0, z]) @ exp([x, 0.0, 0.0]) @ exp([0.0, y, 0.0])
    shift = np.array(c.at)
    leap_time = np.arange(0.0, time[-1], 1.0 / c.leap_rate)
    pose = _at(leap_time, time, q)
    take = _air(leap_time, pose, joints_of, centre, rotation, shift, c.open_seconds, side)
    what = leap_take(take, seed + 1000 * day, dialect)
    drifted = 17.0 + leap_time * (1.0 - c.drift)
    frames = tuple(replace(f, time=t) for f, t in zip(what.frames, drifted.tolist(), strict=True))
    tablet = np.array([f.time for f in touches])
    return PairedSession(
        tuple(replace(f, time=f.time + 3.0) for f in touches),
        tablet + c.touch_latency + rng.exponential(c.jitter, len(tablet)),
        replace(what, frames=frames),
        leap_time + c.leap_latency + rng.exponential(c.jitter, len(leap_time)),
        surface,
        truth,
        {int(i): f for f in range(len(FINGERS)) for i in np.unique(truth.ids[:, f]) if i >= 0},
        c.touch_latency + c.jitter,
        c.leap_latency + c.jitter,
        rotation,
        shift,
        side,
        (time, q),
        skeleton,
    )


JointsOf = Callable[[Array], Array]


def _person(
    seed: int,
    day: int,
    c: PairedConfiguration,
    progress: Callable[[float], None] | None,
) -> tuple[Capture, JointsOf, Array, Skeleton]:
    """Simulates the subject's day without errors of measurement.

    Returns:
        The capture; a function from poses (n, 48) to joints (n, 5, 4, 3) m; the palm's centre (3,)
        m in the hand's frame, scaled from an average palm; the person's skeleton.
    """
    plain = subject.FROZEN
    clean = replace(
        plain,
        day_joint=0.0,
        day_root=(0.0, 0.0),
        soft_tissue=0.0,
        joint_noise=0.0,
        root_noise=(0.0, 0.0),
        training_rate=c.script_rate,
        training_frames=_frames(plain.training_frames, c.script * c.script_rate),
        test_frames=_frames(plain.test_frames, c.play * plain.test_rate),
    )
    rng = np.random.default_rng([seed, 0xB0E5])
    size = float(np.clip(1.0 + c.size * rng.standard_normal(), 0.88, 1.12))
    skeleton = perturbed_skeleton(ADULT.scaled(size), rng, c.bone, c.knuckle)
    kinematics = Kinematics(skeleton)
    capture = subject.simulate(clean, seed, day, progress, skeleton)

    def placed(q: Array) -> Array:
        placement = kinematics.place(q)
        return _by_finger(placement.joints, placement.tips)

    return capture, placed, size * np.array(PALM_CENTRE), skeleton


def _frames(paper: tuple[int, ...], total: float) -> tuple[int, int, int, int]:
    """Number of frames of a day by number of fingers, in the paper's proportions."""
    a, b, d, e = (round(total * n / sum(paper)) for n in paper)
    return a, b, d, e


def _by_finger(joints: Array, tips: Array) -> Array:
    out = np.empty((len(joints), len(FINGERS), 4, 3))
    for finger in range(len(FINGERS)):
        own = [i for i, bone in enumerate(ADULT.bones) if bone.finger == finger]
        out[:, finger, : len(own)] = joints[:, own]
        out[:, finger, len(own) :] = tips[:, finger, None]
    return out


def _motion(
    rng: np.random.Generator, truth: Capture, c: PairedConfiguration
) -> tuple[Array, Array, list[tuple[int, float]]]:
    """Motion of the whole session: times (n,) s, poses (n, 48), and the start (s) of each take."""
    rise = c.lift
    five = truth.q[int(truth.down.sum(axis=1).argmax())]
    flat = _open_pose(five)
    times, poses = [0.0], [flat]

    def go(q: Array, seconds: float, lifted: float) -> None:
        """Moves to a pose; the hand rises and comes down again on the way."""
        share = np.linspace(0.0, 1.0, max(3, round(seconds * 60.0)))[1:]
        last = poses[-1]
        turned = q.copy()
        turned[ROOT_ROTATION] = unwrapped(q[ROOT_ROTATION], last[ROOT_ROTATION])
        for s in share.tolist():
            smooth = s * s * (3.0 - 2.0 * s)
            row = last + smooth * (turned - last)
            row[2] += lifted * np.sin(np.pi * s)
            poses.append(row)
            times.append(times[-1] + seconds * (share[1] - share[0]))

    go(flat, c.open_seconds, 0.0)
    go(five, 1.0, 0.0)
    for gap in c.taps:
        go(five, gap, rise)
        go(five, c.tap, 0.0)
    starts: list[tuple[int, float]] = []
    for trial in np.unique(truth.trial).tolist():
        rows = np.flatnonzero(truth.trial == trial)
        go(truth.q[rows[0]], float(rng.uniform(*c.pause)), rise)
        starts.append((trial, times[-1]))
        for row in rows[1:].tolist():
            q = truth.q[row].copy()
            q[ROOT_ROTATION] = unwrapped(q[ROOT_ROTATION], poses[-1][ROOT_ROTATION])
            poses.append(q)
            times.append(starts[-1][1] + float(truth.time[row] - truth.time[rows[0]]))
    go(five, 1.0, 2 * rise)
    return np.array(times), np.array(poses), starts


def _open_pose(over: Array) -> Array:
    """Pose (48,) of a flat open hand, 12 cm above the wrist of the pose `over`."""
    table = np.zeros((len(FINGERS), 4))
    table[:, 1], table[:, 2], table[:, 3] = OPEN_SPREAD, 8.0, 5.0
    palm = Palm((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    q = hand_pose(table, palm)
    q[ROOT_POSITION] = over[ROOT_POSITION] + [0.0, 0.0, 0.12]
    return q


def _at(wanted: Array, time: Array, q: Array) -> Array:
    """Interpolates poses at times `wanted`, by cubics that do not overshoot where the hand
    rests."""
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(time, q, axis=0)(wanted))


def _touched(
    rng: np.random.Generator,
    truth: Capture,
    starts: list[tuple[int, float]],
    time: Array,
    c: PairedConfiguration,
) -> tuple[TouchFrame, ...]:
    """Frames of the tablet: frames with contacts, and one empty frame after each last lift."""
    grid = np.arange(0.0, time[-1], 1.0 / c.touch_rate)
    frames: list[TouchFrame] = []
    rows_of = {trial: np.flatnonzero(truth.trial == trial) for trial, _ in starts}
    spans: list[tuple[float, float, Array, Array]] = []
    # All taps use the touches of one frame with the most fingers.
    five = int(truth.down.sum(axis=1).argmax())
    clock, number = c.open_seconds + 1.0, -1
    for gap in c.taps:
        clock += gap
        ids = np.where(truth.down[five], number - np.arange(len(FINGERS)), _LIFTED)
        number -= len(FINGERS)
        spans.append((clock, clock + c.tap, ids, truth.xy[five]))
        clock += c.tap
    taken = 0
    order = [(t, rows_of[k]) for k, t in starts]
    for t in grid.tolist():
        contacts: list[Contact] = []
        for begin, end, ids, xy in spans:
            if begin <= t < end:
                places = (xy + rng.normal(0.0, _TREMBLE, xy.shape)).tolist()
                contacts = [
                    Contact(1_000_000 - i, x, y)
                    for i, (x, y) in zip(ids.tolist(), places, strict=True)
                    if i != _LIFTED
                ]
        while taken < len(order) and t > order[taken][0] + _length(truth, order[taken][1]):
            taken += 1
        if taken < len(order) and t >= order[taken][0]:
            contacts = _contacts(truth, order[taken][1], t - order[taken][0])
        if contacts or (frames and frames[-1].contacts):
            frames.append(TouchFrame(t, tuple(contacts), source="simulated tablet"))
    return tuple(frames)


def _length(truth: Capture, rows: NDArray[np.int64]) -> float:
    return float(truth.time[rows[-1]] - truth.time[rows[0]])


def _contacts(truth: Capture, rows: NDArray[np.int64], since: float) -> list[Contact]:
    """Contacts of a take at a moment, interpolated linearly between its frames."""
    times = truth.time[rows] - truth.time[rows[0]]
    after = int(np.clip(np.searchsorted(times, since, side="right"), 1, len(rows) - 1))
    a, b = rows[after - 1], rows[after]
    share = float(np.clip((since - times[after - 1]) / (times[after] - times[after - 1]), 0, 1))
    out = []
    for finger in range(len(FINGERS)):
        id_ = int(truth.ids[a, finger])
        if id_ >= 0:
            same = truth.ids[b, finger] == id_
            xy = truth.xy[a, finger] + (share if same else 0.0) * np.nan_to_num(
                truth.xy[b, finger] - truth.xy[a, finger]
            )
            out.append(Contact(id_, float(xy[0]), float(xy[1])))
    return out


def _mirrored(frame: TouchFrame, width: float) -> TouchFrame:
    return replace(frame, contacts=tuple(replace(k, x=width - k.x) for k in frame.contacts))


def _air(
    time: Array,
    q: Array,
    joints_of: JointsOf,
    centre: Array,
    rotation: Array,
    shift: Array,
    open_seconds: float,
    side: str,
) -> AirTake:
    """The hand in the device's frame; `rotation` and `shift` give the device's pose in the
    surface's frame."""
    palm = exp(q[:, ROOT_ROTATION])
    origin = q[:, ROOT_POSITION] + palm @ centre
    world = joints_of(q)
    joints = np.einsum("tji,tfkj->tfki", palm, world - origin[:, None, None])
    origin, palm = (origin - shift) @ rotation, rotation.T @ palm
    if side == "left":
        mirror = np.diag([-1.0, 1.0, 1.0])
        origin, palm = origin @ mirror, mirror @ palm
    return AirTake(time, origin, palm, joints, time < open_seconds, side)
