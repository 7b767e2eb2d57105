"""The forward Leap model frame by frame, for a hand that moves live.

`encoders.paalm.simulated.forward` makes whole takes. This is the same device, with the same
configuration, for a hand whose next movement depends on what it sees of the last one.
"""

from __future__ import annotations

import numpy as np

from encoders.paalm.palm import vector_of
from encoders.paalm.simulated.first_software import FirstSoftware
from encoders.paalm.simulated.forward import balls, first_hand
from encoders.paalm.simulated.leap_configuration import FROZEN_LEAP, LeapConfiguration
from models.arithmetic.arrays import Array
from models.errors import EncoderError
from models.frames import FINGERS, HandFrame, TrackedFinger, TrackedHand
from models.rotations import exp

DIALECTS = ("v3", "v1")


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
        # Numbers that nothing uses: the noise of joints after them is what it always was.
        self._rng.standard_normal(len(FINGERS))
        self._c, self._side, self._dialect = configuration, side, dialect
        self._time: float | None = None
        self._hand = 1
        self._first = FirstSoftware(np.random.default_rng([seed, 0x1EA9, 1]), configuration)

    def see(self, time: float, origin: Array, rotation: Array, joints: Array) -> HandFrame:
        """The device's frame for a hand.

        Args:
            time: s, time of the frame.
            origin: (3,) m, palm centre in the device's frame.
            rotation: (3, 3) device from palm; a reflection for a left hand.
            joints: (5, 4, 3) m, knuckle, PIP, DIP, tip in palm coordinates.
        """
        step = 0.0 if self._time is None else max(time - self._time, 0.0)
        self._time = time
        if self._dialect == "v1":
            seen = self._first.see(step, origin, rotation, joints)
            hand, _ = first_hand(self._rng, self._hand, seen)
        else:
            hand = self._with_joints(origin, rotation, joints)
        return HandFrame(time, (hand,), f"simulated {self._dialect}", self._dialect)

    def lose(self) -> None:
        """Records that the hand has left the view: a returning hand is new to the device."""
        self._hand += 1
        self._first.lose()

    def _with_joints(self, origin: Array, rotation: Array, joints: Array) -> TrackedHand:
        rng, c = self._rng, self._c
        axes = exp(np.deg2rad(c.palm_turn) * rng.standard_normal(3)) @ rotation
        palm = origin + c.palm_place * rng.standard_normal(3)
        world = origin + joints @ rotation.T
        world = world + c.joint * rng.standard_normal(world.shape)
        return TrackedHand(
            self._hand,
            vector_of(palm),
            vector_of(-axes[:, 2]),
            vector_of(axes[:, 1]),
            self._fingers(world),
            self._side,
        )

    def _fingers(self, world: Array) -> tuple[TrackedFinger, ...]:
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
