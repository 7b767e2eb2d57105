"""Who plays a trial: headless as fast as it goes or at real time, or a person before a window."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

from threadpoolctl import threadpool_limits

from models.errors import DivergenceError
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.study.tables.frames import FrameTable
from sandbox.trial.assembly import build
from sandbox.trial.device_makers import DeviceMakers
from sandbox.trial.headless import no_search_for_garbage, trial_header
from sandbox.trial.keeping import Keeping
from sandbox.trial.live import LiveSession
from sandbox.trial.pacing import RealTime
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import RunSettings
from tasks.score import Status

TICK = 0.02
"""s between two looks at what the experimenter wants while time stands still."""

Watch = Callable[[], str]
"""Lets the experimenter be heard: empty to go on, else why the attempt is broken off."""


@dataclass(frozen=True)
class Ask:
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
class Played:
    """How it went: the result, the tables, and why it was broken off (empty: it was not)."""

    result: TrialResult
    table: FrameTable
    broken: str = ""


class Player(Protocol):
    """Plays trials."""

    def play(self, ask: Ask) -> Played:
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

    def play(self, ask: Ask) -> Played:
        keeping = Keeping(trial_header(ask.settings, ask.about), ask.record)
        trial = Trial(ask)
        try:
            session = build(ask.settings, ask.makers, keeping.recorder)
            try:
                clock = RealTime()
                with threadpool_limits(1), no_search_for_garbage():
                    while not session.over and not trial.broken:
                        if trial.halted():
                            clock = RealTime(1.0, session.time)
                            time.sleep(TICK)
                            continue
                        try:
                            snapshot = session.advance()
                        except DivergenceError:
                            # The trial is marked, and its recording holds how.
                            break
                        trial.step(session, snapshot)
                        if self.paced:
                            clock.wait(snapshot.time)
                return trial.end(session, keeping, clock.lost if self.paced else 0.0)
            finally:
                session.close()
        finally:
            keeping.close()

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

    def play(self, ask: Ask) -> Played:
        from sandbox.views.window.window import Window

        keeping = Keeping(trial_header(ask.settings, ask.about), ask.record)
        trial = Trial(ask)
        try:
            session = build(ask.settings, ask.makers, keeping.recorder)
            self.close()
            self._window = Window(session.scene, session.whole_surface, title=session.task.name,
                                  caption=self.caption,
                                  in_air=ask.settings.in_air)  # fmt: skip
            device = session.rigs[0].device
            self._window.attach(device)
            live = LiveSession(
                session, lambda snapshot: trial.step(session, snapshot), news=device.news
            )
            live.start()
            try:
                with no_search_for_garbage():
                    while not live.over and not trial.broken:
                        live.pause(trial.halted())
                        if not self._window.pump(live.newest):
                            trial.broken = "the window was closed"
            finally:
                live.stop()
                session.close()
            if live.failure:
                raise live.failure
            return trial.end(session, keeping, live.lost)
        finally:
            keeping.close()

    def close(self) -> None:
        """Closes the window."""
        if self._window is not None:
            self._window.close()
            self._window = None


class Trial:
    """What all players do at every step, and at the end."""

    def __init__(self, ask: Ask) -> None:
        self._ask = ask
        self.table = FrameTable()
        self.broken = ""

    def halted(self) -> bool:
        """Hears the experimenter; whether time is to stand still."""
        self.broken = self.broken or self._ask.watch()
        return self._ask.paused() and not self.broken

    def step(self, session: Session, snapshot: Snapshot) -> None:
        """After every control period."""
        self.table.watch(session)
        self.table.show(snapshot)
        session.rigs[0].device.show(snapshot)
        if session.time >= self._ask.time_limit - 1e-9:
            session.scorer.abort(Status.TIMEOUT, "the study's time limit")

    def end(
        self, session: Session, keeping: Keeping, lost: float, more: dict[str, Any] | None = None
    ) -> Played:
        """Ends the recording; `more` goes to the measures."""
        found: dict[str, Any] = {
            "measures": {"first_contact_s": self.table.first_contact, "lost_s": round(lost, 6),
                         **(more or {})}
        }  # fmt: skip
        latency = session.rigs[0].device.latency
        if latency is not None:
            told = latency.as_json()
            found["latency"] = told
            waited = told.get("waited", {})
            found["measures"] |= {f"latency_{p}_ms": waited.get(f"{p}_ms") for p in
                                  ("p50", "p95", "p99")}  # fmt: skip
        truth = session.rigs[0].device.truth
        if truth:
            self.table.truth, self.table.truth_by = dict(truth), "simulated user"
            found |= {"fingers": sorted(truth.items()), "fingers_by": "simulated user"}
        if self.broken:
            session.scorer.abort(Status.INPUT_ENDED, self.broken)
            found["broken_off"] = self.broken
        result = keeping.end(session, **found)
        return Played(result, self.table, self.broken)
