"""The palm's frame. Directions and positions of fingers are compared in this frame. An unseen
finger keeps its place in it."""

from __future__ import annotations

from dataclasses import dataclass
from math import sqrt

import numpy as np

from models.arithmetic import Array, distance
from models.frames import TrackedHand, Vector

STACKED = 0.10
"""Horizontal distance (m) of two palms' centres below which one hand counts as above the other. A
palm is about 0.085 m wide, and the lower palm hides the upper palm from the device."""
BEHIND = 0.020
"""Distance (m) behind the palm's centre. A fingertip farther back shows that the palm is reported
the wrong way round."""


@dataclass(frozen=True, slots=True)
class Palm:
    """Origin and axes of a palm, represented as a right hand.

    Attributes:
        origin: Centre (m) of the palm.
        across: Unit vector towards the little finger, for either hand. The axes of a left hand are
            therefore left-handed, and its coordinates are those of its mirror image.
        forward: Unit vector towards the fingers.
        dorsal: Unit vector out of the back of the hand.
    """

    origin: Vector
    across: Vector
    forward: Vector
    dorsal: Vector

    def place(self, point: Vector) -> Vector:
        """Palm coordinates (across, forward, dorsal), m, of a position in the device's frame."""
        u, v, w = self.origin
        x, y, z = point[0] - u, point[1] - v, point[2] - w
        a, f, d = self.across, self.forward, self.dorsal
        return (
            x * a[0] + y * a[1] + z * a[2],
            x * f[0] + y * f[1] + z * f[2],
            x * d[0] + y * d[1] + z * d[2],
        )

    def turn(self, v: Vector) -> Vector:
        """Palm coordinates of a direction in the device's frame."""
        a, f, d = self.across, self.forward, self.dorsal
        return (
            v[0] * a[0] + v[1] * a[1] + v[2] * a[2],
            v[0] * f[0] + v[1] * f[1] + v[2] * f[2],
            v[0] * d[0] + v[1] * d[1] + v[2] * d[2],
        )

    def back(self, v: Vector) -> Vector:
        """Direction in the device's frame, from its palm coordinates."""
        a, f, d = self.across, self.forward, self.dorsal
        x, y, z = v
        return (
            x * a[0] + y * f[0] + z * d[0],
            x * a[1] + y * f[1] + z * d[1],
            x * a[2] + y * f[2] + z * d[2],
        )

    def shifted(self, shift: Vector) -> Palm:
        """The palm with its centre moved to a position (m) given in palm coordinates."""
        x, y, z = self.back(shift)
        a, b, c = self.origin
        return Palm((a + x, b + y, c + z), self.across, self.forward, self.dorsal)

    @property
    def rotation(self) -> Array:
        """Matrix (3, 3) device from palm: a rotation for a right hand, a reflection for a left
        hand.
        """
        return np.array([self.across, self.forward, self.dorsal]).T


def palm_of(hand: TrackedHand, side: str) -> Palm:
    """Palm of a hand, with its direction made exactly perpendicular to its normal."""
    nx, ny, nz = hand.normal
    dx, dy, dz = hand.direction
    along = nx * dx + ny * dy + nz * dz
    fx, fy, fz = dx - along * nx, dy - along * ny, dz - along * nz
    length = sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz = fx / length, fy / length, fz / length
    ux, uy, uz = -nx, -ny, -nz
    if _reversed(hand, (fx, fy, fz)):
        # The palm is reported with a half turn about the line across it, which is undone here.
        fx, fy, fz, ux, uy, uz = -fx, -fy, -fz, -ux, -uy, -uz
    # Forward x dorsal points towards the little finger of a right hand whose palm faces down.
    ax, ay, az = fy * uz - fz * uy, fz * ux - fx * uz, fx * uy - fy * ux
    if side == "left":
        ax, ay, az = -ax, -ay, -az
    return Palm(hand.palm, (ax, ay, az), (fx, fy, fz), (ux, uy, uz))


def _reversed(hand: TrackedHand, forward: Vector) -> bool:
    """True if most fingertips are well behind the palm and point backwards.

    The first software does not detect the arm. In a hand that has just come into view, it sometimes
    takes the side of the wrist for the side of the fingers. Hands with joints are never reported
    like this.
    """
    x, y, z = hand.palm
    behind = 0
    for finger in hand.fingers:
        if finger.joints is not None:
            return False
        a, b, c = finger.tip
        d = finger.direction
        way = (a - x) * forward[0] + (b - y) * forward[1] + (c - z) * forward[2]
        along = d[0] * forward[0] + d[1] * forward[1] + d[2] * forward[2]
        behind += way < -BEHIND and along < 0.0
    return 2 * behind > len(hand.fingers)


def stacked(a: TrackedHand, b: TrackedHand) -> bool:
    """True if one hand is above the other, so that the device cannot separate their fingers."""
    return distance(a.palm[:2], b.palm[:2]) < STACKED


def vector_of(v: Array) -> Vector:
    """Converts an array (3,) to three plain floats."""
    x, y, z = v.tolist()
    return x, y, z
