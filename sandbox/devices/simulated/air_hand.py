"""The hand of a simulated person in the air: joint positions for a pinch, and movements.

The palm faces down. Thumb, index and middle finger reach down from it and meet; ring and little
finger stay stretched, out of the way. Every seed gives a different person, with other bone lengths
and another coupling of the last joints, as in `encoders.paalm.simulated.air`. Movements have
minimum jerk, end-point errors and tremor.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, exp, log2, sin

import numpy as np

from encoders.paalm.angles import FRAMES, joints_of_angles
from encoders.paalm.chain import FINGER_LIMITS, THUMB_LIMITS, FingerChain
from encoders.paalm.coupling import Coupling
from encoders.paalm.simulated.air import FROZEN_AIR, body_of
from models.arithmetic import Array, length, small_product
from tasks.user import UserConfiguration

AXIS = float(np.deg2rad(52.0))
"""Direction (rad from x, in the palm's plane) from the thumb's tip to the fingertips: that in which
the resting thumb of `models.skeleton` opposes the fingers."""
CENTRE = (-0.038, 0.047, -0.055)
"""Point (3,) at which the fingertips of an average hand meet, m in palm coordinates."""
PITCH = 0.019
"""Distance (m) between the tips of index and middle finger."""
STRETCHED = {3: (8.0, -4.0, 12.0, 8.0), 4: (8.0, -12.0, 12.0, 8.0)}
"""Joint angles of ring and little finger, degrees."""
PINCHING = (0, 1, 2)
"""Labels of the fingers that pinch."""


@dataclass(frozen=True)
class Pinch:
    """The target pose of a pinching hand.

    Attributes:
        centre: (3,) m in the world, midpoint between thumb and fingers.
        yaw: rad, rotation of the hand about the vertical.
        gap: m, distance between the tip of the thumb and the midpoint of the other two tips.
        bent: (3, 3) m in palm axes, extra shifts of the tips of thumb, index and middle.
    """

    centre: Array
    yaw: float
    gap: float
    bent: Array

    @property
    def vector(self) -> Array:
        """All values as a vector (14,), for interpolation between two poses."""
        return np.concatenate([self.centre, [self.yaw, self.gap], self.bent.ravel()])

    @classmethod
    def of(cls, vector: Array) -> Pinch:
        """Makes the pose from its `vector`."""
        return cls(vector[:3], float(vector[3]), float(vector[4]), vector[5:].reshape(3, 3))

    @property
    def rotation(self) -> Array:
        """Rotation (3, 3), world from palm."""
        c, s = cos(self.yaw), sin(self.yaw)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

    def tips(self) -> Array:
        """Returns the tips (3, 3) of thumb, index and middle without `bent`, m in the world."""
        return self.centre + small_product(pinching_tips(self.gap), self.rotation.T)


def pinching_tips(gap: float) -> Array:
    """Returns the tips (3, 3) of thumb, index and middle from the pinch's centre, m, palm axes."""
    axis = np.array([cos(AXIS), sin(AXIS), 0.0])
    beside = np.array([sin(AXIS), -cos(AXIS), 0.0])
    return np.array(
        [
            -gap / 2 * axis,
            gap / 2 * axis - PITCH / 2 * beside,
            gap / 2 * axis + PITCH / 2 * beside,
        ]
    )


class Body:
    """A person's right hand.

    Args:
        seed: Seed of the person.
    """

    def __init__(self, seed: int) -> None:
        rng = np.random.default_rng([seed, 0xB0D4])
        self.knuckles, self.lengths = body_of(rng, FROZEN_AIR)
        coupling = Coupling(rng.normal(*FROZEN_AIR.slope), rng.normal(*FROZEN_AIR.offset))
        self._chains = {
            f: FingerChain(
                tuple(self.lengths[f].tolist()), coupling, FINGER_LIMITS if f else THUMB_LIMITS
            )
            for f in PINCHING
        }
        size = float(length(self.knuckles[2]) / length(np.array([-0.004, 0.036, 0.007])))
        self.middle = np.multiply(CENTRE, np.clip(size, 0.8, 1.25))

    def joints(self, pinch: Pinch) -> tuple[Array, Array, Array]:
        """Returns palm centre (3,) m and rotation (3, 3) in the world, and joints (5, 4, 3) m in
        palm coordinates."""
        wanted = self.middle + pinching_tips(pinch.gap) + pinch.bent
        angles = np.zeros((5, 4))
        for f in PINCHING:
            x, y, z = small_product(wanted[f] - self.knuckles[f], FRAMES[f]).tolist()
            bend = self._chains[f].solve((x, y, z))
            angles[f] = bend.flexion, bend.spread, bend.pip, bend.dip
        angles[0, 3] = 0.0
        for f, row in STRETCHED.items():
            angles[f] = row
        rotation = pinch.rotation
        origin = pinch.centre - small_product(rotation, self.middle)
        return origin, rotation, joints_of_angles(angles, self.knuckles, self.lengths)


_ARM = 0.10
"""Radius (m) that converts a turn of the wrist to a length of movement."""
_PEAK = 1.875
"""Ratio of peak to mean speed in a minimum-jerk movement."""


class HandMovement:
    """Target and actual pose of a hand over time.

    Args:
        start: Initial pose.
        configuration: Speed and precision of the user.
        rng: Random numbers for end-point errors and tremor.
    """

    def __init__(
        self, start: Pinch, configuration: UserConfiguration, rng: np.random.Generator
    ) -> None:
        self._c, self._rng = configuration, rng
        self._from = self._to = start.vector
        self._begin = self._end = 0.0
        self._tremor = np.zeros(3)
        self._last: float | None = None

    @property
    def aim(self) -> Pinch:
        """Target pose of the current or last movement, with its end-point error."""
        return Pinch.of(self._to.copy())

    def go(self, aim: Pinch, now: float, slowness: float = 1.0) -> float:
        """Begins a movement; returns the time of its end, s."""
        self._from = self._at(now)
        to = aim.vector
        way = to - self._from
        far = float(length(way[:3]) + _ARM * abs(way[3]) + abs(way[4]) / 2 + np.abs(way[5:]).max())
        # The end-point error of a movement is proportional to its length.
        to[:3] += self._c.end_noise * length(way[:3]) * self._rng.standard_normal(3) / 1.7
        to[3] += self._c.end_noise * way[3] * self._rng.standard_normal()
        time = self._c.movement_base + self._c.movement_slope * log2(max(far / 0.002, 1.0))
        time = slowness * max(time, _PEAK * far / self._c.peak_speed)
        self._to, self._begin, self._end = to, now, now + time
        return self._end

    def at(self, now: float) -> Pinch:
        """Returns the actual pose with tremor; must be called in order of time."""
        c = self._c
        step = 0.0 if self._last is None else max(now - self._last, 0.0)
        self._last = now
        keep = exp(-step / c.tremor_time)
        self._tremor = keep * self._tremor + c.tremor * np.sqrt(
            1.0 - keep * keep
        ) * self._rng.standard_normal(3)
        vector = self._at(now)
        vector[:3] += self._tremor
        return Pinch.of(vector)

    def _at(self, now: float) -> Array:
        if now >= self._end:
            return self._to.copy()
        s = max((now - self._begin) / (self._end - self._begin), 0.0)
        return self._from + s * s * s * (10.0 - 15.0 * s + 6.0 * s * s) * (self._to - self._from)
