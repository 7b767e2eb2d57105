"""Pacing: keeps a session with a person at real time."""

from __future__ import annotations

import threading
import time

from models.scene import CONTROL_PERIOD

LEEWAY = 0.10
"""s behind real time beyond which the session gives up the lost time. It then runs slower than real
time and says so, instead of hurrying to catch up."""

ROOM = 0.004
"""s before an expected frame in which no step is made without a frame; a step takes 1 to 2 ms."""
JITTER = 0.001
"""s by which a frame may come earlier or later than expected."""


class RealTime:
    """Waits for the wall clock to catch up with simulated time.

    Args:
        speed: Simulated seconds per second.
        simulated: s, simulated time that is due now.

    Attributes:
        lost: s of real time given up so far because the machine was too slow.
    """

    def __init__(self, speed: float = 1.0, simulated: float = 0.0) -> None:
        self.speed = speed
        self.lost = 0.0
        self._origin = time.monotonic() - simulated / speed
        self._heard = self._expected = float("-inf")

    def wait(
        self, simulated: float, frame_ready: threading.Event | None = None, lead: float = 0.0
    ) -> None:
        """Returns when a simulated time is due, or earlier when a frame has arrived.

        Args:
            simulated: s, simulated time.
            frame_ready: Event of an arrived frame: while it is set, simulated time may run ahead of
                the clock, so that a touch between two steps need not wait. None waits for the
                clock.
            lead: s of real time by which simulated time may run ahead.
        """
        due = self._origin + simulated / self.speed
        ahead = due - time.monotonic()
        if frame_ready is not None and ahead > 0:
            # Wakes up early enough for a frame that comes earlier than expected.
            if ahead > lead + JITTER:
                time.sleep(ahead - lead - JITTER)
            if frame_ready.wait(max(clear_of(due, self._expected) - time.monotonic(), 0.0)):
                now = time.monotonic()
                # The next frame is expected after the same interval as this one.
                self._expected, self._heard = 2.0 * now - self._heard, now
        elif ahead > 0:
            time.sleep(ahead)
        elif ahead < -LEEWAY:
            self._origin -= ahead
            self.lost -= ahead


class Pace:
    """Keeps a trial at real time, also when its speed changes or the trial is paused.

    Args:
        speed: Simulated seconds per second.
        frame_ready: See `RealTime.wait`; the step that takes a frame in may be one control period
            early.

    Attributes:
        speed: As given; may be changed at any time, from any thread.
    """

    def __init__(self, speed: float = 1.0, frame_ready: threading.Event | None = None) -> None:
        self.speed = speed
        self._frame_ready = frame_ready
        self._clock: RealTime | None = None
        self._given_up = 0.0

    @property
    def lost(self) -> float:
        """s of real time given up so far because the machine was too slow."""
        return self._given_up + (self._clock.lost if self._clock else 0.0)

    def begin(self, simulated: float) -> None:
        """Starts the clock at a simulated time, s; a pause before it is not caught up with."""
        self._given_up = self.lost
        self._clock = RealTime(self.speed, simulated)

    def wait(self, simulated: float) -> None:
        """Returns when a simulated time, s, is due."""
        clock = self._clock
        if clock is None or clock.speed != self.speed:
            # The step that was just made began at the old speed; the new one starts here.
            self.begin(simulated)
            return
        clock.wait(simulated, self._frame_ready, CONTROL_PERIOD / clock.speed)


def clear_of(due: float, expected: float) -> float:
    """Time at which to make a step without a frame, s, so that an expected frame need not wait.

    Touches come at a rate of their own. A few times a second a step falls due just before a touch,
    which would have to wait for the whole step; that step is made earlier.

    Args:
        due: s, time at which the step is due.
        expected: s, time at which a frame is expected.
    """
    return due - ROOM if due - JITTER < expected < due + ROOM else due
