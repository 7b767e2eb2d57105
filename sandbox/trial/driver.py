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

import msgspec
import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from encoders.regression.registry import origin as encoder_origin
from models.errors import DivergenceError, RecordingError
from sandbox.recording.recorded_task import task_origin
from sandbox.recording.recording import (
    DeferredLine,
    Line,
    RecordingLines,
    RecordingWriter,
    end_line,
    keyframe_line,
)
from sandbox.recording.versions import STATES, versions
from sandbox.session.messages import Snapshot
from sandbox.session.session import Recorder, Session
from sandbox.trial.assembly import build, digests
from sandbox.trial.open_devices import DeviceMakers, device_makers
from sandbox.trial.result import SCHEMA, TrialResult
from sandbox.trial.settings import Settings, encoded

if TYPE_CHECKING:
    from sandbox.lsl import ForwardingRecorder, SessionListener
    from sandbox.trial.live_run import Pace

View = Callable[[Snapshot], None]
"""Receives every snapshot of a trial, in order."""

LISTENERS: list[SessionListener] = []
"""Receivers of all recorded trials, such as streams; see `sandbox.lsl.forwarding_to`."""

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
                trial_recorder.watch(session)
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


def play_trial(
    settings: Settings,
    makers: DeviceMakers | None = None,
    make_views: ViewMaker = no_views,
    record: Path | None = None,
    about: dict[str, Any] | None = None,
    dump: Path | None = None,
) -> TrialResult:
    """Plays a trial to its end.

    Args:
        settings, makers, make_views, record, about, dump: See `open_trial`.

    Returns:
        The trial's result; after a divergence, its `dump` is the file with the last states.
    """
    with open_trial(settings, makers, make_views, record, about, dump) as trial:
        trial.run()
        return trial.end()


class TrialRecorder:
    """Records one trial and makes its result.

    Args:
        header: Header of the recording (see `sandbox.trial.driver.trial_header`).
        record: File of the recording; None writes none.
        dump: Folder for the last states of a diverging simulation; beside a recording they are
            always written.

    Attributes:
        recorder: The recorder that the session needs.

    Raises:
        RecordingError: The recording's file exists or cannot be made.
    """

    def __init__(
        self, header: dict[str, Any], record: Path | None = None, dump: Path | None = None
    ) -> None:
        self._header, self._record, self._dump = header, record, dump
        self._writer = RecordingWriter(record, header) if record else None
        self._box = DivergenceRecorder(header, self._writer)
        self._forwarding: ForwardingRecorder | None = None
        if LISTENERS:
            from sandbox.lsl import ForwardingRecorder

            self._forwarding = ForwardingRecorder(self._box, tuple(LISTENERS), header)
        self.recorder: Recorder = self._forwarding or self._box

    def watch(self, session: Session) -> None:
        """Gives the session that is recorded to the listeners, once it is built."""
        if self._forwarding:
            self._forwarding.watch(session)

    def end(self, session: Session, **more: Any) -> TrialResult:
        """Writes the trial's end and returns the result.

        After a divergence `dump` of the result is the file with the last states. If that file
        cannot be written, `dump` is empty and `dump_error` says why.

        Args:
            session: The session at its end.
            more: Further fields of the result by name, JSON values.
        """
        encoder = self._header["settings"]["pipeline"]["encoder"]
        fields = {"encoder": encoder, **self._header, **more, "schema": SCHEMA}
        result = TrialResult.of(session, fields)
        path = dump_path(self._dump, self._record, session.task.name, session.task.seed)
        if session.diverged and path is not None:
            try:
                dump = str(self._box.dump(path, session.step, result.as_json()))
                result = msgspec.structs.replace(result, dump=dump)
            except RecordingError as error:
                result = msgspec.structs.replace(result, dump="", dump_error=str(error))
        if self._forwarding:
            self._forwarding.end(result.as_json())
        self._box.end(session.step, result.as_json())
        return result

    def check(self) -> None:
        """Does nothing while all could be written so far; never waits.

        Raises:
            RecordingError: Something could not be written; what came before it is safe.
        """
        if self._writer:
            self._writer.check()

    def withdraw(self) -> None:
        """Removes the recording of a trial that never began, once it is closed: the same command
        may be given again."""
        if self._record is not None:
            self._record.unlink(missing_ok=True)

    def close(self) -> None:
        """Waits until everything is on disk.

        Raises:
            RecordingError: Something could not be written; what came before it is safe.
        """
        if self._writer:
            self._writer.close()


