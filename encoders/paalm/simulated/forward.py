"""A forward model of the Leap: it computes the device's frames for a hand with known poses.

`v1` is the first software (`FirstSoftware`), whose data PAALM (2013) used. `v3` is the later
software, which reports labelled joints. `ForwardLeap` computes one frame at a time, for a hand that
moves live. `leap_take` computes whole takes by `ForwardLeap`. The configuration is frozen.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, exp, log, sqrt
from statistics import NormalDist

import numpy as np
from numpy.typing import NDArray

from encoders.paalm.palm import vector_of
from encoders.paalm.simulated.air import AirTake
from models.arithmetic import Array
from models.errors import EncoderError
from models.frames import FINGERS, HandFrame, TrackedFinger, TrackedHand
from models.rotations import exp as rotation_exp

QUANTILES = (0.0, 0.01, 0.05, 0.1, 0.25, 0.4, 0.5, 0.6, 0.75, 0.9, 1.0)
"""Quantiles at which `LeapConfiguration.seen` gives its values."""


@dataclass(frozen=True)
class LeapConfiguration:
    """Settings of the device. Lengths in m, angles in degrees, times in s.

    Attributes:
        joint: Standard deviation of the later software's joint positions.
        palm_place, palm_turn: Standard deviations of position and rotation of the later software's
            palm. All settings below are those of the first software.
        hidden, thumb_hidden: Share of the first bone that counts as palm, for fingers and for the
            thumb. In the recording, the greatest lengths are 71 to 82 mm for index, middle and ring
            finger and 52 to 55 mm for the thumb. An average hand has these lengths if about these
            shares are left out.
        seen: Share of the finger, without its hidden part, that is seen from the tip on, at each of
            `QUANTILES`. It does not depend on how far the finger is bent.
        seen_seconds: Time constant with which this share changes smoothly.
        seen_alike: Correlation between the shares of two fingers.
        length_slow: Standard deviation of slow errors of a length, as a share of the length.
        tip, length, direction: Standard deviations of tips, lengths and directions from frame to
            frame.
        aside, aside_seconds: Standard deviation and time constant of slow errors of a direction.
        centre: Reported centre of the palm, in palm coordinates. For either hand, x points towards
            the little finger.
        centre_wanders, wander_seconds: Standard deviation and time constant of the centre's slow
            movement forwards and backwards.
        centre_place, centre_turn: Standard deviations of position and rotation of the palm from
            frame to frame.
        reversed_share, reversed_for: Probability that a hand comes into view with its palm reported
            the wrong way round, and the duration of this error.
        folded: Share of a finger's straight length. A finger whose tip is nearer to its base is not
            seen.
        turned_in: Angle from the palm's direction beyond which a finger is not seen.
        merged: Distance between two tips below which only the longer finger is reported.
        lost_rate, lost: Rate (Hz) at which a visible finger is lost at random, and range of the
            duration (s) of the loss. The logarithm of the duration is uniform.
        fresh: Probability that a lost finger returns with a new id.
        back: Time (s) for which a hidden finger must be visible before it is reported again.
        swapped: Rate (Hz) at which two neighbours exchange their ids.
    """

    joint: float = 0.0005
    palm_place: float = 0.0005
    palm_turn: float = 0.4
    hidden: float = 0.45
    thumb_hidden: float = 0.9
    seen: tuple[float, ...] = (0.14, 0.25, 0.44, 0.54, 0.69, 0.81, 0.9, 0.96, 0.99, 1.0, 1.0)
    seen_seconds: float = 0.2
    seen_alike: float = 0.5
    length_slow: float = 0.01
    tip: float = 0.00002
    length: float = 0.00004
    direction: float = 0.03
    aside: float = 5.5
    aside_seconds: float = 0.3
    centre: tuple[float, float, float] = (-0.007, 0.031, -0.005)
    centre_wanders: float = 0.005
    wander_seconds: float = 0.2
    centre_place: float = 0.00002
    centre_turn: float = 0.03
    reversed_share: float = 0.5
    reversed_for: float = 0.3
    folded: float = 0.5
    turned_in: float = 80.0
    merged: float = 0.012
    lost_rate: float = 0.65
    lost: tuple[float, float] = (0.008, 0.8)
    fresh: float = 0.15
    back: float = 0.03
    swapped: float = 0.1


FROZEN_LEAP = LeapConfiguration()

PRINTED_LEAP = LeapConfiguration(
    seen=(1.0,) * len(QUANTILES),
    length_slow=0.02,
    tip=0.0005,
    length=0.0004,
    direction=1.5,
    aside=0.0,
    centre=(0.0, 0.0, 0.0),
    centre_wanders=0.0,
    centre_place=0.0005,
    centre_turn=0.4,
    reversed_share=0.0,
    lost_rate=0.15,
    lost=(0.05, 0.4),
    fresh=1.0,
    swapped=0.0,
)
"""The device that the paper describes: a finger's length shows how far the finger is bent. No real
recording behaves like this. The configuration serves to test the paper's method as published."""


