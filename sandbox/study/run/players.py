"""Players, which run single trials: headless, or in a window."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

from sandbox.session.messages import Snapshot
from sandbox.session.own_layouts import learned_layouts
from sandbox.session.session import Session
from sandbox.study.measures.measures import SIMULATED_USER
from sandbox.study.tables.frame_table import FrameTable
from sandbox.trial.assembly import DeviceMakers
from sandbox.trial.driver import TICK, LiveRun, RealTime, Trial, View, ViewMaker, open_trial
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings
from tasks.score import Status

if TYPE_CHECKING:
    from sandbox.server.protocol import Pause

Watch = Callable[[], str]
"""Executes the experimenter's commands; returns the reason to break off the attempt, or empty."""


@dataclass(frozen=True)
class TrialRequest:
    """A trial to be run.

    Attributes:
        settings: Settings of the trial.
        makers: Functions that open the devices, one for every hand.
        record: Path of the recording.
        about: Further fields of the recording's header.
        time_limit: Time limit of the study, s.
        watch: See `Watch`.
        paused: Returns True while simulated time must stop.
        learns: Names of the hands whose new layouts of five fingers the next trial uses.
        first: True for the first trial of its task in the session.
    """

    settings: Settings
    makers: DeviceMakers
    record: Path
    about: dict[str, Any]
    time_limit: float
    watch: Watch
    paused: Callable[[], bool]
    learns: tuple[str, ...] = ()
    first: bool = False


@dataclass
class PlayedAttempt:
    """A finished attempt.

    Attributes:
        result: The result.
        table: The frames.
        broken: Reason why the attempt was broken off; empty if it was not.
    """

    result: TrialResult
    table: FrameTable
    broken: str = ""


class TrialPlayer(Protocol):
    """Interface of classes that run trials."""

    def play(self, request: TrialRequest) -> PlayedAttempt:
        """Runs a trial to its end, and closes its recording.

        Raises:
            InputError: A device failed, or the recording cannot be written.
        """
        ...

    def close(self) -> None:
        """Releases resources that stay open between trials."""
        ...


@dataclass
class HeadlessPlayer:
    """Runs trials without a window.

    Attributes:
        paced: True runs in real time, as for a person; False runs as fast as possible.
    """

    paced: bool = False

    def play(self, request: TrialRequest) -> PlayedAttempt:
        attempt = RunningAttempt(request)
        pace = RealTime() if self.paced else None
        with attempt.open() as trial:
            trial.run(pace, attempt.wait_if_paused, lambda: bool(attempt.broken))
            return attempt.end(trial, pace.lost if pace else 0.0)

    def close(self) -> None:
        """Does nothing."""


@dataclass
class WindowPlayer:
    """Runs trials in a window, in real time.

    The window has no keys to restart or pause, since only the experimenter may do this.

    Attributes:
        caption: Text that is shown if a simulated user plays.
    """

    caption: str = ""
    _window: Any = field(default=None, repr=False)

    def play(self, request: TrialRequest) -> PlayedAttempt:
        from sandbox.views.window import Window

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
            live = LiveRun(trial)

            def turn() -> Pause | None:
                paused = attempt.check_pause()
                if not self._window.pump(live.newest):
                    attempt.broken = "the window was closed"
                if attempt.broken:
                    return None
                return "menu" if paused else ""

            live.play(turn, tick=0.0)
            return attempt.end(trial, live.lost)

    def close(self) -> None:
        """Closes the window."""
        if self._window is not None:
            self._window.close()
            self._window = None


class RunningAttempt:
    """A running attempt at a trial: collects its frames, for every kind of player.

    Attributes:
        table: The frames so far.
        broken: Reason why the attempt was broken off; empty otherwise.
        demonstrated: True if the participant's page showed a demonstration, False if none was
            available in time; None if the trial should not have one.
    """

    def __init__(self, request: TrialRequest) -> None:
        self._request = request
        self.table = FrameTable()
        self.broken = ""
        self.demonstrated: bool | None = None

    def open(self, *views: ViewMaker) -> AbstractContextManager[Trial]:
        """Opens the trial, ready for its first step.

        Args:
            views: Functions that create further views.
        """

        def make_views(session: Session) -> list[View]:
            more = [view for make in views for view in make(session)]
            return [lambda snapshot: self._watch(session, snapshot), *more]

        request = self._request
        # Overlapping objects are accepted here, since a participant is waiting. `study check` has
        # already drawn trials of the design with several seeds.
        return open_trial(
            request.settings,
            request.makers,
            make_views,
            request.record,
            request.about,
            may_overlap=True,
        )

    def check_pause(self) -> bool:
        """Executes the experimenter's commands; returns True if simulated time must stop."""
        self.broken = self.broken or self._request.watch()
        return self._request.paused() and not self.broken

    def wait_if_paused(self) -> bool:
        """Same as `check_pause`, but also waits for `TICK` if simulated time must stop."""
        paused = self.check_pause()
        if paused:
            time.sleep(TICK)
        return paused

    def _watch(self, session: Session, snapshot: Snapshot) -> None:
        self.table.watch(session)
        self.table.show(snapshot)
        if session.time >= self._request.time_limit - 1e-9:
            session.scorer.abort(Status.TIMEOUT, "the study's time limit")

    def end(self, trial: Trial, lost: float, more: dict[str, Any] | None = None) -> PlayedAttempt:
        """Ends the recording.

        Args:
            trial: The trial that was run.
            lost: Real time that the simulation fell behind, s.
            more: Further measures by name.
        """
        session = trial.session
        settings = self._request.settings
        width, height = settings.surface.size_in
        fields: dict[str, Any] = {
            "measures": {
                "device": settings.device.name,
                "surface_in": None if settings.in_air else f"{width:g}x{height:g}",
                "screen_measured": None if settings.in_air else settings.surface.calibrated,
                "first_contact_s": self.table.first_contact,
                "lost_s": round(lost, 6),
                **(more or {}),
            },
            "demonstrated": self.demonstrated,
        }
        learned = learned_layouts(session)
        if kept := {name: learned[name] for name in self._request.learns if name in learned}:
            fields["learned"] = kept
        latency = session.first_rig.device.latency
        if latency is not None:
            latencies = latency.as_json()
            fields["latency"] = latencies
            waited = latencies.get("waited", {})
            fields["measures"] |= {
                f"latency_{p}_ms": waited.get(f"{p}_ms") for p in ("p50", "p95", "p99")
            }
        truths = [dict(rig.device.true_labels or {}) for rig in session.rigs]
        if any(truths):
            self.table.truths = truths
            names = ("fingers", "second_fingers")
            fields |= {k: sorted(t.items()) for k, t in zip(names, truths, strict=False)}
            fields["fingers_by"] = SIMULATED_USER
        if self.broken:
            session.scorer.abort(Status.INPUT_ENDED, self.broken)
            fields["broken_off"] = self.broken
        return PlayedAttempt(trial.end(**fields), self.table, self.broken)
