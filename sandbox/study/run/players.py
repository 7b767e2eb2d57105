"""Who plays a trial: headless as fast as it goes or at real time, or a person before a window."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.study.tables.frames import FrameTable
from sandbox.trial.device_makers import DeviceMakers
from sandbox.trial.driver import Trial, View, ViewMaker, open_trial
from sandbox.trial.live import LiveTrial
from sandbox.trial.pacing import Pace
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import RunSettings
from tasks.score import Status

TICK = 0.02
"""s between two looks at what the experimenter wants while time stands still."""

Watch = Callable[[], str]
"""Lets the experimenter be heard: empty to go on, else why the attempt is broken off."""


@dataclass(frozen=True)
class TrialRequest:
    """A trial to be played.

    Attributes:
        settings: How it goes.
        makers: Open the devices, one for every hand.
        record: Where its recording goes.
        about: For the recording's header.
        time_limit: s, of the study.
        watch: See `Watch`.
        paused: Whether time is to stand still.
    """

    settings: RunSettings
    makers: DeviceMakers
    record: Path
    about: dict[str, Any]
    time_limit: float
    watch: Watch
    paused: Callable[[], bool]


@dataclass
class PlayedAttempt:
    """How it went: the result, the tables, and why it was broken off (empty: it was not)."""

    result: TrialResult
    table: FrameTable
    broken: str = ""


class TrialPlayer(Protocol):
    """Plays trials."""

    def play(self, request: TrialRequest) -> PlayedAttempt:
        """Plays one to its end, and closes its recording.

        Raises:
            InputError: A device broke, or the recording cannot be written.
        """
        ...

    def close(self) -> None:
        """Gives back what it holds between trials."""
        ...


@dataclass
class HeadlessPlayer:
    """Plays without a window.

    Attributes:
        paced: At real time, as for a person; otherwise as fast as it goes.
    """

    paced: bool = False

    def play(self, request: TrialRequest) -> PlayedAttempt:
        attempt = RunningAttempt(request)
        pace = Pace() if self.paced else None
        with attempt.open() as trial:
            trial.run(pace, attempt.stands_still, lambda: bool(attempt.broken))
            return attempt.end(trial, pace.lost if pace else 0.0)

    def close(self) -> None:
        """Nothing to give back."""


@dataclass
class WindowPlayer:
    """Plays in a window, at real time. Keys that would start again or pause are not the
    participant's: the experimenter has them.

    Attributes:
        caption: Shown where no person plays.
    """

    caption: str = ""
    _window: Any = field(default=None, repr=False)

    def play(self, request: TrialRequest) -> PlayedAttempt:
        from sandbox.views.window.window import Window

        attempt = RunningAttempt(request)
        with attempt.open() as trial:
            session = trial.session
            self.close()
            self._window = Window(
                session.scene,
                session.whole_surface,
                title=session.task.name,
                caption=self.caption,
                in_air=request.settings.in_air,
            )
            self._window.attach(*(rig.device for rig in session.rigs))
            live = LiveTrial(trial, news=session.first_rig.device.news)
            live.start()
            try:
                while not live.over and not attempt.broken:
                    live.pause(attempt.halted())
                    if not self._window.pump(live.newest):
                        attempt.broken = "the window was closed"
            finally:
                live.stop()
            if live.failure:
                raise live.failure
            return attempt.end(trial, live.lost)

    def close(self) -> None:
        """Closes the window."""
        if self._window is not None:
            self._window.close()
            self._window = None


class RunningAttempt:
    """One attempt at a trial of a study: its tables and measures, whoever plays it.

    Attributes:
        table: The 60 Hz table, made while the trial is played.
        broken: Why the attempt was broken off; empty while it was not.
    """

    def __init__(self, request: TrialRequest) -> None:
        self._request = request
        self.table = FrameTable()
        self.broken = ""

    def open(self, *views: ViewMaker) -> AbstractContextManager[Trial]:
        """The trial, ready for its first step.

        Args:
            views: Make further views.
        """

        def make_views(session: Session) -> list[View]:
            more = [view for make in views for view in make(session)]
            return [lambda snapshot: self._watch(session, snapshot), *more]

        request = self._request
        return open_trial(
            request.settings, request.makers, make_views, request.record, request.about
        )

    def halted(self) -> bool:
        """Hears the experimenter; True where time is to stand still."""
        self.broken = self.broken or self._request.watch()
        return self._request.paused() and not self.broken

    def stands_still(self) -> bool:
        """As `halted`, and waits a little where time stands still."""
        halted = self.halted()
        if halted:
            time.sleep(TICK)
        return halted

    def _watch(self, session: Session, snapshot: Snapshot) -> None:
        self.table.watch(session)
        self.table.show(snapshot)
        if session.time >= self._request.time_limit - 1e-9:
            session.scorer.abort(Status.TIMEOUT, "the study's time limit")

    def end(self, trial: Trial, lost: float, more: dict[str, Any] | None = None) -> PlayedAttempt:
        """Ends the recording.

        Args:
            trial: Was played.
            lost: s of real time given up.
            more: Further measures by name.
        """
        session = trial.session
        fields: dict[str, Any] = {
            "measures": {
                "first_contact_s": self.table.first_contact,
                "lost_s": round(lost, 6),
                **(more or {}),
            }
        }
        latency = session.first_rig.device.latency
        if latency is not None:
            told = latency.as_json()
            fields["latency"] = told
            waited = told.get("waited", {})
            fields["measures"] |= {
                f"latency_{p}_ms": waited.get(f"{p}_ms") for p in ("p50", "p95", "p99")
            }
        truths = [dict(rig.device.truth or {}) for rig in session.rigs]
        if any(truths):
            self.table.truths, self.table.truth_by = truths, "simulated user"
            names = ("fingers", "second_fingers")
            fields |= {k: sorted(t.items()) for k, t in zip(names, truths, strict=False)}
            fields["fingers_by"] = "simulated user"
        if self.broken:
            session.scorer.abort(Status.INPUT_ENDED, self.broken)
            fields["broken_off"] = self.broken
        return PlayedAttempt(trial.end(**fields), self.table, self.broken)