DIALECTS = ("v3", "v1")

BALL = 0.23
"""Distance from the end of the last bone back to the later software's `tipPosition`, as a share of
the last bone. Every finger in the real recording pinch-57fps has this share (4.2 mm on average). On
real v3 hands, `tipPosition` is 6.5 mm from the end of the bone, and not only along the bone."""

_Seen = tuple[TrackedHand, dict[int, int]]
"""A hand as the device reports it, and the finger of every id."""


@dataclass(frozen=True)
class LeapTake:
    """The device's frames, and the truth.

    Attributes:
        frames: T frames of one hand.
        fingers: For each of the T frames: id -> finger.
        angles: (T, 5, 4) degrees, true angles.
        open: (T,) booleans, frames in which the hand was held open to be measured.
        side: `right` or `left`.
        dialect: `v1` or `v3`.
    """

    frames: tuple[HandFrame, ...]
    fingers: tuple[dict[int, int], ...]
    angles: Array
    open: NDArray[np.bool_]
    side: str
    dialect: str


class ForwardLeap:
    """A simulated device over which one hand moves.

    Args:
        seed: Seed of noise, order and drop-outs.
        side: `right` or `left`.
        dialect: `v1` or `v3`.
        configuration: Settings of the device.
        drop_outs: False reports every finger in every frame (v1).

    Raises:
        EncoderError: The dialect is unknown.
    """

    def __init__(
        self,
        seed: int,
        side: str = "right",
        dialect: str = "v3",
        configuration: LeapConfiguration = FROZEN_LEAP,
        drop_outs: bool = True,
    ) -> None:
        if dialect not in DIALECTS:
            raise EncoderError("no such dialect", got=dialect, expected=" or ".join(DIALECTS))
        self._rng = np.random.default_rng([seed, 0x1EA9, 2])
        self._c, self._side, self._dialect = configuration, side, dialect
        self._time: float | None = None
        self._hand = 1
        chance = np.random.default_rng([seed, 0x1EA9, 1])
        self._first = FirstSoftware(chance, configuration, drop_outs)

    def see(
        self, time: float, origin: Array, rotation: Array, joints: Array
    ) -> tuple[HandFrame, dict[int, int]]:
        """The device's frame for a hand, and the finger of every id in this frame.

        Args:
            time: Time (s) of the frame.
            origin: (3,) m, palm centre in the device's frame.
            rotation: (3, 3) from palm coordinates to the device's frame; a reflection for a left
                hand.
            joints: (5, 4, 3) m, knuckle, PIP, DIP, tip in palm coordinates.
        """
        step = 0.0 if self._time is None else max(time - self._time, 0.0)
        self._time = time
        if self._dialect == "v1":
            hand, fingers = self._without_names(step, origin, rotation, joints)
        else:
            hand, fingers = self._with_joints(origin, rotation, joints)
        return HandFrame(time, (hand,), f"simulated {self._dialect}", self._dialect), fingers

    def lose(self) -> None:
        """Records that the hand has left the view. The device treats a returning hand as new."""
        self._hand += 1
        self._first.lose()

    def _without_names(self, step: float, origin: Array, rotation: Array, joints: Array) -> _Seen:
        """The hand in the first software's frame, at a time `step` (s) after the last frame."""
        seen = self._first.see(step, origin, rotation, joints)
        shown = [f for f in self._rng.permutation(len(FINGERS)).tolist() if seen.ids[f]]
        fingers = tuple(
            TrackedFinger(
                int(seen.ids[f]),
                vector_of(seen.tips[f]),
                vector_of(seen.along[f]),
                float(seen.lengths[f]),
            )
            for f in shown
        )
        found = TrackedHand(
            self._hand,
            vector_of(seen.origin),
            vector_of(-seen.axes[:, 2]),
            vector_of(seen.axes[:, 1]),
            fingers,
        )
        return found, {int(seen.ids[f]): f for f in shown}

    def _with_joints(self, origin: Array, rotation: Array, joints: Array) -> _Seen:
        rng, c = self._rng, self._c
        axes = rotation_exp(np.deg2rad(c.palm_turn) * rng.standard_normal(3)) @ rotation
        palm = origin + c.palm_place * rng.standard_normal(3)
        world = origin + joints @ rotation.T
        world = world + c.joint * rng.standard_normal(world.shape)
        fingers = self._fingers(world)
        hand = TrackedHand(
            self._hand,
            vector_of(palm),
            vector_of(-axes[:, 2]),
            vector_of(axes[:, 1]),
            fingers,
            self._side,
        )
        return hand, {10 + f: f for f in range(len(FINGERS))}

    def _fingers(self, world: Array) -> tuple[TrackedFinger, ...]:
        # The later software reports exactly the direction of the middle bone.
        along = world[:, 2] - world[:, 1]
        along /= np.linalg.norm(along, axis=1, keepdims=True)
        length = np.linalg.norm(np.diff(world, axis=1), axis=2).sum(axis=1)
        tips = balls(world)
        rows = []
        for f in self._rng.permutation(len(FINGERS)).tolist():
            mcp, pip, dip, end = (vector_of(j) for j in world[f])
            rows.append(
                TrackedFinger(
                    10 + f,
                    vector_of(tips[f]),
                    vector_of(along[f]),
                    float(length[f]),
                    f,
                    (mcp, pip, dip, end),
                )
            )
        return tuple(rows)


