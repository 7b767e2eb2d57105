"""Keeps a session with a person at real time."""

from __future__ import annotations

import threading
import time

LEEWAY = 0.10
"""s behind real time from which on the lost time is given up: the session then runs slower than
real time and says so, rather than hurrying after a moment that has passed."""


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
            if ahead > lead:
                time.sleep(ahead - lead)
            news.wait(max(due - time.monotonic(), 0.0))
        elif ahead > 0:
            time.sleep(ahead)
        elif ahead < -LEEWAY:
            self._origin -= ahead
            self.lost -= ahead
