"""Keeps a session with a person at real time."""

from __future__ import annotations

import threading
import time

from models.scene import CONTROL_PERIOD

LEEWAY = 0.10
"""s behind real time from which on the lost time is given up: the session then runs slower than
real time and says so, rather than hurrying after a moment that has passed."""

ROOM = 0.004
"""s before expected news that are kept free of a step nobody asked for; one takes 1 to 2 ms."""
JITTER = 0.001
"""s by which news may come earlier or later than expected."""


class RealTime:
    """Waits for the wall clock to catch up with simulated time.

    Args:
        speed: Simulated seconds per second.
        simulated: s of simulated time that is due now.

    Attributes:
        lost: s of real time given up so far because the machine was too slow.
    """

    def __init__(self, speed: float = 1.0, simulated: float = 0.0) -> None:
        self.speed = speed
        self.lost = 0.0
        self._origin = time.monotonic() - simulated / speed
        self._heard = self._expected = float("-inf")

    def wait(
        self, simulated: float, news: threading.Event | None = None, lead: float = 0.0
    ) -> None:
        """Returns when `simulated` seconds of simulated time are due, or earlier for news.

        Args:
            simulated: s.
            news: When it is set, simulated time may run ahead of the clock, so that a touch that
                comes between two steps need not wait for the next one. None waits for the clock.
            lead: s of real time by which it may.
        """
        due = self._origin + simulated / self.speed
        ahead = due - time.monotonic()
        if news is not None and ahead > 0:
            # News that comes earlier than the last finds somebody who listens.
            if ahead > lead + JITTER:
                time.sleep(ahead - lead - JITTER)
            if news.wait(max(clear_of(due, self._expected) - time.monotonic(), 0.0)):
                now = time.monotonic()
                # As long after this news as this came after the last.
                self._expected, self._heard = 2.0 * now - self._heard, now
        elif ahead > 0:
            time.sleep(ahead)
        elif ahead < -LEEWAY:
            self._origin -= ahead
            self.lost -= ahead


class Pace:
    """Keeps a trial at real time, also when its speed changes or its time stands still.

    Args:
        speed: Simulated seconds per second.
        news: See `RealTime.wait`; the step that takes news in may be one control period early.

    Attributes:
        speed: As given; may be changed at any time, from any thread.
    """

    def __init__(self, speed: float = 1.0, news: threading.Event | None = None) -> None:
        self.speed = speed
        self._news = news
        self._clock: RealTime | None = None
        self._given_up = 0.0

    @property
    def lost(self) -> float:
        """s of real time given up so far because the machine was too slow."""
        return self._given_up + (self._clock.lost if self._clock else 0.0)

    def begin(self, simulated: float) -> None:
        """Starts at a simulated time, s: time that stood still is not caught up with."""
        self._given_up = self.lost
        self._clock = RealTime(self.speed, simulated)

    def wait(self, simulated: float) -> None:
        """Returns when a simulated time, s, is due."""
        clock = self._clock
        if clock is None or clock.speed != self.speed:
            # The step that was just made began at the old speed; the next one keeps to the new.
            self.begin(simulated)
            return
        clock.wait(simulated, self._news, CONTROL_PERIOD / clock.speed)


def clear_of(due: float, expected: float) -> float:
    """When to make a step that nobody asked for, so that expected news need not wait for it, s.

    Touches come at a rate of their own. A few times a second a tick falls just before one, which
    would have to wait for the whole step; so the tick is made earlier.

    Args:
        due: When the step is due.
        expected: When news is expected.
    """
    return due - ROOM if due - JITTER < expected < due + ROOM else due
