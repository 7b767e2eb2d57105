"""A forward model of the Leap: it computes the device's frames for a hand with known poses.

`v1` is the first software: fingers in no order, with direction and length of their visible part,
and without folded, crossed or briefly lost fingers. `v3` is the later software with labelled
joints. The configuration is frozen; numbers taken from the only v1 recording (`leapmotion/leapjs`,
test/hands.json) are marked.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from encoders.paalm.palm import vector_of
from encoders.paalm.simulated.air import AirTake
from models.arithmetic.arrays import Array
from models.frames import HandFrame, TrackedFinger, TrackedHand, Vector
from models.rotations import exp


@dataclass(frozen=True)
class LeapConfiguration:
    """Settings of the device. Lengths in m, angles in degrees, times in s.

    Attributes:
        hidden: Share of the first bone that the device counts as palm, for fingers and for the
            thumb. In the recording, greatest lengths are 71 to 82 mm of index, middle and ring
            finger and 52 to 55 of the thumb, which of an average hand leave out about these shares.
        tip, joint: Spread of positions.
        length_white, length_slow: Spread of the length from frame to frame (the recording's
            changes by 0.2 to 1 mm a frame), and slowly, as a share of it.
        direction: Spread of directions.
        palm_place, palm_turn: Spread of the palm's frame.
        folded: A finger whose seen length is less than this share of itself is not seen.
        turned_in: Nor is one that points more than this away from the palm's direction.
        merged: Two tips closer than this are seen as one.
        lost_rate, lost: Hz at which a visible finger is lost without a reason, and the duration in
        s. back: s that a finger must be visible before the device reports it again.
    """

    hidden: float = 0.45
    thumb_hidden: float = 0.9
    tip: float = 0.0005
    joint: float = 0.0005
    length_white: float = 0.0004
    length_slow: float = 0.02
    direction: float = 1.5
    palm_place: float = 0.0005
    palm_turn: float = 0.4
    folded: float = 0.5
    turned_in: float = 80.0
    merged: float = 0.012
    lost_rate: float = 0.15
    lost: tuple[float, float] = (0.05, 0.4)
    back: float = 0.03


FROZEN_LEAP = LeapConfiguration()

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
    c = configuration
    count = len(take.time)
    origin = take.origin + c.palm_place * rng.standard_normal((count, 3))
    turn = np.deg2rad(c.palm_turn) * rng.standard_normal((count, 3))
    axes = exp(turn) @ take.rotation
    world = take.origin[:, None, None] + np.einsum("tij,tfkj->tfki", take.rotation, take.joints)
    world = world + c.joint * rng.standard_normal(world.shape) if dialect == "v3" else world
    if dialect == "v3":
        ids = np.tile(10 + np.arange(5), (count, 1))
        tip, along, length = balls(world), world[:, :, 2] - world[:, :, 1], None
        # In the later software, the direction is exactly that of the middle bone.
        along = along / np.linalg.norm(along, axis=-1, keepdims=True)
    else:
        tip, along, length, ids = _v1(rng, take, world, axes, drop_outs, c)
    frames, fingers = [], []
    for t in range(count):
        shown = [f for f in rng.permutation(5).tolist() if ids[t, f] >= 0]
        visible = tuple(
            TrackedFinger(
                int(ids[t, f]),
                vector_of(tip[t, f]),
                vector_of(along[t, f]),
                float(
                    length[t, f]
                    if length is not None
                    else np.linalg.norm(np.diff(world[t, f], axis=0), axis=1).sum()
                ),
                f if length is None else None,
                _joints(world[t, f]) if length is None else None,
            )
            for f in shown
        )
        hand = TrackedHand(
            1,
            vector_of(origin[t]),
            vector_of(-axes[t, :, 2]),
            vector_of(axes[t, :, 1]),
            visible,
            take.side if dialect == "v3" else None,
        )
        frames.append(HandFrame(float(take.time[t]), (hand,), f"simulated {dialect}", dialect))
        fingers.append({int(ids[t, f]): f for f in shown})
    return LeapTake(tuple(frames), tuple(fingers), take.angles, take.open, take.side, dialect)


def balls(world: Array) -> Array:
    """The later software's fingertips (..., 5, 3) of joints (..., 5, 4, 3)."""
    end = world[..., 3, :]
    # A thumb of two bones has its last joint at its end.
    start = np.concatenate([world[..., :1, 1, :], world[..., 1:, 2, :]], axis=-2)
    return np.asarray(end + BALL * (start - end))


