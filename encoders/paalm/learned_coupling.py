"""The coupling of one hand, learned while its device reports joints.

Persons differ in how far DIP follows PIP, and so do devices. A device that reports joints shows it
in every frame in which a finger is bent. The line DIP = slope * PIP + offset is fitted to all of
them by ridge regression towards the coupling that is assumed at first.
"""

from __future__ import annotations

from math import acos, degrees, sqrt

from encoders.paalm.coupling import LEAST_BENT, Coupling
from models.frames import TrackedHand, Vector

SLOPE_SPREAD, OFFSET_SPREAD = 0.15, 4.0
"""Standard deviations of slope and of offset, degrees, about the assumed coupling."""
STRAY = 8.0
"""Degrees, standard deviation of DIP about the line of its hand."""
ALIKE = 30
"""Number of bends in successive frames that say as much as one: a hand moves slowly."""
EVERY = 8
"""Frames after which the coupling in use moves."""
SLOPE_STEP, OFFSET_STEP = 0.02, 0.5
"""Largest move of slope and of offset, degrees, at a time: a fingertip does not jump."""
HARDLY_SLOPE, HARDLY_OFFSET = 0.005, 0.2
"""Differences of slope and of offset, degrees, for which the chains are not made anew."""


class LearnedCoupling:
    """Learns the coupling of one hand from the joints that its device reports.

    Args:
        assumed: The coupling at first.

    Attributes:
        used: The coupling in use, on its way to the learned one.
    """

    def __init__(self, assumed: Coupling) -> None:
        self.used = self._assumed = assumed
        # Sums of the regression of DIP - assumed DIP on PIP and 1.
        self._xx = (STRAY / SLOPE_SPREAD) ** 2
        self._11 = (STRAY / OFFSET_SPREAD) ** 2
        self._x1 = self._xy = self._1y = 0.0
        self._frames = 0

    def add(self, hand: TrackedHand) -> bool:
        """Learns from a frame.

        Returns:
            True if the coupling in use has changed.
        """
        for finger in hand.fingers:
            if finger.joints is None or not finger.finger:
                continue
            knuckle, pip_joint, dip_joint, end = finger.joints
            first, second = _minus(pip_joint, knuckle), _minus(dip_joint, pip_joint)
            pip, dip = _bend(first, second), _bend(second, _minus(end, dip_joint))
            if pip > LEAST_BENT:
                x = pip / ALIKE
                off = dip - self._assumed.slope * pip - self._assumed.offset
                self._xx += x * pip
                self._x1 += x
                self._11 += 1.0 / ALIKE
                self._xy += x * off
                self._1y += off / ALIKE
        self._frames += 1
        return self._frames % EVERY == 0 and self._move()

    def _move(self) -> bool:
        det = self._xx * self._11 - self._x1 * self._x1
        slope = self._assumed.slope + (self._11 * self._xy - self._x1 * self._1y) / det
        offset = self._assumed.offset + (self._xx * self._1y - self._x1 * self._xy) / det
        before = self.used
        if abs(slope - before.slope) < HARDLY_SLOPE and abs(offset - before.offset) < HARDLY_OFFSET:
            return False
        self.used = Coupling(
            before.slope + _limited(slope - before.slope, SLOPE_STEP),
            before.offset + _limited(offset - before.offset, OFFSET_STEP),
        )
        return True


def _minus(a: Vector, b: Vector) -> Vector:
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


def _bend(a: Vector, b: Vector) -> float:
    """Angle between two bones, degrees; 0 where one has no length."""
    far = sqrt(_dot(a, a) * _dot(b, b))
    return degrees(acos(min(max(_dot(a, b) / far, -1.0), 1.0))) if far > 1e-12 else 0.0


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _limited(way: float, most: float) -> float:
    return min(max(way, -most), most)
