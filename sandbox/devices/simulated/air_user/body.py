"""The hand of a simulated person in the air: computes joint positions from a wanted pinch.

The palm faces down; thumb, index and middle finger reach down from it and meet, ring and little
finger stay stretched, out of the way. Every seed gives another person, with their own bone lengths
and coupling of the last joints, as in `encoders.paalm.simulated.air`.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin

import numpy as np

from encoders.paalm.angles import FRAMES, joints_of_angles
from encoders.paalm.chain import FINGER_LIMITS, THUMB_LIMITS, FingerChain
from encoders.paalm.coupling import Coupling
from encoders.paalm.simulated.air import FROZEN_AIR, body_of
from models.arithmetic.arrays import Array
from models.arithmetic.products import length, small_product

AXIS = float(np.deg2rad(52.0))
"""rad in the palm, from its x, direction from the thumb's tip to the fingers' that the resting
thumb of `models.skeleton` faces."""
CENTRE = (-0.038, 0.047, -0.055)
"""(3,) m in palm coordinates, point at which the tips of an average hand meet."""
PITCH = 0.019
"""m between the tips of index and middle finger."""
STRETCHED = {3: (8.0, -4.0, 12.0, 8.0), 4: (8.0, -12.0, 12.0, 8.0)}
"""Joint angles of ring and little finger, degrees."""
PINCHING = (0, 1, 2)
"""Labels of the fingers that pinch."""


@dataclass(frozen=True)
class Pinch:
    """The wanted pose of a pinching hand.

    Attributes:
        centre: (3,) m in the world, midpoint between thumb and fingers.
        yaw: rad, turn of the hand about the vertical.
        gap: m between the centres of the tips of thumb and fingers.
        bent: (3, 3) m in palm axes, extra shifts of the tips of thumb, index and middle.
    """

    centre: Array
    yaw: float
    gap: float
    bent: Array

    @property
    def vector(self) -> Array:
        """(14,) all values, for interpolation between two poses."""
        return np.concatenate([self.centre, [self.yaw, self.gap], self.bent.ravel()])

    @classmethod
    def of(cls, vector: Array) -> Pinch:
        """Inverse of `vector`."""
        return cls(vector[:3], float(vector[3]), float(vector[4]), vector[5:].reshape(3, 3))

    @property
    def rotation(self) -> Array:
        """(3, 3) rotation, world from palm."""
        c, s = cos(self.yaw), sin(self.yaw)
        return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])

    def tips(self) -> Array:
        """(3, 3) m in the world, wanted tips of thumb, index and middle, without `bent`."""
        return self.centre + small_product(pinching_tips(self.gap), self.rotation.T)


def pinching_tips(gap: float) -> Array:
    """(3, 3) m in palm axes, tips of thumb, index and middle from the pinch's centre."""
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
        """Palm centre (3,) and rotation (3, 3) in the world; joints (5, 4, 3) in the palm."""
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
