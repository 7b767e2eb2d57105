"""Coupling of the last joint to the middle one, which makes a chain of three bones solvable.

A fingertip's position does not determine how a bend is shared between PIP and DIP. The paper leaves
this to an animation program's inverse kinematics; here DIP = slope * PIP + offset. Devices
that model bones have a coupling of their own, which shows in what they report.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from models.errors import EncoderError

LEAST_BENT = 15.0
"""Degrees of PIP above which a finger counts: an angle without sign says little about a straight
one."""


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
            raise EncoderError("DIP does not follow PIP", got=f"slope {slope:.2f}", expected="0..3")
        return cls(float(slope), float(offset))


TWO_THIRDS = Coupling(2.0 / 3.0)
"""The textbook's tendon coupling."""
EQUAL = Coupling(1.0)
"""Both joints bend equally, as Leap v2 assumes."""
ORION = Coupling(0.52)
"""About the middle of the slopes of four people in 32 real Leap v3 recordings, 0.50 to 0.54."""

BY_DIALECT = {"v1": TWO_THIRDS, "v2": EQUAL, "v3": ORION, "bridge": ORION}
"""Coupling of every dialect. v1 reports no joints. v2's PIP and DIP differ by 0.002 degrees in four
real recordings. The bridge speaks for the hand model of v3 and its successors."""


def coupling_of(dialect: str | None) -> Coupling:
    """The coupling of a device's hands; 2/3 where the dialect is unknown."""
    return TWO_THIRDS if dialect is None else BY_DIALECT.get(dialect, TWO_THIRDS)
