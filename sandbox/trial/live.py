"""A trial with a person: physics in its own thread at real time, the window in the main one."""

from __future__ import annotations

import threading

from sandbox.session.messages import Snapshot
from sandbox.trial.driver import Trial
from sandbox.trial.pacing import Pace


class LiveTrial:
    """Runs a trial in its own thread; a window or a page takes the newest snapshot.

    Args:
        trial: A trial that is ready for its first step. Its views are called in its thread.
        speed: Simulated seconds per second.
        frame_ready: Event that a device sets when a frame has arrived. The step that takes the
            frame in is then made at once, up to one control period ahead of the clock.

    Attributes:
        failure: The error that ended the thread early; None without one. The caller must raise it,
            so that the trial does not count as played.
    """

    def __init__(
        self, trial: Trial, speed: float = 1.0, frame_ready: threading.Event | None = None
    ) -> None:
        self._trial = trial
        self._pace = Pace(speed, frame_ready)
        self._stop = threading.Event()
        self._running = threading.Event()
        self._running.set()
        self._thread = threading.Thread(target=self._run, name="session", daemon=True)
        self.failure: BaseException | None = None

    @property
    def over(self) -> bool:
        """True when the trial's thread has ended."""
        return not self._thread.is_alive() and self._thread.ident is not None

    @property
    def newest(self) -> Snapshot | None:
        """The latest snapshot; None before the first step."""
        return self._trial.newest

    @property
    def lost(self) -> float:
        """s of real time given up so far because the machine was too slow."""
        return self._pace.lost

    def start(self) -> None:
        """Starts the thread."""
        self._thread.start()

    def pause(self, paused: bool) -> None:
        """Pauses simulated time, or resumes it."""
        if paused:
            self._running.clear()
        else:
            self._running.set()

    def set_speed(self, speed: float) -> None:
        """Sets the pace in simulated seconds per second; the simulation itself stays the same."""
        self._pace.speed = speed

    def stop(self) -> None:
        """Ends the thread; the score stays as it is."""
        self._stop.set()
        self._running.set()
        if self._thread.ident is not None:
            self._thread.join()

    def _run(self) -> None:
        try:
            self._trial.run(self._pace, self._wait_while_paused, self._stop.is_set)
        except BaseException as error:  # nothing may end a trial without a word
            self.failure = error

    def _wait_while_paused(self) -> bool:
        """Waits while the trial is paused; True if it was."""
        if self._running.is_set():
            return False
        self._running.wait()
        for rig in self._trial.session.rigs:
            if rig.device.latency is not None:
                rig.device.latency.resume()
        return True