def _v1(
    rng: np.random.Generator,
    take: AirTake,
    world: Array,
    axes: Array,
    drop_outs: bool,
    c: LeapConfiguration,
) -> tuple[Array, Array, Array, NDArray[np.int64]]:
    """Tips, directions, lengths and ids (-1: not seen) as the first software reports them."""
    count = len(world)
    hidden = np.array([c.thumb_hidden, *[c.hidden] * 4])[:, None]
    base = world[:, :, 0] + hidden * (world[:, :, 1] - world[:, :, 0])
    tip = world[:, :, 3] + c.tip * rng.standard_normal((count, 5, 3))
    line = tip - base
    clean = np.linalg.norm(line, axis=-1)
    along = line / clean[..., None]
    along = (exp(np.deg2rad(c.direction) * rng.standard_normal((count, 5, 3))) @ along[..., None])[
        ..., 0
    ]
    step = float(np.median(np.diff(take.time))) if count > 1 else 0.01
    keep = np.exp(-step / 0.5)
    slow = np.empty((count, 5))
    state = rng.standard_normal(5)
    for t in range(count):
        state = keep * state + np.sqrt(1.0 - keep**2) * rng.standard_normal(5)
        slow[t] = state
    length = clean * (1.0 + c.length_slow * slow) + c.length_white * rng.standard_normal(slow.shape)
    length = np.maximum(length, 0.002)
    ids = np.tile(np.arange(1, 6), (count, 1))
    if drop_outs:
        bones = np.linalg.norm(np.diff(world, axis=2), axis=-1)
        whole = bones.sum(axis=2) - hidden[:, 0] * bones[:, :, 0]
        forward = np.einsum("tfi,ti->tf", along, axes[:, :, 1])
        visible = (clean > c.folded * whole) & (forward > np.cos(np.deg2rad(c.turned_in)))
        ids = _ids(rng, visible, tip, clean, step, take.open, c)
    return tip, along, length, ids


def _ids(
    rng: np.random.Generator,
    visible: NDArray[np.bool_],
    tip: Array,
    clean: Array,
    step: float,
    is_open: NDArray[np.bool_],
    c: LeapConfiguration,
) -> NDArray[np.int64]:
    """Ids (T, 5); as with the device, a returning finger gets a new one."""
    count = len(visible)
    apart = np.linalg.norm(tip[:, :, None] - tip[:, None, :], axis=-1)
    shorter = clean[:, :, None] < clean[:, None, :]
    visible = visible & ~((apart < c.merged) & shorter).any(axis=2)
    ids = np.full((count, 5), -1)
    current, fresh = np.zeros(5, int), 1
    since, lost_until = np.full(5, c.back), np.full(5, -1.0)
    for t in range(count):
        hazard = rng.random(5) < c.lost_rate * step * (0.2 if is_open[t] else 1.0)
        span = rng.uniform(*c.lost, 5)
        now = t * step
        lost_until = np.where(hazard & (now >= lost_until), now + span, lost_until)
        up = visible[t] & (now >= lost_until)
        since = np.where(up, since + step, 0.0)
        for f in range(5):
            if since[f] < c.back:
                current[f] = 0
                continue
            if not current[f]:
                current[f], fresh = fresh, fresh + 1
            ids[t, f] = current[f]
    return ids


def _joints(rows: Array) -> tuple[Vector, Vector, Vector, Vector]:
    a, b, c, d = (vector_of(r) for r in rows)
    return a, b, c, d
