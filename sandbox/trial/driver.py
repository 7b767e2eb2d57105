"""The driver of trials: builds a session, steps, shows and records it, ends it and closes it.

Headless runs, windows, pages, studies, replays, gymnasium and streams drive trials through `Trial`.
They supply devices, views, pace, and the pauses of simulated time.
"""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from threadpoolctl import threadpool_limits

from encoders.regression.registry import origin as encoder_origin
from models.errors import DivergenceError
from sandbox.recording.recorded_task import task_origin
from sandbox.recording.states import STATES
from sandbox.recording.versions import versions
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import build, digests
from sandbox.trial.device_makers import DeviceMakers
from sandbox.trial.open_devices import device_makers
from sandbox.trial.result import TrialResult
from sandbox.trial.settings import Settings, encoded
from sandbox.trial.trial_recorder import TrialRecorder

if TYPE_CHECKING:
    from sandbox.trial.pacing import Pace

View = Callable[[Snapshot], None]
"""Receives every snapshot of a trial, in order."""

ViewMaker = Callable[[Session], Sequence[View]]
"""Makes the views of a session before its first step."""


def no_views(session: Session) -> Sequence[View]:
    """A `ViewMaker` that makes no views."""
    return ()


def never() -> bool:
    """Returns False."""
    return False


class Trial:
    """One trial while it is played.

    Args:
        session: A session that is ready for its first step.
        views: Functions that receive every snapshot. Devices that need the scene receive it too.
        trial_recorder: Records the session; None records nothing.

    Attributes:
        session: As given.
        newest: The latest snapshot; None before the first step. After a divergence it is the last
            valid one, with the score that names the divergence.
    """

    def __init__(
        self,
        session: Session,
        views: Sequence[View] = (),
        trial_recorder: TrialRecorder | None = None,
    ) -> None:
        self.session = session
        self.newest: Snapshot | None = None
        self._trial_recorder = trial_recorder
        self._views = [
            *views,
            *(rig.device.show for rig in session.rigs if rig.device.wants_snapshots),
        ]

    def step(self) -> bool:
        """Runs one control period and shows it; False if the simulation diverged.

        A divergence raises no error: the session is over, its score says why, and the recording
        holds everything that led to it.

        Raises:
            RecordingError: The recording can no longer be written.
        """
        try:
            snapshot = self.session.advance()
        except DivergenceError:
            if self.newest is not None:
                self.newest = replace(self.newest, score=self.session.scorer.score)
            return False
        self.newest = snapshot
        for view in self._views:
            view(snapshot)
        if self._trial_recorder:
            # Nobody should play on for what is not kept.
            self._trial_recorder.check()
        return True

    def run(
        self,
        pace: Pace | None = None,
        paused: Callable[[], bool] = never,
        stop: Callable[[], bool] = never,
    ) -> None:
        """Steps until the trial is over.

        Args:
            pace: Waits after every step; None runs as fast as possible.
            paused: Called before every step; True while simulated time stands still. It should
                block for a while, or until the pause is over, before it returns True.
            stop: Called before every step; True ends the run before the trial is over.
        """
        if pace:
            pace.begin(self.session.time)
        while not (self.session.over or stop()):
            if paused():
                if pace:
                    pace.begin(self.session.time)
                continue
            if not self.step():
                break
            if pace:
                pace.wait(self.session.time)

    def end(self, **more: Any) -> TrialResult:
        """Ends the recording and returns the result.

        Args:
            more: Further fields of the result by name, JSON values.
        """
        assert self._trial_recorder is not None, "a trial without a recorder has no result"
        return self._trial_recorder.end(self.session, **more)

    def settle(self) -> None:
        """Waits until the recording is on disk, end included; nothing is recorded afterwards.

        Raises:
            RecordingError: Something could not be written; what came before it is safe.
        """
        if self._trial_recorder is not None:
            self._trial_recorder.close()


@contextmanager
def open_trial(
    settings: Settings,
    makers: DeviceMakers | None = None,
    make_views: ViewMaker = no_views,
    record: Path | None = None,
    about: dict[str, Any] | None = None,
    dump: Path | None = None,
    may_overlap: bool = False,
) -> Iterator[Trial]:
    """A trial that is ready for its first step; its devices and files are closed afterwards.

    Args:
        settings: Settings of the run.
        makers: Functions that open the devices, one per hand; None opens those of the settings.
        make_views: Makes the views.
        record: File of the recording; None writes none.
        about: Further entries of header and result, such as the trial of a study.
        dump: Folder for the last states of a diverging simulation without a recording; beside a
            recording they are always written.
        may_overlap: Things of a varied trial may overlap; see `build`.

    Raises:
        InputError: The task does not fit on the surface, a device cannot be opened, or the
            recording exists or cannot be written.
    """
    trial_recorder = TrialRecorder(trial_header(settings, about), record, dump)
    begun = False
    try:
        with undisturbed():
            opened = device_makers(settings) if makers is None else makers
            session = build(settings, opened, trial_recorder.recorder, may_overlap=may_overlap)
            try:
                trial = Trial(session, make_views(session), trial_recorder)
                begun = True
                yield trial
            finally:
                session.close()
    finally:
        trial_recorder.close()
        if not begun:
            trial_recorder.withdraw()


@contextmanager
def undisturbed() -> Iterator[None]:
    """Limits linear algebra to one thread and switches Python's garbage collector off meanwhile.

    More threads gain nothing on matrices this small, and would wait for each other. A trial leaves
    no reference cycles, but makes thousands of objects, so that the collector would run now and
    then over all imported objects, for milliseconds in which a person's touch would wait.
    """
    was = gc.isenabled()
    gc.disable()
    try:
        with threadpool_limits(1):
            yield
    finally:
        if was:
            gc.enable()


def trial_header(settings: Settings, about: dict[str, Any] | None = None) -> dict[str, Any]:
    """The header of a recording: everything needed to run the trial again."""
    task_from = task_origin(settings.task, settings.seed, settings.surface.rectangle)
    encoder_from = encoder_origin(settings.pipeline.encoder)
    return {
        "states": STATES,
        "settings": encoded(settings),
        "digests": digests(settings),
        "versions": versions(),
        **({"task_from": task_from} if task_from else {}),
        **({"encoder_from": encoder_from} if encoder_from else {}),
        **(about or {}),
    }
