"""A trial with a person: physics in its own thread at real time, the window in the main one."""

from __future__ import annotations

import threading

from sandbox.session.messages import Snapshot
from sandbox.trial.driver import Trial
from sandbox.trial.pacing import Pace


class LiveTrial:
    """Runs a trial in a thread of its own; a window or a page takes the newest snapshot.

    Args:
        trial: Ready for its first step. Its views are called in the trial's thread.
        speed: Simulated seconds per second.
        news: Set by a device when something has come in: the step that takes it in is made at once,
            up to one control period ahead of the clock, instead of at the next tick.

    Attributes:
        failure: The error that ended the thread before its time; None while there is none. A trial
            that ended so must not be taken for one that was played: raise it.
    """

    def __init__(
        self, trial: Trial, speed: float = 1.0, news: threading.Event | None = None
    ) -> None:
        self._trial = trial
        self._pace = Pace(speed, news)
        self._stop = threading.Event()
        self._running = threading.Event()
        self._running.set()
        self._thread = threading.Thread(target=self._run, name="session", daemon=True)
        self.failure: Exception | None = None

    @property
    def over(self) -> bool:
        """True when the trial's thread has ended."""
        return not self._thread.is_alive() and self._thread.ident is not None

    @property
    def newest(self) -> Snapshot | None:
        """The latest snapshot; older ones are gone."""
        return self._trial.newest

    @property
    def lost(self) -> float:
        """s of real time given up so far because the machine was too slow."""
        return self._pace.lost

    def start(self) -> None:
        """Starts the thread."""
        self._thread.start()

    def pause(self, paused: bool) -> None:
        """Halts simulated time, or lets it go on."""
        if paused:
            self._running.clear()
        else:
            self._running.set()

    def set_speed(self, speed: float) -> None:
        """Goes on at so many simulated seconds per second; the simulation itself stays the same."""
        self._pace.speed = speed

    def stop(self) -> None:
        """Ends the thread; the score stays as it is."""
        self._stop.set()
        self._running.set()
        if self._thread.ident is not None:
            self._thread.join()

    def _run(self) -> None:
        try:
            self._trial.run(self._pace, self._stood_still, self._stop.is_set)
        except Exception as error:
            self.failure = error

    def _stood_still(self) -> bool:
        """Waits while time stands still; True where it did."""
        if self._running.is_set():
            return False
        self._running.wait()
        return True
