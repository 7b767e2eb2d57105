"""A forward model of the Leap: it computes the device's frames for a hand with known poses.

`v1` is the first software (`first_software`), `v3` the later one with labelled joints. The
configuration is frozen.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.paalm.palm import vector_of
from encoders.paalm.simulated.air import AirTake
from encoders.paalm.simulated.first_software import FirstSoftware, SeenHand
from encoders.paalm.simulated.leap_configuration import FROZEN_LEAP, LeapConfiguration
from models.arithmetic.arrays import Array
from models.frames import FINGERS, HandFrame, TrackedFinger, TrackedHand, Vector
from models.rotations import exp

BALL = 0.23
"""Share of the last bone by which the later software's `tipPosition` is before the bone's end: that
of every finger in the real recording pinch-57fps (4.2 mm on average). On real v3 hands the two are
6.5 mm apart, and not along the bone alone."""


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
    rng = np.random.default_rng([seed, 0x1EA9])
    if dialect == "v1":
        seen = _first(rng, take, drop_outs, configuration)
    else:
        seen = _later(rng, take, configuration)
    frames, fingers = zip(*seen, strict=True)
    return LeapTake(frames, fingers, take.angles, take.open, take.side, dialect)


_Seen = tuple[HandFrame, dict[int, int]]
"""A frame, and the finger of every id in it."""


def first_hand(
    rng: np.random.Generator, hand: int, seen: SeenHand
) -> tuple[TrackedHand, dict[int, int]]:
    """The hand in the first software's frame, and the finger of every id.

    Args:
        rng: Chance, for the order of the fingers.
        hand: Id of the hand.
        seen: What the device sees of it.
    """
    shown = [f for f in rng.permutation(len(FINGERS)).tolist() if seen.ids[f]]
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
        hand,
        vector_of(seen.origin),
        vector_of(-seen.axes[:, 2]),
        vector_of(seen.axes[:, 1]),
        fingers,
    )
    return found, {int(seen.ids[f]): f for f in shown}


def _first(
    rng: np.random.Generator, take: AirTake, drop_outs: bool, c: LeapConfiguration
) -> Iterator[_Seen]:
    device = FirstSoftware(rng, c, drop_outs)
    before = float(take.time[0])
    for t, time in enumerate(take.time.tolist()):
        seen = device.see(time - before, take.origin[t], take.rotation[t], take.joints[t])
        before = time
        hand, fingers = first_hand(rng, 1, seen)
        yield HandFrame(time, (hand,), "simulated v1", "v1"), fingers


def _later(rng: np.random.Generator, take: AirTake, c: LeapConfiguration) -> Iterator[_Seen]:
    count = len(take.time)
    origin = take.origin + c.palm_place * rng.standard_normal((count, 3))
    turn = np.deg2rad(c.palm_turn) * rng.standard_normal((count, 3))
    axes = exp(turn) @ take.rotation
    world = take.origin[:, None, None] + np.einsum("tij,tfkj->tfki", take.rotation, take.joints)
    world = world + c.joint * rng.standard_normal(world.shape)
    tip, along = balls(world), world[:, :, 2] - world[:, :, 1]
    # In the later software, the direction is exactly that of the middle bone.
    along = along / np.linalg.norm(along, axis=-1, keepdims=True)
    for t in range(count):
        shown = rng.permutation(len(FINGERS)).tolist()
        fingers = tuple(
            TrackedFinger(
                10 + f,
                vector_of(tip[t, f]),
                vector_of(along[t, f]),
                float(np.linalg.norm(np.diff(world[t, f], axis=0), axis=1).sum()),
                f,
                _joints(world[t, f]),
            )
            for f in shown
        )
        hand = TrackedHand(
            1,
            vector_of(origin[t]),
            vector_of(-axes[t, :, 2]),
            vector_of(axes[t, :, 1]),
            fingers,
            take.side,
        )
        frame = HandFrame(float(take.time[t]), (hand,), "simulated v3", "v3")
        yield frame, {10 + f: f for f in shown}


def balls(world: Array) -> Array:
    """The later software's fingertips (..., 5, 3) of joints (..., 5, 4, 3)."""
    end = world[..., 3, :]
    # A thumb of two bones has its last joint at its end.
    start = np.concatenate([world[..., :1, 1, :], world[..., 1:, 2, :]], axis=-2)
    return np.asarray(end + BALL * (start - end))


def _joints(rows: Array) -> tuple[Vector, Vector, Vector, Vector]:
    a, b, c, d = (vector_of(r) for r in rows)
    return a, b, c, d
