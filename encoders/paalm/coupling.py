"""Coupling of the last joint to the middle joint, which makes a chain of three bones solvable.

A fingertip's position does not determine how a bend is shared between PIP and DIP. The paper leaves
this to an animation program's inverse kinematics. Here DIP = slope * PIP + offset. If a device
reports joints, the coupling of these joints can be used.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import acos, degrees, sqrt

import numpy as np
from numpy.typing import ArrayLike

from models.errors import EncoderError
from models.frames import TrackedHand, Vector

LEAST_BENT = 15.0
"""Least PIP (degrees) of a finger that is used to fit the coupling. Unsigned angles of a straighter
finger are mostly noise."""


@dataclass(frozen=True)
class Coupling:
    """Linear coupling, DIP = slope * PIP + offset.

    Attributes:
        slope: Slope, without unit.
        offset: Offset in degrees.
    """

    slope: float
    offset: float = 0.0

    @classmethod
    def fitted(cls, pip: ArrayLike, dip: ArrayLike) -> Coupling:
        """Fits the line by least squares to angles in degrees, of any shape.

        Raises:
            EncoderError: PIP hardly moves, or the line would straighten the tip as the finger
                closes.
        """
        x, y = np.asarray(pip, float).ravel(), np.asarray(dip, float).ravel()
        if x.size < 10 or np.ptp(np.percentile(x, [5, 95])) < 15.0:
            raise EncoderError(
                "the fingers bend too little to fit DIP to PIP",
                got=f"{x.size} angles",
                expected="PIP angles over at least 15 degrees",
            )
        slope, offset = np.polyfit(x, y, 1)
        if not 0.0 <= slope <= 3.0:
            raise EncoderError(
                "DIP does not follow PIP", got=f"slope {slope:.2f}", expected="0 to 3"
            )
        return cls(float(slope), float(offset))


TWO_THIRDS = Coupling(2.0 / 3.0)
"""Coupling by the tendons, from textbooks."""
EQUAL = Coupling(1.0)
"""Both joints bend equally, as Leap v2 assumes."""
ORION = Coupling(0.52)
"""About the middle of the slopes of four people in 32 real Leap v3 recordings, 0.50 to 0.54."""

BY_DIALECT = {"v1": TWO_THIRDS, "v2": EQUAL, "v3": ORION, "bridge": ORION}
"""Coupling of every dialect. v1 reports no joints. v2's PIP and DIP differ by 0.002 degrees in four
real recordings. The bridge reports the hand model of v3 and its successors."""


def coupling_of(dialect: str | None) -> Coupling:
    """The coupling of a device's hands; 2/3 where the dialect is unknown."""
    return TWO_THIRDS if dialect is None else BY_DIALECT.get(dialect, TWO_THIRDS)


SLOPE_SPREAD, OFFSET_SPREAD = 0.15, 4.0
"""Standard deviations of the slope and of the offset (degrees) about the assumed coupling."""
STRAY = 8.0
"""Standard deviation (degrees) of DIP about the line DIP = slope * PIP + offset of a hand."""
ALIKE = 30
"""Number of successive frames that count as one independent observation, since hands move
slowly."""
EVERY = 8
"""Number of frames between two updates of the coupling in use."""
SLOPE_STEP, OFFSET_STEP = 0.02, 0.5
"""Largest change of the slope and of the offset (degrees) in one update, so that fingertips do not
jump."""
HARDLY_SLOPE, HARDLY_OFFSET = 0.005, 0.2
"""Differences of slope and offset (degrees) below which the coupling in use is not updated."""


class LearnedCoupling:
    """Learns the coupling of one hand from the joints that its device reports.

    People and devices differ in how far DIP follows PIP. A device that reports joints shows this in
    every frame with a bent finger. The line DIP = slope * PIP + offset is fitted to all these
    frames by ridge regression towards the assumed coupling.

    Args:
        assumed: The initial coupling.

    Attributes:
        used: The coupling in use, which approaches the learned coupling in small steps.
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
    """Angle (degrees) between two bones; 0 if a bone has no length."""
    far = sqrt(_dot(a, a) * _dot(b, b))
    return degrees(acos(min(max(_dot(a, b) / far, -1.0), 1.0))) if far > 1e-12 else 0.0


def _dot(a: Vector, b: Vector) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _limited(way: float, most: float) -> float:
    return min(max(way, -most), most)
