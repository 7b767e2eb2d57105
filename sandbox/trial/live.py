"""A session with a person: physics in its own thread at real time, the window in the main one."""

from __future__ import annotations

import threading
from collections.abc import Callable
from dataclasses import replace

from models.errors import DivergenceError
from models.scene import CONTROL_PERIOD
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.pacing import RealTime


class LiveSession:
    """Runs a session in a thread of its own; the newest snapshot waits for whoever looks.

    Args:
        session: Ready for its first step.
        on_step: Called in the session's thread with every snapshot, in order (a looking device).
        speed: Simulated seconds per second.
        news: Set by a device when something has come in: the step that takes it in is made at once,
            up to one control period ahead of the clock, instead of at the next tick.

    Attributes:
        lost: s of real time given up so far because the machine was too slow.
        failure: What ended the session's thread before its time; None while nothing has.
    """

    def __init__(
        self,
        session: Session,
        on_step: Callable[[Snapshot], None] | None = None,
        speed: float = 1.0,
        news: threading.Event | None = None,
    ) -> None:
        self.session = session
        self._news = news
        self._on_step = on_step
        self._speed = speed
        self._newest: Snapshot | None = None
        self._stop = threading.Event()
        self._running = threading.Event()
        self._running.set()
        self._thread = threading.Thread(target=self._run, name="session", daemon=True)
        self.lost = 0.0
        self.failure: Exception | None = None

    @property
    def over(self) -> bool:
        """Whether the session's thread has ended."""
        return not self._thread.is_alive() and self._thread.ident is not None

    @property
    def newest(self) -> Snapshot | None:
        """The latest snapshot; older ones are gone."""
        return self._newest

    def start(self) -> None:
        """Begins."""
        self._thread.start()

    def pause(self, paused: bool) -> None:
        """Halts simulated time, or lets it go on."""
        if paused:
            self._running.clear()
        else:
            self._running.set()

    def set_speed(self, speed: float) -> None:
        """Goes on at so many simulated seconds per second; the simulation itself stays the same."""
        self._speed = speed

    def stop(self) -> None:
        """Ends the session's thread; the score stays as it is."""
        self._stop.set()
        self._running.set()
        self._thread.join()

    def _run(self) -> None:
        clock, given_up = RealTime(self._speed), 0.0
        try:
            while not self.session.over and not self._stop.is_set():
                stood = not self._running.is_set()
                if stood:
                    self._running.wait()
                if stood or clock.speed != self._speed:
                    # Time that stood still, or went slower, is not to be caught up with.
                    given_up += clock.lost
                    clock = RealTime(self._speed, self.session.time)
                snapshot = self.session.advance()
                self._newest = snapshot
                if self._on_step:
                    self._on_step(snapshot)
                clock.wait(snapshot.time, self._news, CONTROL_PERIOD / clock.speed)
                self.lost = given_up + clock.lost
        except DivergenceError:
            # The trial is marked and the score says so; there is nothing more to simulate, and what
            # was simulated last is nothing to look at.
            if self._newest is not None:
                self._newest = replace(self._newest, score=self.session.scorer.score)
        except Exception as error:
            # A device broke, or its code did. Whoever waits for this thread passes it on: a trial
            # that ended so must not be taken for one that was played.
            self.failure = error
