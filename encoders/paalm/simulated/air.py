"""Simulated hands in the air, with their true poses. Recordings of the first Leap software have no
true poses.

A hand is held open over the device, and then makes gestures: fingers fold together or one by one,
spread, close and pinch, while the palm turns and moves. People differ in hand size, in proportions
and in the coupling of their last joints. All data are simulated, not recorded.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from encoders.capture import Capture
from encoders.paalm.angles import angles_of_joints, joints_of_angles
from encoders.paalm.hand_pose import PALM_CENTRE
from models.arithmetic import Array
from models.kinematics import Kinematics
from models.pose import ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp
from models.skeleton import ADULT, Skeleton

_OVER_DEVICE = np.array([0.0, 0.0, 0.20])
"""Position (m) at which hands are held."""


_SPLAY = np.array([5.0, 6.0, 1.0, -5.0, -14.0])
"""Spread (degrees) of the fingers of an open hand."""

_HELD_OPEN = 2.0
"""Duration (s) of the open hand at the beginning of a take that is made from a capture."""


@dataclass(frozen=True)
class AirConfiguration:
    """Settings of simulated hands. Angles in degrees, lengths in m, times in s.

    Attributes:
        rate: Frame rate (Hz).
        open_seconds: Duration of the open hand at the beginning, long enough for 1000 frames.
        seconds: Duration of all gestures together.
        gesture: Mean duration of a single gesture.
        size, proportion: Standard deviations of hand size and of single bones, as shares.
        open_bend: Mean and spread of PIP of an open hand.
        slope, offset: Mean and spread over people of the coefficients in DIP = slope * PIP +
            offset.
        stray: Spread of a joint's slow deviation from the angle that gesture and coupling give.
        turn: Spread of the palm's roll, pitch and yaw.
        wander: Spread of the palm's position.
    """

    rate: float = 100.0
    open_seconds: float = 10.5
    seconds: float = 20.0
    gesture: float = 0.9
    size: float = 0.07
    proportion: float = 0.03
    open_bend: tuple[float, float] = (10.0, 3.0)
    slope: tuple[float, float] = (0.65, 0.08)
    offset: tuple[float, float] = (2.0, 2.0)
    stray: float = 5.0
    turn: tuple[float, float, float] = (20.0, 12.0, 15.0)
    wander: float = 0.03


FROZEN_AIR = AirConfiguration()


@dataclass(frozen=True)
class AirTake:
    """One continuous take of one hand.

    Attributes:
        time: (T,) s.
        origin: (T, 3) m, palm centre in the device's frame.
        rotation: (T, 3, 3) from palm coordinates to the device's frame. Palms of left hands are
            represented as right palms, so their matrices are reflections.
        joints: (T, 5, 4, 3) m, knuckle, PIP, DIP, tip in palm coordinates.
        open: (T,) booleans, frames in which the hand is held open to be measured.
        side: `right` or `left`.
    """

    time: Array
    origin: Array
    rotation: Array
    joints: Array
    open: NDArray[np.bool_]
    side: str = "right"

    @property
    def angles(self) -> Array:
        """Joint angles (T, 5, 4) in degrees."""
        return angles_of_joints(self.joints)


def simulate_air(
    seed: int, side: str = "right", configuration: AirConfiguration = FROZEN_AIR
) -> AirTake:
    """Simulates a take of one person; every seed is another person.

    Args:
        seed: 0 or more.
        side: The hand, `right` or `left`.
        configuration: Settings of its movement.
    """
    c = configuration
    rng = np.random.default_rng([seed, 0x9AA1])
    count = round((c.open_seconds + c.seconds) * c.rate)
    time = np.arange(count) / c.rate
    is_open = time < c.open_seconds
    knuckles, lengths = body_of(rng, c)
    closing, apart = _gestures(rng, count, is_open, c)
    angles = np.empty((count, 5, 4))
    slope, offset = rng.normal(*c.slope), rng.normal(*c.offset)
    stray = _slow(rng, (count, 5, 4), c.stray, 0.25, c.rate)
    rest_pip = max(rng.normal(*c.open_bend), 3.0)
    angles[..., 0] = 5.0 + 70.0 * closing[..., 0] + stray[..., 0]
    angles[..., 1] = apart + 0.5 * stray[..., 1]
    angles[..., 2] = rest_pip + 88.0 * closing[..., 1] + stray[..., 2] * (0.3 + closing[..., 1])
    angles[..., 3] = slope * angles[..., 2] + offset + stray[..., 3] * (0.3 + closing[..., 1])
    angles[:, 0, 0] = -15.0 + 45.0 * closing[:, 0, 0] + stray[:, 0, 0]
    angles[:, 0, 2] = 10.0 + 50.0 * closing[:, 0, 1] + stray[:, 0, 2]
    angles[:, 0, 3] = 0.0
    low = np.array([-20.0, -25.0, 0.0, -10.0])
    angles = np.clip(angles, low, np.array([90.0, 25.0, 110.0, 80.0]))
    turns = np.deg2rad(np.array(c.turn)) * _slow(rng, (count, 3), 1.0, 0.7, c.rate)
    turns[is_open] *= 0.25
    turns = gaussian_filter1d(turns, 0.2 * c.rate, axis=0, mode="nearest")
    rotation = exp(np.stack([turns[:, 1], turns[:, 0], turns[:, 2]], axis=1))
    origin = _OVER_DEVICE + _slow(rng, (count, 3), c.wander, 0.8, c.rate)
    if side == "left":
        mirror = np.diag([-1.0, 1.0, 1.0])
        rotation, origin = mirror @ rotation, origin * [-1.0, 1.0, 1.0]
    return AirTake(
        time, origin, rotation, joints_of_angles(angles, knuckles, lengths), is_open, side
    )


def turned(take: AirTake, rotation: Array) -> AirTake:
    """The take with the hand turned about its palm's centre in all frames.

    Args:
        take: The take.
        rotation: (3, 3) rotation, in the device's frame.
    """
    return replace(take, rotation=rotation @ take.rotation)


def takes_of_capture(capture: Capture, skeleton: Skeleton = ADULT) -> Iterator[AirTake]:
    """Converts each trial of a capture of touches to a take of a hand over the device.

    Hands on a surface are never held open. Every take therefore begins with the same hand held open
    for 2 s, for calibration. Within half a second, this hand then moves to the first pose of the
    trial.
    """
    kinematics = Kinematics(skeleton)
    for trial in np.unique(capture.trial):
        chosen = capture.trial == trial
        q = capture.q[chosen]
        rotation = exp(q[:, ROOT_ROTATION])
        origin = q[:, ROOT_POSITION] + rotation @ PALM_CENTRE
        placed = kinematics.place(q)
        world = np.empty((len(q), 5, 4, 3))
        for finger in range(5):
            own = [i for i, b in enumerate(skeleton.bones) if b.finger == finger]
            world[:, finger, : len(own)] = placed.joints[:, own]
            world[:, finger, len(own) :] = placed.tips[:, finger, None]
        if skeleton.side == "left":
            rotation = rotation @ np.diag([-1.0, 1.0, 1.0])
        joints = np.einsum("tji,tfkj->tfki", rotation, world - origin[:, None, None])
        time = capture.time[chosen] - capture.time[chosen][0]
        step = float(np.median(np.diff(time))) if len(time) > 1 else 0.01
        before = _opened(joints[0], step)
        count = len(before)
        yield AirTake(
            np.concatenate([step * np.arange(count), time + step * count]),
            np.concatenate([np.repeat(origin[:1], count, axis=0), origin])
            - np.median(origin, axis=0)
            + _OVER_DEVICE,
            np.concatenate([np.repeat(rotation[:1], count, axis=0), rotation]),
            np.concatenate([before, joints]),
            np.arange(count + len(time)) * step < _HELD_OPEN,
            skeleton.side,
        )


def _opened(joints: Array, step: float) -> Array:
    """Joints (k, 5, 4, 3) m of a hand that is held open and then moves to `joints` (5, 4, 3) m.

    `step`: time (s) between frames.
    """
    angles = angles_of_joints(joints)
    lengths = np.linalg.norm(np.diff(joints, axis=1), axis=-1)
    flat = np.zeros_like(angles)
    flat[:, 1] = _SPLAY
    flat[1:, 2] = FROZEN_AIR.open_bend[0]
    share = np.clip((step * np.arange(round(2.5 / step)) - _HELD_OPEN) / 0.5, 0.0, 1.0)
    share = (share * share * (3.0 - 2.0 * share))[:, None, None]
    return joints_of_angles(flat + share * (angles - flat), joints[:, 0], lengths)


def body_of(rng: np.random.Generator, c: AirConfiguration) -> tuple[Array, Array]:
    """Knuckles (5, 3) m in palm coordinates, and bone lengths (5, 3) m, of a random person."""
    size = float(np.clip(1.0 + c.size * rng.standard_normal(), 0.8, 1.2))
    knuckles = np.array([ADULT.bones[i].anchor for i in ADULT.first_bone]) - PALM_CENTRE
    lengths = np.zeros((5, 3))
    for finger in range(5):
        own = [b.length for b in ADULT.bones if b.finger == finger]
        lengths[finger, : len(own)] = own
    lengths *= np.clip(1.0 + c.proportion * rng.standard_normal((5, 3)), 0.9, 1.1)
    return knuckles * size, lengths * size


def _gestures(
    rng: np.random.Generator, count: int, is_open: NDArray[np.bool_], c: AirConfiguration
) -> tuple[Array, Array]:
    """Closing (T, 5, 2) of each finger's first joint and other joints, 0 to 1, and spread (T, 5) in
    degrees."""
    closing, apart = np.zeros((count, 5, 2)), np.zeros((count, 5))
    splay = _SPLAY
    apart[:] = splay
    at = int(np.argmin(is_open)) if not is_open.all() else count
    while at < count:
        end = at + max(round(rng.exponential(c.gesture) * c.rate), round(0.3 * c.rate))
        kind = rng.choice(5, p=(0.2, 0.15, 0.35, 0.15, 0.15))
        level = np.zeros(5)
        if kind == 1:  # fist, more or less
            level[:] = rng.uniform(0.4, 1.0)
        elif kind == 2:  # some fingers fold, others point
            level[:] = rng.uniform(0.5, 1.0) * (rng.random(5) < 0.5)
        elif kind == 3:  # every finger at random
            level[:] = rng.uniform(0.0, 1.0, 5)
        elif kind == 4:  # flexed at the knuckles, or clawed
            level[:] = rng.uniform(0.3, 0.8)
        share = rng.uniform(0.1, 1.0) if kind == 4 else rng.uniform(0.7, 1.0)
        first = level * share
        closing[at:end] = np.stack([first, level * (1.7 - share if kind == 4 else 1.0)], axis=1)
        apart[at:end] = splay * rng.uniform(0.2, 1.2) * (1.0 - 0.7 * level)
        at = end
    width = 0.07 * c.rate
    closing = gaussian_filter1d(closing, width, axis=0, mode="nearest")
    return np.clip(closing, 0.0, 1.05), gaussian_filter1d(apart, width, axis=0, mode="nearest")


def _slow(
    rng: np.random.Generator, shape: tuple[int, ...], spread: float, seconds: float, rate: float
) -> Array:
    """Smooth noise with a standard deviation `spread` and a correlation time `seconds` (s)."""
    noise = gaussian_filter1d(rng.standard_normal(shape), seconds * rate, axis=0, mode="wrap")
    return noise * spread * np.sqrt(2.0 * seconds * rate * np.sqrt(np.pi))
