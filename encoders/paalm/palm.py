"""The palm's frame, in which directions and positions of fingers are compared and held."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import distance
from models.frames import TrackedHand, Vector

STACKED = 0.10
"""m, distance of two palms' centres, seen from above, below which they are on top of each other: a
palm is about 0.085 m wide, and the lower one hides the other from the device."""


@dataclass(frozen=True, slots=True)
class Palm:
    """Origin and axes of a palm, represented as a right hand.

    Attributes:
        origin: m, centre of the palm.
        across: Unit vector towards the little finger, for either hand. So the three axes of a left
            hand are left-handed: its coordinates are those of its mirror image.
        forward: Unit vector towards the fingers.
        dorsal: Unit vector out of the back of the hand.
    """

    origin: Vector
    across: Vector
    forward: Vector
    dorsal: Vector

    def place(self, point: Vector) -> Vector:
        """Palm coordinates (across, forward, dorsal), m, of a position."""
        o = self.origin
        return self.turn((point[0] - o[0], point[1] - o[1], point[2] - o[2]))

    def turn(self, v: Vector) -> Vector:
        """Palm coordinates of a direction."""
        a, f, d = self.across, self.forward, self.dorsal
        return (
            v[0] * a[0] + v[1] * a[1] + v[2] * a[2],
            v[0] * f[0] + v[1] * f[1] + v[2] * f[2],
            v[0] * d[0] + v[1] * d[1] + v[2] * d[2],
        )

    def back(self, v: Vector) -> Vector:
        """The direction with these palm coordinates."""
        a, f, d = self.across, self.forward, self.dorsal
        x, y, z = (v[0] * a[i] + v[1] * f[i] + v[2] * d[i] for i in range(3))
        return x, y, z

    @property
    def rotation(self) -> Array:
        """Matrix (3, 3) device from palm: a rotation for a right hand, a reflection for a left
        one."""
        return np.array([self.across, self.forward, self.dorsal]).T


def palm_of(hand: TrackedHand, side: str) -> Palm:
    """The frame of a seen hand; its direction is made exactly perpendicular to its normal."""
    nx, ny, nz = hand.normal
    dx, dy, dz = hand.direction
    along = nx * dx + ny * dy + nz * dz
    fx, fy, fz = dx - along * nx, dy - along * ny, dz - along * nz
    length = sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz = fx / length, fy / length, fz / length
    ux, uy, uz = -nx, -ny, -nz
    # Forward x dorsal points towards the little finger of a right hand whose palm faces down.
    ax, ay, az = fy * uz - fz * uy, fz * ux - fx * uz, fx * uy - fy * ux
    if side == "left":
        ax, ay, az = -ax, -ay, -az
    return Palm(hand.palm, (ax, ay, az), (fx, fy, fz), (ux, uy, uz))


def stacked(a: TrackedHand, b: TrackedHand) -> bool:
    """True if one hand is above the other, so that the device cannot tell their fingers apart."""
    return distance(a.palm[:2], b.palm[:2]) < STACKED


def vector_of(v: Array) -> Vector:
    """Converts an array (3,) to three plain floats."""
    x, y, z = v.tolist()
    return x, y, z
