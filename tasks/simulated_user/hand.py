"""The simulated user's hand: how far apart its fingers are, and how many of them have room.

Distances of neighbouring fingertips are those of 147 layouts of five fingers that people put on a
screen: their medians, and the values that one in ten is below and above. The bends of the row are
estimated: the middle fingertip is then 17 mm above the line from index to little finger, and was 19
mm above it in 180 frames of simulated people.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, sin, sqrt

import numpy as np

from models.arithmetic.arrays import Array
from tasks.user import UserConfiguration

NARROWEST = 0.012
"""m, least distance of two neighbouring touches: fingertips are as wide as that."""

_APART = ((0.025, 0.029, 0.034), (0.019, 0.023, 0.026), (0.025, 0.031, 0.036))
"""m from index to middle, middle to ring and ring to little finger: 10, 50 and 90 percent of
layouts are below."""
_TENTH = 1.2816
"""Standard deviations from a median to the value that one in ten is beyond."""
_UNUSUAL = 2.0
"""Standard deviations from the median, beyond which no hand is drawn."""
_BENDS = ((40.0, 5.0), (28.0, 4.0))
"""degrees, mean and standard deviation of the row's bends at the middle and at the ring finger."""
_FIRST = 20.0
"""degrees by which the way from the index to the middle finger leads outwards."""
_SMALLEST = 0.014
"""m, least distance of neighbours in a drawn hand of any size."""
_BORDER = 0.002
"""m from the end of a face to the middle of the outermost finger."""


@dataclass(frozen=True)
class Hand:
    """Fingers of one person, who is at a trial.

    Attributes:
        configuration: Settings of the simulated user.
        tips: Fingertips (4, 2) m of index, middle, ring and little finger on an arc, from the index
            finger: x across the fingers, y along them, so that the middle finger reaches farthest
            and the little finger least.
    """

    configuration: UserConfiguration
    tips: tuple[tuple[float, float], ...]

    @classmethod
    def draw(cls, configuration: UserConfiguration, seed: int) -> Hand:
        """Draws the hand of a trial's person.

        Args:
            configuration: Settings of the simulated user, among them the hand's size.
            seed: Seed of the user's randomness.
        """
        rng = np.random.default_rng([seed, 7_009])
        apart = []
        for low, middle, high in _APART:
            off = float(np.clip(rng.normal(), -_UNUSUAL, _UNUSUAL)) / _TENTH
            drawn = middle + off * (high - middle if off > 0 else middle - low)
            apart.append(max(drawn * configuration.hand_size, _SMALLEST))
        x = y = 0.0
        way = float(np.deg2rad(_FIRST))
        tips = [(x, y)]
        far = np.clip(rng.normal(size=2), -_UNUSUAL, _UNUSUAL).tolist()
        bends = [
            np.deg2rad(mean + s * spread) for (mean, spread), s in zip(_BENDS, far, strict=True)
        ]
        for length, bend in zip(apart, [0.0, *bends], strict=True):
            way -= float(bend)
            x, y = x + length * cos(way), y + length * sin(way)
            tips.append((x, y))
        return cls(configuration, tuple(tips))

    def row(self, fingers: int) -> Array:
        """Fingertips (fingers - 1, 2) m beside the thumb, turned so that the first and the last of
        them are equally far out.

        Args:
            fingers: Number of touching fingers with the thumb, 2 to 5.

        Returns:
            x from the middle between the first and the last finger towards the last; y outwards,
            0 for these two.
        """
        tips = np.array(self.tips[: fingers - 1])
        end = tips[-1]
        far = sqrt(end[0] ** 2 + end[1] ** 2)
        if far == 0.0:
            return tips
        c, s = end / far
        x, y = c * tips[:, 0] + s * tips[:, 1], c * tips[:, 1] - s * tips[:, 0]
        return np.column_stack([x - far / 2, y])

    def length(self, fingers: int) -> float:
        """Distance in m of the first and the last touching finger beside the thumb."""
        x, y = self.tips[fingers - 2]
        return sqrt(x**2 + y**2)

    @property
    def natural_axis(self) -> float:
        """Direction in rad across an object from thumb to fingers that is most comfortable: with
        more fingers than thumb and index, the row lies more nearly crosswise before the person."""
        c = self.configuration
        return c.natural_axis if c.fingers == 2 else c.natural_axis_of_row

    def room(self, face: float, fingers: int) -> float:
        """Length in m that a row of fingers leaves of a face."""
        return max(face - 2 * _BORDER - self.length(fingers), 0.0)

    def fitting(self, face: float) -> int:
        """Number of fingers, with the thumb, that touch an object with a face of this length, m:
        as many as the user wants, or as there is room for; at least 2."""
        return self.within(face - 2 * _BORDER)

    def within(self, room: float) -> int:
        """Number of fingers, with the thumb, whose row is no longer than the room, m."""
        fingers = self.configuration.fingers
        while fingers > 2 and self.length(fingers) > room:
            fingers -= 1
        return fingers
