"""The forward Leap model frame by frame, for a hand that moves live.

`encoders.paalm.simulated.forward` makes whole takes. This is the same device, with the same
configuration, for a hand whose next movement depends on what it sees of the last one.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.paalm.palm import vector_of
from encoders.paalm.simulated.forward import FROZEN_LEAP, LeapConfiguration, balls
from models.arithmetic.arrays import Array
from models.errors import EncoderError
from models.frames import FINGERS, HandFrame, TrackedFinger, TrackedHand
from models.rotations import exp

DIALECTS = ("v3", "v1")
_SLOW = 0.5
"""s, correlation time of a length's slow error."""


class LeapEye:
    """A simulated device over which one hand moves.

    Args:
        seed: Seed of noise, order and drop-outs.
        side: `right` or `left`.
        dialect: `v1` or `v3`.
        configuration: Settings of the device.

    Raises:
        EncoderError: The dialect is unknown.
    """

    def __init__(
        self,
        seed: int,
        side: str = "right",
        dialect: str = "v3",
        configuration: LeapConfiguration = FROZEN_LEAP,
    ) -> None:
        if dialect not in DIALECTS:
            raise EncoderError("no such dialect", got=dialect, expected=" or ".join(DIALECTS))
        self._rng = np.random.default_rng([seed, 0x1EA9, 2])
        self._c, self._side, self._dialect = configuration, side, dialect
        self._time: float | None = None
        self._hand = 1
        self._slow = self._rng.standard_normal(len(FINGERS))
        self._ids, self._fresh = np.zeros(len(FINGERS), int), 1
        self._since = np.full(len(FINGERS), configuration.back)
        self._lost_until = np.full(len(FINGERS), -1.0)

    def see(self, time: float, origin: Array, rotation: Array, joints: Array) -> HandFrame:
        """The device's frame for a hand.

        Args:
            time: s, time of the frame.
            origin: (3,) m, palm centre in the device's frame.
            rotation: (3, 3) device from palm; a reflection for a left hand.
            joints: (5, 4, 3) m, knuckle, PIP, DIP, tip in palm coordinates.
        """
        rng, c = self._rng, self._c
        step = 0.0 if self._time is None else max(time - self._time, 0.0)
        self._time = time
        axes = exp(np.deg2rad(c.palm_turn) * rng.standard_normal(3)) @ rotation
        palm = origin + c.palm_place * rng.standard_normal(3)
        world = origin + joints @ rotation.T
        if self._dialect == "v3":
            fingers = self._with_joints(world + c.joint * rng.standard_normal(world.shape))
        else:
            fingers = self._without(world, axes, step)
        hand = TrackedHand(
            self._hand,
            vector_of(palm),
            vector_of(-axes[:, 2]),
            vector_of(axes[:, 1]),
            fingers,
            self._side if self._dialect == "v3" else None,
        )
        return HandFrame(time, (hand,), f"simulated {self._dialect}", self._dialect)

    def lose(self) -> None:
        """Records that the hand has left the view: a returning hand is new to the device."""
        self._hand += 1
        self._ids[:] = 0

    def _with_joints(self, world: Array) -> tuple[TrackedFinger, ...]:
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

    def _without(self, world: Array, axes: Array, step: float) -> tuple[TrackedFinger, ...]:
        """Fingers as the first software reported them: unlabelled, and only the visible ones."""
        rng, c, five = self._rng, self._c, len(FINGERS)
        hidden = np.array([c.thumb_hidden, *[c.hidden] * (five - 1)])
        base = world[:, 0] + hidden[:, None] * (world[:, 1] - world[:, 0])
        tip = world[:, 3] + c.tip * rng.standard_normal((five, 3))
        clean = np.linalg.norm(tip - base, axis=1)
        along = (tip - base) / clean[:, None]
        turn = exp(np.deg2rad(c.direction) * rng.standard_normal((five, 3)))
        along = (turn @ along[..., None])[..., 0]
        keep = np.exp(-step / _SLOW)
        self._slow = keep * self._slow + np.sqrt(1.0 - keep**2) * rng.standard_normal(five)
        length = clean * (1.0 + c.length_slow * self._slow) + c.length_white * rng.standard_normal(
            five
        )
        length = np.maximum(length, 0.002)
        bones = np.linalg.norm(np.diff(world, axis=1), axis=2)
        whole = bones.sum(axis=1) - hidden * bones[:, 0]
        visible = (clean > c.folded * whole) & (
            along @ axes[:, 1] > np.cos(np.deg2rad(c.turned_in))
        )
        apart = np.linalg.norm(tip[:, None] - tip[None], axis=2)
        visible &= ~((apart < c.merged) & (clean[:, None] < clean[None])).any(axis=1)
        self._look(visible, step)
        return tuple(
            TrackedFinger(
                int(self._ids[f]), vector_of(tip[f]), vector_of(along[f]), float(length[f])
            )
            for f in rng.permutation(five).tolist()
            if self._ids[f]
        )

    def _look(self, visible: NDArray[np.bool_], step: float) -> None:
        """Loses fingers and finds them again, with new ids."""
        rng, c, five = self._rng, self._c, len(FINGERS)
        now = self._time or 0.0
        hazard, span = rng.random(five) < c.lost_rate * step, rng.uniform(*c.lost, five)
        self._lost_until = np.where(
            hazard & (now >= self._lost_until), now + span, self._lost_until
        )
        up = visible & (now >= self._lost_until)
        self._since = np.where(up, self._since + step, 0.0)
        for f in range(five):
            if self._since[f] < c.back:
                self._ids[f] = 0
            elif not self._ids[f]:
                self._ids[f], self._fresh = self._fresh, self._fresh + 1
