"""A forward model of the Leap: it computes the device's frames for a hand with known poses.

`v1` is the first software (`first_software`), which PAALM (2013) reads; `v3` is the later one with
labelled joints. `ForwardLeap` sees a hand that moves live; `leap_take` makes whole takes with it.
The configuration is frozen.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.paalm.palm import vector_of
from encoders.paalm.simulated.air import AirTake
from encoders.paalm.simulated.first_software import FirstSoftware
from encoders.paalm.simulated.leap_configuration import FROZEN_LEAP, LeapConfiguration
from models.arithmetic import Array
from models.errors import EncoderError
from models.frames import FINGERS, HandFrame, TrackedFinger, TrackedHand
from models.rotations import exp

DIALECTS = ("v3", "v1")

BALL = 0.23
"""Share of the last bone by which the later software's `tipPosition` is before the bone's end: that
of every finger in the real recording pinch-57fps (4.2 mm on average). On real v3 hands the two are
6.5 mm apart, and not along the bone alone."""

_Seen = tuple[TrackedHand, dict[int, int]]
"""A hand as the device reports it, and the finger of every id of it."""


@dataclass(frozen=True)
class LeapTake:
    """The device's frames, and the truth.

    Attributes:
        frames: T frames of one hand.
        fingers: The finger of every id, frame by frame.
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
        drop_outs: False sees every finger always (v1).

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
        """The device's frame for a hand, and the finger of every id in it.

        Args:
            time: s, time of the frame.
            origin: (3,) m, palm centre in the device's frame.
            rotation: (3, 3) device from palm; a reflection for a left hand.
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
        """Records that the hand has left the view: a returning hand is new to the device."""
        self._hand += 1
        self._first.lose()

    def _without_names(self, step: float, origin: Array, rotation: Array, joints: Array) -> _Seen:
        """The hand in the first software's frame, `step` s after the last one."""
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
        axes = exp(np.deg2rad(c.palm_turn) * rng.standard_normal(3)) @ rotation
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
        # In the later software, the direction is exactly that of the middle bone.
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
        drop_outs: False sees every finger always (v1).
        configuration: Settings of the device.
    """
    device = ForwardLeap(seed, take.side, dialect, configuration, drop_outs)
    moments = zip(take.time.tolist(), take.origin, take.rotation, take.joints, strict=True)
    frames, fingers = zip(*(device.see(*moment) for moment in moments), strict=True)
    return LeapTake(frames, fingers, take.angles, take.open, take.side, dialect)


def balls(world: Array) -> Array:
    """The later software's fingertips (..., 5, 3) of joints (..., 5, 4, 3)."""
    end = world[..., 3, :]
    # A thumb of two bones has its last joint at its end.
    start = np.concatenate([world[..., :1, 1, :], world[..., 1:, 2, :]], axis=-2)
    return np.asarray(end + BALL * (start - end))
