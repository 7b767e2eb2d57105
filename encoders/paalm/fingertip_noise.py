"""Measures a device's noise in fingertips, and the smoothing that it requires.

A fixed filter that is slow enough for a noisy device is slow with a quiet one, too. A One-Euro
filter (Casiez, Roussel, Vogel 2012) adapts to speed instead, but noise that needs a filter looks as
fast as real movement. So the noise itself is measured by second differences of a fingertip's
position from frame to frame, to which a hand's own movement hardly contributes.
"""

from __future__ import annotations

from math import sqrt

from models.frames import Vector

STEADY = 0.007
"""m of second differences of a fingertip that are accepted at a time constant of one frame. A
low-pass with time constant T reduces white noise of variance v to v dt / 2T, so T grows with the
square of the noise."""
TIP_STEADY = 0.003
"""m, the same for fingers that are solved by their tips."""
_SHARE = 1.0 / 16.0
"""Weight of a new difference in the running mean; a quarter of a second in a session."""
_JUMP = 3.0
"""Largest difference that counts, as a multiple of the mean: a finger that was lost for a moment
jumps once."""


class FingertipNoise:
    """Measures the noise of one fingertip.

    Args:
        steady: m of second differences that are accepted, see `STEADY`.

    Attributes:
        mean: m, mean of its second differences.
    """

    __slots__ = ("_before", "_last", "_steady", "mean")

    def __init__(self, steady: float = STEADY) -> None:
        self.mean = 0.0
        self._steady = steady
        self.interrupt()

    def interrupt(self) -> None:
        """Records that the finger is not seen, so that the next position has no predecessor."""
        self._last: Vector | None = None
        self._before: Vector | None = None

    def add(self, place: Vector) -> None:
        """Adds the next frame's position, m."""
        a, b = self._before, self._last
        self._before, self._last = b, place
        if a is None or b is None:
            return
        x = a[0] - 2.0 * b[0] + place[0]
        y = a[1] - 2.0 * b[1] + place[1]
        z = a[2] - 2.0 * b[2] + place[2]
        mean, steady = self.mean, self._steady
        most = _JUMP * (mean if mean >= steady else steady)
        difference = sqrt(x * x + y * y + z * z)
        self.mean += _SHARE * ((most if difference > most else difference) - mean)

    def constant(self, dt: float, least: float, most: float) -> float:
        """Time constant in s of a low-pass that makes the fingertip steady.

        Args:
            dt: s between frames.
            least, most: s, limits of the time constant.
        """
        return min(max(dt * (self.mean / self._steady) ** 2, least), most)
