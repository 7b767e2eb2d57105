"""Whether a hand is turned further than any that the encoder has seen, and a warning if so.

Encoders are not rotation-invariant: the paper's device lay before the person, and so did ours. What
a hand's turn is must be told from the touches. The turn of the encoder's pose cannot serve: it is
learned from hands that were turned as usual, and of touches that were not it makes fingers that are
wrong but a turn that is usual. The natural layout, in contrast, finds the turn of four or five
touches without knowing fingers or turn beforehand. Two or three touches fit it in several ways;
there the turn follows from the names that the fingers have, so that at least a hand which is turned
ever further after it has come down is noticed.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, remainder

import numpy as np
from numpy.typing import NDArray

from encoders.person.natural_layout import LEAST, NaturalLayout
from models.errors import CaptureError

Array = NDArray[np.float64]

RARE = 0.005
"""Share of the training frames on either side that do not count as trained: a few odd moments."""

_FIVE = 50
"""Frames with five fingers below which a capture says nothing about turns."""


_LATEST: dict[str, tuple[Array, YawRange]] = {}
"""The range made last, with what it was made of."""


@dataclass(frozen=True)
class YawRange:
    """Turns of the hands that an encoder was trained on.

    Attributes:
        layout: Their natural layout, which tells turns.
        low, high: rad, counterclockwise; 0 is the turn that hands had on average.
    """

    layout: NaturalLayout
    low: float
    high: float

    @classmethod
    def of(cls, U: Array) -> YawRange:
        """The range of contact vectors (T, 15) that an encoder was trained on.

        Raises:
            CaptureError: Too few of them have five fingers.
        """
        known = _LATEST.get("range")
        if known is not None and known[0] is U:
            # The trials of a run ask for the same again and again.
            return known[1]
        five = U[U[:, 10:].all(axis=1)]
        if len(five) < _FIVE:
            raise CaptureError(
                "too few frames with five fingers to know how hands were turned", got=len(five),
                expected=f"{_FIVE} or more",
            )  # fmt: skip
        layout = NaturalLayout(five[:, :10].reshape(-1, 5, 2))
        low, high = np.quantile(layout.turns, [RARE, 1.0 - RARE])
        yaw_range = cls(layout, float(low), float(high))
        _LATEST["range"] = (U, yaw_range)
        return yaw_range

    def turn(self, u: Array) -> float | None:
        """rad, how a contact vector's hand is turned; None where one touch cannot tell."""
        numbers = u.tolist()
        fingers = [f for f in range(5) if numbers[10 + f]]
        if len(fingers) < 2:
            return None
        if len(fingers) < LEAST:
            return self.layout.turn([numbers[2 * f : 2 * f + 2] for f in fingers], fingers)
        return self.layout.match(u[:10].reshape(5, 2)[fingers]).turn

    def beyond(self, turn: float) -> float:
        """rad, how far a turn is outside of the range; 0 inside."""
        if self.low <= turn <= self.high:
            return 0.0
        # The range has two ends, and from outside both can be reached.
        return min(abs(remainder(end - turn, 2 * pi)) for end in (self.low, self.high))


@dataclass(frozen=True)
class YawWarning:
    """When to warn.

    Attributes:
        outside: rad beyond the range from which on a hand counts as outside.
        inside: rad beyond the range below which it counts as back inside.
        lasting: s for which it must be outside before it is said, and inside before it is over.
        apart: s between the beginnings of two warnings.
    """

    outside: float = float(np.deg2rad(15.0))
    inside: float = float(np.deg2rad(5.0))
    lasting: float = 0.4
    apart: float = 10.0


class YawWatch:
    """Watches one hand's turn.

    Args:
        range: Of the training.
        settings: When to warn.

    Attributes:
        notice: What the person should know now; empty when all is well.
        warnings: How many there have been.
    """

    def __init__(self, range: YawRange, settings: YawWarning | None = None) -> None:
        self.range, self.settings = range, settings or YawWarning()
        self.reset()

    def reset(self) -> None:
        """As at the start."""
        self.notice, self.warnings = "", 0
        self._since: float | None = None
        self._warned = -np.inf

    def step(self, time: float, u: Array | None) -> str:
        """Takes in a contact vector (15,), None without named touches; returns the notice."""
        turn = None if u is None else self.range.turn(u)
        if turn is None:
            # A hand that has left is not turned; the notice stays until the next one is seen.
            self._since = None
            return self.notice
        s, beyond = self.settings, self.range.beyond(turn)
        changed = beyond < s.inside if self.notice else beyond > s.outside
        if not changed:
            self._since = None
            return self.notice
        self._since = time if self._since is None else self._since
        if time - self._since < s.lasting - 1e-9:
            return self.notice
        if self.notice:
            self.notice, self._since = "", None
        elif time - self._warned >= s.apart:
            low, high = np.rad2deg([self.range.low, self.range.high])
            self.notice = (
                f"the hand seems turned by {np.rad2deg(turn):.0f} degrees, beyond the "
                f"{low:.0f} to {high:.0f} that were trained: see --turn"
            )
            self.warnings += 1
            self._warned, self._since = time, None
        return self.notice