def leap_take(
    take: AirTake,
    seed: int,
    dialect: str = "v1",
    drop_outs: bool = True,
    configuration: LeapConfiguration = FROZEN_LEAP,
) -> LeapTake:
    """Computes the device's frames for a take.

    Args:
        take: The hand.
        seed: Seed of noise, order and drop-outs.
        dialect: `v1` or `v3`.
        drop_outs: False reports every finger in every frame (v1).
        configuration: Settings of the device.
    """
    device = ForwardLeap(seed, take.side, dialect, configuration, drop_outs)
    moments = zip(take.time.tolist(), take.origin, take.rotation, take.joints, strict=True)
    frames, fingers = zip(*(device.see(*moment) for moment in moments), strict=True)
    return LeapTake(frames, fingers, take.angles, take.open, take.side, dialect)


def balls(world: Array) -> Array:
    """Fingertips (..., 5, 3) that the later software reports for joints (..., 5, 4, 3)."""
    end = world[..., 3, :]
    # In a thumb of two bones, the third and fourth point coincide; the last bone begins at the
    # second point.
    start = np.concatenate([world[..., :1, 1, :], world[..., 1:, 2, :]], axis=-2)
    return np.asarray(end + BALL * (start - end))


_FIVE = len(FINGERS)
_SLOW = 0.5
"""Time constant (s) of the slow errors of lengths."""
_FINE = 4
"""Least number of steps of a smooth process per time constant."""
_LONG = 20
"""Largest number of steps of a smooth process for one frame. After a gap of this length, no
correlation with earlier values is left."""
_SCORES = np.array([NormalDist().inv_cdf(min(max(q, 1e-4), 1.0 - 1e-4)) for q in QUANTILES])
_ROUND = np.diag([1.0, -1.0, -1.0])
"""Half turn of a palm about the line across it."""