DUMPED_STATES = 100
"""Number of control states in a dump: 1.6 s."""
MOST_DUMPS = 1000
"""Largest number of dumps of one trial in one folder."""


class DivergenceRecorder(RecordingLines):
    """Keeps a session in memory for a dump, and passes everything on to a recording, if any.

    Args:
        header: Header of the recording.
        recording: Recording that is written during the trial; None writes only dumps.
    """

    def __init__(self, header: dict[str, Any], recording: RecordingWriter | None = None) -> None:
        super().__init__()
        self._header, self._recording = header, recording
        self._lines: list[Line | DeferredLine] = []
        # Ring buffer of the last control states, one per row; step and hash of all states.
        self._last = np.empty((0, 0))
        self._states_seen: list[tuple[int, str]] = []

    def state(
        self,
        step: int,
        state: NDArray[np.float64],
        state_hash: str,
        qpos: NDArray[np.float64],
        solid: Sequence[frozenset[int]],
    ) -> None:
        """Keeps the state at the beginning of a control period."""
        super().state(step, state, state_hash, qpos, solid)
        if not self._states_seen:
            self._last = np.empty((DUMPED_STATES, len(state)))
        self._last[len(self._states_seen) % DUMPED_STATES] = state
        self._states_seen.append((step, state_hash))

    def dump(self, path: Path, step: int, result: dict[str, Any]) -> Path:
        """Writes the dump of a divergence.

        Args:
            path: File of the dump; if it exists, a number is added to the name.
            step: Physics step at which the trial ended.
            result: Result of the trial, JSON values.

        Returns:
            The file that was written.

        Raises:
            RecordingError: The file cannot be written completely.
        """
        self._put_track()
        last = list(enumerate(self._states_seen))[-DUMPED_STATES:]
        writer = _new_dump(path, {**self._header, "dump": {"states": len(last)}})
        dense = {s for _, (s, _) in last}
        # All inputs come first, then the last states.
        for kept in self._lines:
            line = kept.line() if isinstance(kept, DeferredLine) else kept
            if not (line["kind"] == "keyframe" and line["step"] in dense) and line["kind"] != "end":
                writer.put(line)
        for i, (s, state_hash) in last:
            writer.put(keyframe_line(s, self._last[i % DUMPED_STATES], state_hash))
        writer.put(end_line(step, result))
        path = writer.path
        writer.close()
        return path

    def _put(self, line: Line | DeferredLine) -> None:
        self._lines.append(line)
        if self._recording:
            self._recording.put(line)


def dump_path(folder: Path | None, record: Path | None, task: str, seed: int) -> Path | None:
    """Path of a dump: beside the recording, else in the folder; None without either.

    Args:
        folder: Folder for dumps.
        record: File of the trial's recording.
        task: Name of the task.
        seed: Seed of the trial.
    """
    if record is not None:
        return record.with_stem(f"{record.stem}-diverged")
    return None if folder is None else folder / f"diverged-{task}-{seed}.jsonl"


def _new_dump(path: Path, header: dict[str, Any]) -> RecordingWriter:
    """A writer to a new file of this name, with a number added if it exists."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise RecordingError(
            "the folder cannot be made", where=str(path.parent), got=error.strerror
        ) from None
    numbered = path
    for number in range(2, MOST_DUMPS):
        try:
            return RecordingWriter(numbered, header)
        except RecordingError:
            if not numbered.exists():
                raise
        numbered = path.with_stem(f"{path.stem}-{number}")
    return RecordingWriter(numbered, header)
