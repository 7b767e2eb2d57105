"""How much a device makes fingers tremble, and how much smoothing that asks for.

A fixed filter that is slow enough for a noisy device is slow with a quiet one, too. A One-Euro
filter (Casiez, Roussel, Vogel 2012) opens with speed instead, but noise that is worth a filter
looks as fast as fingers are. So the noise itself is measured: the second difference of where a
finger points, from frame to frame, of which a hand's own movement has hardly any.
"""

from __future__ import annotations

from math import sqrt

from models.frames import Vector

STEADY = 0.007
"""m of second differences of a fingertip that are left alone at a time constant of one frame. White
noise of variance v leaves v dt / 2T of itself behind a low-pass of constant T: so T grows with its
square."""
_SHARE = 1.0 / 16.0
"""Of a new difference in the running mean; a quarter of a second in a session."""
_JUMP = 3.0
"""Times the mean that one difference counts for at most: a finger that was lost for a moment jumps
once."""


class Trembling:
    """Of one fingertip.

    Attributes:
        mean: m, of its second differences.
    """

    __slots__ = ("_before", "_last", "mean")

    def __init__(self) -> None:
        self.mean = 0.0
        self.interrupt()

    def interrupt(self) -> None:
        """The finger is not seen: what comes next has no before."""
        self._last: Vector | None = None
        self._before: Vector | None = None

    def see(self, place: Vector) -> None:
        """Takes in the next frame's place, m."""
        a, b = self._before, self._last
        self._before, self._last = b, place
        if a is None or b is None:
            return
        x, y, z = (a[i] - 2.0 * b[i] + place[i] for i in range(3))
        most = _JUMP * max(self.mean, STEADY)
        self.mean += _SHARE * (min(sqrt(x * x + y * y + z * z), most) - self.mean)

    def constant(self, dt: float, least: float, most: float) -> float:
        """The time constant, s, of a low-pass that leaves it steady.

        Args:
            dt: s between frames.
            least, most: s, bounds.
        """
        return min(max(dt * (self.mean / STEADY) ** 2, least), most)