@dataclass(frozen=True)
class SeenHand:
    """A hand as the device reports it.

    Attributes:
        origin: (3,) m, centre of the palm.
        axes: (3, 3) from palm coordinates to the device's frame.
        ids: (5,) ids by finger; 0 for a finger that is not seen.
        tips: (5, 3) m, fingertips.
        along: (5, 3) directions of the fingers.
        lengths: (5,) m, visible lengths.
    """

    origin: Array
    axes: Array
    ids: NDArray[np.int64]
    tips: Array
    along: Array
    lengths: Array


class FirstSoftware:
    """One hand as the first Leap software reports it, frame by frame.

    Each finger has the direction and length of its visible part. The visible length changes slowly,
    even if the finger does not move, and the direction does not change with it. The only recording
    of real hands behaves like this (see `LeapConfiguration`).

    Args:
        rng: Random generator.
        configuration: Settings of the device.
        drop_outs: False reports every finger in every frame.
    """

    def __init__(
        self,
        rng: np.random.Generator,
        configuration: LeapConfiguration,
        drop_outs: bool = True,
    ) -> None:
        c = configuration
        self._rng, self._c, self._drop_outs = rng, c, drop_outs
        self._hidden = np.array([c.thumb_hidden, *[c.hidden] * (_FIVE - 1)])
        # One process that all fingers share, and one for each finger.
        self._share = _Smooth(rng, 1 + _FIVE, c.seen_seconds)
        self._wander = _Smooth(rng, 1, c.wander_seconds)
        self._aside = _Smooth(rng, 3 * _FIVE, c.aside_seconds)
        self._long = rng.standard_normal(_FIVE)
        self._now = 0.0
        self._ids, self._last_ids = np.zeros(_FIVE, np.int64), np.zeros(_FIVE, np.int64)
        self._fresh = 1
        self._since = np.full(_FIVE, c.back)
        self._lost_until = np.full(_FIVE, -1.0)
        self._arrives()

    def lose(self) -> None:
        """Records that the hand has left the view. The device treats a returning hand as new."""
        self._ids[:] = self._last_ids[:] = 0
        self._arrives()

    def see(self, step: float, origin: Array, rotation: Array, joints: Array) -> SeenHand:
        """The device's view of a hand.

        Args:
            step: Time (s) since the last frame.
            origin: (3,) m, centre of the palm, as in `PALM_CENTRE`, in the device's frame.
            rotation: (3, 3) from palm coordinates to the device's frame; a reflection for a left
                hand.
            joints: (5, 4, 3) m, knuckle, PIP, DIP, tip in palm coordinates.
        """
        rng, c = self._rng, self._c
        self._now += step
        world = origin + joints @ rotation.T
        base = world[:, 0] + self._hidden[:, None] * (world[:, 1] - world[:, 0])
        tips = world[:, 3] + c.tip * rng.standard_normal((_FIVE, 3))
        line = tips - base
        whole = np.linalg.norm(line, axis=1)
        keep = exp(-step / _SLOW)
        self._long = keep * self._long + sqrt(1.0 - keep**2) * rng.standard_normal(_FIVE)
        aside = self._aside.after(step).reshape(_FIVE, 3)
        turn = np.deg2rad(c.aside * aside + c.direction * rng.standard_normal((_FIVE, 3)))
        along = (rotation_exp(turn) @ (line / whole[:, None])[..., None])[..., 0]
        own = self._share.after(step)
        score = sqrt(c.seen_alike) * own[0] + sqrt(1.0 - c.seen_alike) * own[1:]
        lengths = whole * np.interp(score, _SCORES, c.seen) * (1.0 + c.length_slow * self._long)
        lengths = np.maximum(lengths + c.length * rng.standard_normal(_FIVE), 0.002)
        axes = rotation_exp(np.deg2rad(c.centre_turn) * rng.standard_normal(3)) @ rotation
        centre = np.array(c.centre)
        centre[1] += c.centre_wanders * float(self._wander.after(step)[0])
        place = origin + rotation @ centre + c.centre_place * rng.standard_normal(3)
        if self._now < self._right_from:
            axes = axes @ _ROUND
        self._name(self._visible(world, tips, whole, line, rotation), tips, step)
        return SeenHand(place, axes, self._ids.copy(), tips, along, lengths)

    def _arrives(self) -> None:
        c = self._c
        wrong = self._drop_outs and self._rng.random() < c.reversed_share
        self._right_from = self._now + (c.reversed_for if wrong else 0.0)

    def _visible(
        self, world: Array, tips: Array, whole: Array, line: Array, rotation: Array
    ) -> NDArray[np.bool_]:
        """Booleans (5,): fingers that are not folded, turned in or merged with a longer finger."""
        if not self._drop_outs:
            return np.ones(_FIVE, bool)
        c = self._c
        bones = np.linalg.norm(np.diff(world, axis=1), axis=2)
        straight = bones.sum(axis=1) - self._hidden * bones[:, 0]
        visible = (whole > c.folded * straight) & (
            line @ rotation[:, 1] > whole * np.cos(np.deg2rad(c.turned_in))
        )
        apart = np.linalg.norm(tips[:, None] - tips[None], axis=2)
        merged = (apart < c.merged) & (whole[:, None] < whole[None])
        return np.asarray(visible & ~merged.any(axis=1))

    def _name(self, visible: NDArray[np.bool_], tips: Array, step: float) -> None:
        """Updates the ids: loses fingers, finds them again, and swaps ids of neighbours."""
        rng, c = self._rng, self._c
        hazard = rng.random(_FIVE) < c.lost_rate * step
        span = np.exp(rng.uniform(log(c.lost[0]), log(c.lost[1]), _FIVE))
        if self._drop_outs:
            self._lost_until = np.where(
                hazard & (self._now >= self._lost_until), self._now + span, self._lost_until
            )
        hidden = ~visible
        self._since = np.where(hidden, 0.0, self._since + step)
        up = (self._since >= c.back) & (self._now >= self._lost_until)
        fresh, swaps = rng.random(_FIVE), rng.random() < c.swapped * step
        for f in range(_FIVE):
            if not up[f]:
                self._ids[f] = 0
            elif not self._ids[f]:
                if not self._last_ids[f] or fresh[f] < c.fresh:
                    self._last_ids[f], self._fresh = self._fresh, self._fresh + 1
                self._ids[f] = self._last_ids[f]
        pair = int(rng.integers(1, _FIVE - 1))
        if swaps and self._drop_outs and self._ids[pair] and self._ids[pair + 1]:
            both = [pair + 1, pair]
            self._ids[[pair, pair + 1]] = self._ids[both]
            self._last_ids[[pair, pair + 1]] = self._last_ids[both]


class _Smooth:
    """Smooth random processes with a standard deviation of 1: white noise, low-passed twice.

    Args:
        rng: Random generator.
        count: Number of processes.
        seconds: Time constant (s) of both low-passes.
    """

    def __init__(self, rng: np.random.Generator, count: int, seconds: float) -> None:
        self._rng, self._seconds = rng, seconds
        self._first = rng.standard_normal(count)
        # Stationary start: the second stage has half of the variance, and is correlated with the
        # first stage.
        self._second = 0.5 * self._first + 0.5 * rng.standard_normal(count)

    def after(self, step: float) -> Array:
        """The values at a time `step` (s) later."""
        steps = min(ceil(_FINE * step / self._seconds), _LONG) if step > 0.0 else 0
        for _ in range(steps):
            keep = exp(-step / steps / self._seconds)
            white = self._rng.standard_normal(len(self._first))
            self._first = keep * self._first + sqrt(1.0 - keep**2) * white
            self._second = keep * self._second + (1.0 - keep) * self._first
        return sqrt(2.0) * self._second
