"""Warns if a hand's yaw is outside the range of the encoder's training data.

Encoders are not rotation-invariant: the paper's device lay in front of the person, and so did ours.
A hand's yaw must be estimated from the touches. The yaw of the encoder's pose cannot be used: it is
learned from hands with the usual yaw, and for other touches the encoder gives wrong fingers at the
usual yaw. The natural layout, in contrast, gives the yaw of four or five touches without prior
knowledge of fingers or yaw. Two or three touches fit it in several ways; there the yaw follows from
their labels, so that at least a hand that turns further after it has come down is noticed.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, remainder

import numpy as np

from encoders.person.natural_layout import LEAST, NaturalLayout
from models.arithmetic.arrays import Array
from models.errors import CaptureError
from models.message import Message

RARE = 0.005
"""Share of the training frames on either side that are left out of the range as outliers."""

_FIVE = 50
"""Least number of frames with five fingers from which a range can be estimated."""


_LATEST: dict[str, tuple[Array, YawRange]] = {}
"""The last computed range, with its input."""


@dataclass(frozen=True)
class YawRange:
    """Range of the hands' yaw in an encoder's training data.

    Attributes:
        layout: Their natural layout, which gives the yaw.
        low, high: rad, counterclockwise; 0 is the average yaw.
    """

    layout: NaturalLayout
    low: float
    high: float

    @classmethod
    def of(cls, U: Array) -> YawRange:
        """Computes the range from contact vectors (T, 15) of the training data.

        Raises:
            CaptureError: Too few of them have five fingers.
        """
        known = _LATEST.get("range")
        if known is not None and known[0] is U:
            # All trials of a run need the same range.
            return known[1]
        five = U[U[:, 10:].all(axis=1)]
        if len(five) < _FIVE:
            raise CaptureError(
                "too few frames with five fingers to estimate the range of yaw",
                got=len(five),
                expected=f"{_FIVE} or more",
            )
        layout = NaturalLayout(five[:, :10].reshape(-1, 5, 2))
        turns = np.sort(layout.turns)
        places = np.array([RARE, 1.0 - RARE]) * (len(turns) - 1)
        low, high = np.interp(places, np.arange(len(turns)), turns)
        yaw_range = cls(layout, float(low), float(high))
        _LATEST["range"] = (U, yaw_range)
        return yaw_range

    def turn(self, u: Array) -> float | None:
        """Yaw in rad of a contact vector's hand; None for a single touch."""
        numbers = u.tolist()
        fingers = [f for f in range(5) if numbers[10 + f]]
        if len(fingers) < 2:
            return None
        if len(fingers) < LEAST:
            return self.layout.turn([numbers[2 * f : 2 * f + 2] for f in fingers], fingers)
        return self.layout.match(u[:10].reshape(5, 2)[fingers]).turn

    def beyond(self, turn: float) -> float:
        """Angle in rad by which a yaw is outside of the range; 0 inside."""
        if self.low <= turn <= self.high:
            return 0.0
        # The range has two ends, and from outside both can be reached.
        return min(abs(remainder(end - turn, 2 * pi)) for end in (self.low, self.high))


@dataclass(frozen=True)
class YawWarningSettings:
    """Settings of the yaw warning.

    Attributes:
        outside: rad beyond the range from which on a hand counts as outside.
        inside: rad beyond the range below which it counts as back inside.
        lasting: s that it must be outside before the warning starts, and inside before it ends.
        apart: s, least time between the beginnings of two warnings.
    """

    outside: float = float(np.deg2rad(15.0))
    inside: float = float(np.deg2rad(5.0))
    lasting: float = 0.4
    apart: float = 10.0


class YawMonitor:
    """Watches one hand's yaw.

    Args:
        range: Range of the training data.
        settings: Settings of the warning.

    Attributes:
        notice: Notice to the person; empty while all is well.
        warnings: Number of warnings so far.
    """

    def __init__(self, range: YawRange, settings: YawWarningSettings | None = None) -> None:
        self.range, self.settings = range, settings or YawWarningSettings()
        self.reset()

    def reset(self) -> None:
        """Returns to the initial state."""
        self.notice: str = ""
        self.warnings = 0
        self._since: float | None = None
        self._warned = -np.inf

    def step(self, time: float, u: Array | None) -> str:
        """Processes a contact vector (15,), None without labelled touches; returns the notice."""
        turn = None if u is None else self.range.turn(u)
        if turn is None:
            # A hand that has left has no yaw; the notice stays until the next one is seen.
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
            self.notice = Message(
                "hand_turned",
                "the hand seems turned by {degrees} degrees, beyond the {low} to {high} that were "
                "trained: see --turn",
                degrees=f"{np.rad2deg(turn):.0f}",
                low=f"{low:.0f}",
                high=f"{high:.0f}",
            )
            self.warnings += 1
            self._warned, self._since = time, None
        return self.notice
