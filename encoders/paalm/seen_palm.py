"""Learns the shift of the palm's centre that the first Leap software reports.

The reported centre is in front of the average hand's centre, by a distance that differs from hand
to hand. The line of a finger that is seen at its full length leads back to its knuckle, and the
knuckles determine the position of the palm. `LearnedPalm` learns the shift while an unmeasured hand
is seen. It also learns each finger's full length: nearly the longest length so far, since the
device often reports shorter lengths. Only past frames are used.

The centre sometimes moves towards the fingers for a time, by 6 cm in the real recording v1-hands
when a hand leaves the view. Every finger then seems to end too near to its knuckle, although it is
not lowered. Among real postures, only a claw looks like this. The median of this error over all
fingers is the `slip`.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, degrees, inf, sqrt

from encoders.paalm.calibration import LONGEST, NEARLY
from encoders.paalm.chain import FingerChain
from models.arithmetic import total
from models.frames import FINGERS, Vector

FIRST_SHIFT = (0.007, -0.031, 0.005)
"""Initial shift (m, in palm coordinates) from the device's centre of the palm to the average
hand's. It is the mean of both hands in the real recording v1-hands. There, the distance from a
finger's visible part to its knuckle was taken to be the part that the device leaves out
(`PaalmOptions.hidden`)."""
PRIOR = 60.0
"""Weight of the initial guess, in frames with a finger at its full length: about half a second."""
STEP = 0.0002
"""Largest change (m) of the shift in use in one frame, so that fingertips do not jump."""
FAR = 0.04
"""If a finger's shift differs from the shift in use by more than this distance (m), it is not used.
The palm is then reported the wrong way round, or the hand leaves the view."""
_BIN = 0.001
"""Width (m) of a bin in the histogram of lengths."""
_BINS = 160


class LearnedPalm:
    """Learns the palm's shift and the fingers' full lengths of one hand.

    Args:
        shift: (3,) m, initial guess of the shift, see `HandCalibration.palm_shift`.
        standard: (5,) m, full lengths of the average hand's fingers.
        behind: (5,) distances from a finger's visible part back to its knuckle, as shares of its
            full length.
        knuckles: (5, 3) m, knuckles of the average hand relative to its palm's centre.

    Attributes:
        shift: The shift in use, which approaches the learned shift in small steps.
        standard: Full lengths (m) of the fingers.
    """

    def __init__(
        self,
        shift: Vector,
        standard: Sequence[float],
        behind: Sequence[float],
        knuckles: Sequence[Vector],
    ) -> None:
        self.shift = shift
        self.standard = list(standard)
        self._behind, self._knuckles = behind, knuckles
        self._lengths = [_Longest(length) for length in standard]
        self._sums = [[PRIOR * c for c in shift] for _ in FINGERS]
        self._weights = [PRIOR] * len(FINGERS)

    def add(self, name: int, length: float, tip: Vector, along: Vector) -> None:
        """Learns from a finger in a frame.

        Args:
            name: Finger, thumb 0 to little 4.
            length: Visible length (m) of the finger.
            tip: Tip (m) in palm coordinates.
            along: Direction of the finger in palm coordinates.
        """
        full = self.standard[name] = self._lengths[name].add(length)
        if name == 0 or length < NEARLY * full:
            return
        back = full * (1.0 + self._behind[name])
        k = self._knuckles[name]
        off = [t - back * d - c for t, d, c in zip(tip, along, k, strict=True)]
        if max(abs(a - b) for a, b in zip(off, self.shift, strict=True)) < FAR:
            self._weights[name] += 1.0
            self._sums[name] = [a + b for a, b in zip(self._sums[name], off, strict=True)]

    def move(self) -> None:
        """Moves the shift in use towards the learned shift; called once a frame."""
        x, y, z = (
            used + min(max(total(self._mean(f, i) for f in range(1, 5)) / 4.0 - used, -STEP), STEP)
            for i, used in enumerate(self.shift)
        )
        self.shift = (x, y, z)

    def _mean(self, finger: int, axis: int) -> float:
        return self._sums[finger][axis] / self._weights[finger]


class _Longest:
    """High percentile (`LONGEST`) of the lengths so far.

    Args:
        guess: Initial guess (m), which counts as `PRIOR` lengths.
    """

    def __init__(self, guess: float) -> None:
        self._counts = [0.0] * _BINS
        self._total = PRIOR
        self._counts[min(int(guess / _BIN), _BINS - 1)] = PRIOR

    def add(self, length: float) -> float:
        self._counts[min(int(length / _BIN), _BINS - 1)] += 1.0
        self._total += 1.0
        above, left = 0.0, (1.0 - LONGEST / 100.0) * self._total
        for i in range(_BINS - 1, -1, -1):
            above += self._counts[i]
            if above >= left:
                return (i + 0.5) * _BIN
        return 0.5 * _BIN


LEVEL = 10.0
"""Angle (degrees) below the palm's direction up to which a finger counts as straight."""


OVERREACH = 0.004
"""Distance (m) by which a finger's chain may end short of the visible tip, since the chain has the
average hand's bones."""


def slip(fingers: Sequence[tuple[FingerChain, Vector]], overreach: float = inf) -> float:
    """The slip (m) of a palm's centre towards the fingers; negative if the centre is too far back.

    A bent finger is usually lowered by about the angle of its PIP, so its direction gives its usual
    length. The slip is the median difference from this length. It is limited so that no tip is
    farther away than its finger can reach.

    Args:
        fingers: Chain and tip (m from the knuckle, in palm axes) of every visible finger except the
            thumb.
        overreach: Distance (m) by which a chain may end short of the tip.
    """
    slips = []
    most = inf
    for chain, (x, y, z) in fingers:
        lowered = max(degrees(atan2(-z, max(y, 1e-6))) - LEVEL, 0.0)
        usual = chain.chord(min(lowered, chain.limits.pip[1]))
        aside = sqrt(x * x + z * z)
        slips.append(sqrt(max(usual * usual - aside * aside, 0.0)) - y)
        far = chain.longest * chain.longest - aside * aside
        if far > 0.0:
            most = min(most, sqrt(far) - y + overreach)
    if not slips:
        return 0.0
    slips.sort()
    middle = 0.5 * (slips[(len(slips) - 1) // 2] + slips[len(slips) // 2])
    return min(middle, most)
