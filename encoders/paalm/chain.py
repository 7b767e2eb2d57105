"""Inverse kinematics of one finger: a length and a direction give four angles.

DIP is coupled to PIP, so the distance from the base to the tip is a decreasing function of PIP
alone. This function is tabulated once and inverted. The tip's position in the finger's plane is
then known, and the direction gives the angles of the first joint. If the first joint is beyond its
limit, it is set to the limit, and PIP is recomputed for the least error of the tip.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, atan2, cos, pi, radians, sin, sqrt
from typing import NamedTuple

import numpy as np

from encoders.paalm.coupling import Coupling
from models import arithmetic
from models.errors import EncoderError
from models.frames import Vector

_ENTRIES = 512
_STEPS = 4
_NOTHING = 1e-12
_AT_KNUCKLE = 1e-9
"""Distance (m) from the knuckle below which a target has no direction."""
_DEGREES, _RADIANS = 180.0 / pi, pi / 180.0
"""The exact factors of `math.degrees` and `math.radians`; a product is quicker than a call."""


@dataclass(frozen=True)
class FingerLimits:
    """Ranges of the joints (degrees), from usual clinical ranges, as in `models.skeleton`."""

    flexion: tuple[float, float] = (-20.0, 90.0)
    spread: tuple[float, float] = (-25.0, 25.0)
    pip: tuple[float, float] = (0.0, 110.0)
    dip: tuple[float, float] = (-10.0, 80.0)


FINGER_LIMITS = FingerLimits()
THUMB_LIMITS = FingerLimits((-40.0, 40.0), (-40.0, 40.0), (0.0, 75.0), (-10.0, 80.0))


class Bend(NamedTuple):
    """Angles (degrees) of a finger, and the distance (m) of its tip from the target."""

    flexion: float
    spread: float
    pip: float
    dip: float
    miss: float


class FingerChain:
    """Three bones with coupled bending.

    Args:
        lengths: Lengths (m) of the bones, from the knuckle outwards; the last may be 0.
        coupling: Relation of DIP to PIP.
        limits: Ranges of the joints.
        hidden: Share of the first bone, next to the knuckle, that a device does not show. Distances
            and directions of the tip are measured from the end of this part.
    """

    def __init__(
        self,
        lengths: tuple[float, float, float],
        coupling: Coupling,
        limits: FingerLimits = FINGER_LIMITS,
        hidden: float = 0.0,
    ) -> None:
        first, second, third = lengths
        if min(first, second) <= 0.0 or third < 0.0 or not 0.0 <= hidden < 1.0:
            raise EncoderError(
                "the bone lengths are out of range",
                got=(lengths, hidden),
                expected="lengths above 0 (the third may be 0), and a hidden share of 0 to 1",
            )
        self.lengths, self.coupling, self.limits, self.hidden = lengths, coupling, limits, hidden
        # Copies of the coupling and limits as plain numbers, which are read in every frame.
        self._bending = (coupling.slope, coupling.offset, *limits.dip)
        self._first_limits = (*limits.flexion, *limits.spread)
        self._seen = first * (1.0 - hidden)
        self.reach = self._seen + second + third
        pip = np.linspace(radians(limits.pip[0]), radians(limits.pip[1]), _ENTRIES)
        dip = np.clip(coupling.slope * pip + np.deg2rad(coupling.offset), *np.deg2rad(limits.dip))
        along = (
            first * (1.0 - hidden)
            + second * arithmetic.cos(pip)
            + third * arithmetic.cos(pip + dip)
        )
        below = second * arithmetic.sin(pip) + third * arithmetic.sin(pip + dip)
        chord = np.sqrt(along * along + below * below)
        # As PIP grows over its range, the length may first grow, then shrink, then grow again. Only
        # the piece in which it shrinks is used, so that each length has one PIP angle.
        start = int(np.argmax(chord))
        rising = np.nonzero(np.diff(chord[start:]) >= 0.0)[0]
        piece = slice(start, start + int(rising[0]) + 1 if len(rising) else len(chord))
        self._pip = pip[piece]
        self._least, self._most = float(self._pip[0]), float(self._pip[-1])
        self._along, self._below = along[piece], below[piece]
        self.longest, self.shortest = float(chord[piece][0]), float(chord[piece][-1])
        # While the finger is nearly straight, PIP is proportional to the square root of the missing
        # length. A table in equal steps of this root is therefore accurate everywhere.
        root = np.sqrt(self.longest - chord[piece])
        self._per_root = (_ENTRIES - 1) / float(root[-1])
        even = np.linspace(0.0, root[-1], _ENTRIES)
        self._inverse: list[float] = np.interp(even, root, self._pip).tolist()

    def chord(self, pip: float) -> float:
        """Distance (m) from the visible base to the tip of a finger, for a PIP angle in degrees."""
        along, below = self._plane(radians(pip))
        return sqrt(along * along + below * below)

    def dip(self, pip: float) -> float:
        """Angle (degrees) of the last joint for a PIP angle in degrees."""
        slope, offset, low, high = self._bending
        dip = slope * pip + offset
        return low if dip < low else high if dip > high else dip

    def solve(self, target: Vector) -> Bend:
        """Computes angles that bring the tip to a target (m).

        The target is relative to the base, in the finger's frame (`encoders.paalm.angles.FRAMES`).
        """
        x, y, z = target
        chord = sqrt(x * x + y * y + z * z)
        if chord < _AT_KNUCKLE:
            raise EncoderError("a target at the knuckle has no direction", got=target)
        # The direction of a target out of reach is kept; only its distance is limited.
        reached = min(max(chord, self.shortest), self.longest)
        scale = reached / chord
        x, y, z = x * scale, y * scale, z * scale
        pip = self._bend(reached)
        along, below = self._plane(pip)
        # For a tip straight below the knuckle, spread has no effect and is 0.
        spread = asin(min(max(-x / along, -1.0), 1.0)) if abs(along) > _NOTHING else 0.0
        flexion = (atan2(-z, y) - atan2(below, along * cos(spread))) * _DEGREES
        spread *= _DEGREES
        low, high, left, right = self._first_limits
        held_flexion, held_spread = flexion, spread
        if not (low <= flexion <= high and left <= spread <= right):
            held_flexion = min(max(flexion, low), high)
            held_spread = min(max(spread, left), right)
            pip = self._closest(held_flexion * _RADIANS, held_spread * _RADIANS, (x, y, z))
            along, below = self._plane(pip)
        flexion, spread = held_flexion * _RADIANS, held_spread * _RADIANS
        forward, down, sideways = cos(flexion), sin(flexion), along * cos(spread)
        dx = -along * sin(spread) - target[0]
        dy = sideways * forward - below * down - target[1]
        dz = -sideways * down - below * forward - target[2]
        pip *= _DEGREES
        miss = sqrt(dx**2 + dy**2 + dz**2)
        return Bend(held_flexion, held_spread, pip, self.dip(pip), miss)

    def _bend(self, chord: float) -> float:
        """PIP (rad) for a reachable length.

        Where DIP reaches its limit, the length as a function of PIP has a kink, and the table is
        off by up to half an entry. Newton's steps make every length exact.
        """
        at = sqrt(max(self.longest - chord, 0.0)) * self._per_root
        index = min(int(at), _ENTRIES - 2)
        low, high = self._inverse[index], self._inverse[index + 1]
        pip = low + (high - low) * min(at - index, 1.0)
        _, second, third = self.lengths
        seen, least, most = self._seen, self._least, self._most
        slope, offset, low, high = self._bending
        # Values as in `_plane` and `dip`, and the derivative of DIP with respect to PIP.
        for _ in range(_STEPS):
            free = slope * (pip * _DEGREES) + offset
            dip = low if free < low else high if free > high else free
            bend = pip + dip * _RADIANS
            cos_pip, sin_pip, cos_bend, sin_bend = cos(pip), sin(pip), cos(bend), sin(bend)
            along = seen + second * cos_pip + third * cos_bend
            below = second * sin_pip + third * sin_bend
            turning = third * (1.0 + slope if low < free < high else 1.0)
            falls = below * (second * cos_pip + turning * cos_bend)
            falls -= along * (second * sin_pip + turning * sin_bend)
            if falls > -_NOTHING:  # At the longest or shortest length, where the table is exact.
                break
            step = 0.5 * (chord * chord - along * along - below * below) / falls
            pip += step
            pip = least if pip < least else most if pip > most else pip
            if -_NOTHING < step < _NOTHING:
                break
        return pip

    def _plane(self, pip: float) -> tuple[float, float]:
        _, second, third = self.lengths
        bend = pip + self.dip(pip * _DEGREES) * _RADIANS
        return (
            self._seen + second * cos(pip) + third * cos(bend),
            second * sin(pip) + third * sin(bend),
        )

    def _closest(self, flexion: float, spread: float, target: Vector) -> float:
        """PIP (rad) that brings the tip nearest to a target while the first joint is fixed."""
        y = self._along * cos(spread)
        dx = -self._along * sin(spread) - target[0]
        dy = y * cos(flexion) - self._below * sin(flexion) - target[1]
        dz = -y * sin(flexion) - self._below * cos(flexion) - target[2]
        return float(self._pip[np.argmin(dx * dx + dy * dy + dz * dz)])
