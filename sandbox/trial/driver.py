"""The driver of trials: builds a session, steps, shows and records it, ends it and closes it.

Headless runs, windows, pages, studies, replays, gymnasium and streams drive trials through `Trial`.
Their callers supply devices, views, pace, and the pauses of simulated time.

A live run has physics in a thread of its own, at real time; the caller's thread draws. Play and
studies, in a window and on pages, all run a trial by `LiveRun.play`. They differ only in the turn,
the function that the caller's thread repeats: a window draws a picture, a page's server handles
requests. `RealTime` waits for the wall clock. A trial that is behind real time slows down and
reports this; it never skips steps.
"""

from __future__ import annotations

import gc
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import msgspec
import numpy as np
from numpy.typing import NDArray
from threadpoolctl import threadpool_limits

from encoders.regression.encoder_registry import origin as encoder_origin
from models.errors import DivergenceError, RecordingError
from models.scene import CONTROL_PERIOD
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
from sandbox.trial.assembly import DeviceMakers, build, device_makers, digests
from sandbox.trial.result import SCHEMA, TrialResult
from sandbox.trial.settings import Settings, encoded

if TYPE_CHECKING:
    from sandbox.lsl import ForwardingRecorder, SessionListener
    from sandbox.server.page_server import PageServer
    from sandbox.server.protocol import Pause
    from sandbox.session.session import Rig


View = Callable[[Snapshot], None]
"""Receives every snapshot of a trial, in order."""

LISTENERS: list[SessionListener] = []
"""Listeners that receive all recorded trials, such as streams; see `sandbox.lsl.forwarding_to`."""

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
        views: Functions that receive every snapshot. Devices that take snapshots receive them too.
        trial_recorder: Records the session; None records nothing.

    Attributes:
        session: As given.
        newest: The latest snapshot; None before the first step. After a divergence it is the last
            valid snapshot, with the score that names the divergence.
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
        session.shown = bool(views)
        self._views = [
            *views,
            *(rig.device.show for rig in session.rigs if rig.device.takes_snapshots),
        ]

    def step(self) -> bool:
        """Runs one control period and shows it; False if the simulation diverged.

        A divergence raises no error: the session is over, its score names the reason, and the
        recording holds all inputs that led to it.

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
            # A person should not continue a trial that is not recorded.
            self._trial_recorder.check()
        return True

    def run(
        self,
        pace: RealTime | None = None,
        paused: Callable[[], bool] = never,
        stop: Callable[[], bool] = never,
    ) -> None:
        """Steps until the trial is over.

        Args:
            pace: Waits after every step; None runs as fast as possible.
            paused: Called before every step; returns True while simulated time stands still. It
                should block for a while, or until the pause is over, before it returns True.
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
        """Waits until the whole recording is on disk; nothing is recorded afterwards.

        Raises:
            RecordingError: A line could not be written; all earlier lines are safe.
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
    """Opens a trial that is ready for its first step; closes its devices and files afterwards.

    Args:
        settings: Settings of the run.
        makers: Functions that open the devices, one per hand; None opens the devices that the
            settings name.
        make_views: Makes the views.
        record: File of the recording; None writes no recording.
        about: Further entries of header and result, such as the trial of a study.
        dump: Folder for a dump if the simulation diverges and there is no recording; None writes
            no dump in this case. Next to a recording, a dump is always written.
        may_overlap: True if objects of a varied trial may overlap; see `build`.

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
    """Limits linear algebra to one thread, and disables Python's garbage collector, for a block.

    More threads gain nothing on matrices this small, and would wait for each other. A trial leaves
    no reference cycles, but makes thousands of objects. The collector would sometimes scan all
    imported objects, and delay a person's touch by milliseconds.
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
        The trial's result. After a divergence, its `dump` is the file with the last states, if one
        was written.
    """
    with open_trial(settings, makers, make_views, record, about, dump) as trial:
        trial.run()
        return trial.end()


class TrialRecorder:
    """Records one trial and makes its result.

    Args:
        header: Header of the recording (see `trial_header`).
        record: File of the recording; None writes no recording.
        dump: Folder for a dump if the simulation diverges and there is no recording; None writes
            no dump in this case. Next to a recording, a dump is always written.

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
        """Passes the recorded session to the listeners, once it is built."""
        if self._forwarding:
            self._forwarding.watch(session)

    def end(self, session: Session, **more: Any) -> TrialResult:
        """Writes the trial's end and returns the result.

        After a divergence, the result's `dump` is the file with the last states. If the file cannot
        be written, `dump` is empty and `dump_error` has the error.

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
        """Raises the error of a failed write; never waits.

        Raises:
            RecordingError: A line could not be written; all earlier lines are safe.
        """
        if self._writer:
            self._writer.check()

    def withdraw(self) -> None:
        """Removes the recording of a trial that never began, so that the same command can be
        repeated. The recording must be closed."""
        if self._record is not None:
            self._record.unlink(missing_ok=True)

    def close(self) -> None:
        """Waits until everything is on disk.

        Raises:
            RecordingError: A line could not be written; all earlier lines are safe.
        """
        if self._writer:
            self._writer.close()


DUMPED_STATES = 100
"""Number of control states in a dump: 1.6 s."""
MOST_DUMPS = 1000
"""Largest number of dumps of one trial in one folder."""


class DivergenceRecorder(RecordingLines):
    """Holds the lines of a session in memory for a dump, and passes them on to a recording.

    Args:
        header: Header of the recording.
        recording: Recording that is written during the trial; None writes only dumps.
    """

    def __init__(self, header: dict[str, Any], recording: RecordingWriter | None = None) -> None:
        super().__init__()
        self._header, self._recording = header, recording
        self._lines: list[Line | DeferredLine] = []
        # `_last` is a ring buffer of the last control states, one per row. `_states_seen` has step
        # and hash of all states.
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
    """Path of a dump: next to the recording if there is one, otherwise in the folder.

    None if there is neither a recording nor a folder.

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
    """A writer to a new file; a number is added to the file's name if the file exists."""
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


TICK = 0.02
"""Time (s) that `LiveRun.play` sleeps between two turns that draw no picture."""


class LiveRun:
    """Runs a trial in its own thread; a window or a page takes the newest snapshot.

    A frame of any device wakes the thread. The step that processes the frame is made at once, up to
    one control period ahead of the clock.

    Args:
        trial: A trial that is ready for its first step. Its views are called in its thread.
        pages: Servers of pages that show the trial. They get the reason of each pause, and the last
            snapshot.
        speed: Simulated seconds per second.

    Attributes:
        failure: The error that ended the thread early; None without one.
    """

    def __init__(self, trial: Trial, pages: Sequence[PageServer] = (), speed: float = 1.0) -> None:
        self._trial, self._pages = trial, tuple(pages)
        trial.session.shown = True
        self._pace = RealTime(speed, _shared_event(trial.session.rigs))
        self._stop = threading.Event()
        self._running = threading.Event()
        self._running.set()
        self._thread = threading.Thread(target=self._run, name="session", daemon=True)
        self.failure: BaseException | None = None

    def play(
        self,
        turn: Callable[[], Pause | None],
        end: Callable[[], None] | None = None,
        tick: float = TICK,
        lingers: bool = False,
    ) -> None:
        """Plays the trial until it is over, or until `turn` ends it.

        Args:
            turn: Called repeatedly in this thread, for the first time before the first step.
                Returns the reason why simulated time must stand still, an empty text if it may run,
                or None to end the run.
            end: Called once: as soon as the trial is over, or when the run ends earlier, by `turn`
                or by an exception.
            tick: Time (s) to sleep after a turn; 0 if a turn waits for the screen.
            lingers: True continues after the trial is over, with its last picture, until `turn`
                returns None.

        Raises:
            BaseException: The error that ended the trial's thread. The trial was not played to its
                end.
        """
        ending = [end] if end else []
        try:
            while not self.over or (lingers and not self.failure):
                pause = turn()
                if pause is None:
                    break
                self.pause(bool(pause))
                self.start()
                if pause:
                    self._publish(pause)
                if self.over and ending:
                    ending.pop()()
                time.sleep(tick)
        finally:
            self.stop()
            if ending:
                ending.pop()()
        self._publish()
        if self.failure:
            raise self.failure

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
        """Real time (s) given up so far because the machine was too slow."""
        return self._pace.lost

    def start(self) -> None:
        """Starts the thread; does nothing if it was started."""
        if self._thread.ident is None:
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

    def _publish(self, pause: Pause = "") -> None:
        """Sends the newest snapshot, and the reason of a pause, to the pages."""
        if self._pages:
            # At the beginning of a pause, the trial's thread may still be in a step.
            snapshot = self.newest if pause else None
            for page in self._pages:
                page.publish(snapshot or self._trial.session.snapshot(), pause)

    def _run(self) -> None:
        try:
            self._trial.run(self._pace, self._wait_while_paused, self._stop.is_set)
        except BaseException as error:  # no error may end a trial without a report
            self.failure = error

    def _wait_while_paused(self) -> bool:
        """Waits while the trial is paused; returns True if it was paused."""
        if self._running.is_set():
            return False
        self._running.wait()
        for rig in self._trial.session.rigs:
            if rig.device.latency is not None:
                rig.device.latency.resume()
        return True


def _shared_event(rigs: Sequence[Rig]) -> threading.Event | None:
    """Returns one event that all devices set when a frame arrives; None if no device has one."""
    devices = [
        device for rig in rigs for device in rig.device.within() if device.frame_ready is not None
    ]
    for device in devices:
        device.frame_ready = devices[0].frame_ready
    return devices[0].frame_ready if devices else None


LEEWAY = 0.10
"""Largest delay (s) behind real time that a session makes up for. With a larger delay the session
gives up the lost time: it runs slower than real time and reports this."""

ROOM = 0.004
"""Time (s) before an expected frame in which no step begins; a step takes 1 to 2 ms."""
JITTER = 0.001
"""Time (s) by which a frame may come earlier or later than expected."""


class RealTime:
    """Keeps simulated time equal to the wall clock, also after a pause or a change of speed.

    Args:
        speed: Simulated seconds per second.
        frame_ready: Event that is set when a frame arrives. While it is set, simulated time may run
            ahead of the clock by one control period, so that a touch between two steps need not
            wait. None always waits for the clock.

    Attributes:
        speed: As given; may be changed at any time, from any thread.
        lost: Real time (s) given up so far because the machine was too slow.
    """

    def __init__(self, speed: float = 1.0, frame_ready: threading.Event | None = None) -> None:
        self.speed, self.lost = speed, 0.0
        self._frame_ready = frame_ready
        self.begin(0.0)

    def begin(self, simulated: float) -> None:
        """Restarts the clock at a simulated time, s. The time of a pause is not made up."""
        self._speed = self.speed
        self._origin = time.monotonic() - simulated / self._speed
        self._heard = self._expected = float("-inf")

    def wait(self, simulated: float) -> None:
        """Returns when a simulated time, s, is due, or earlier when a frame has arrived."""
        if self._speed != self.speed:
            # The last step began at the old speed. The new speed applies from here on.
            self.begin(simulated)
            return
        due = self._origin + simulated / self._speed
        ahead, frame_ready = due - time.monotonic(), self._frame_ready
        if frame_ready is not None and ahead > 0:
            # Wakes up early enough for a frame that comes earlier than expected.
            early = CONTROL_PERIOD / self._speed + JITTER
            if ahead > early:
                time.sleep(ahead - early)
            if frame_ready.wait(max(clear_of(due, self._expected) - time.monotonic(), 0.0)):
                now = time.monotonic()
                # The next frame is expected after the same interval as this one.
                self._expected, self._heard = 2.0 * now - self._heard, now
        elif ahead > 0:
            time.sleep(ahead)
        elif ahead < -LEEWAY:
            self._origin -= ahead
            self.lost -= ahead


def clear_of(due: float, expected: float) -> float:
    """Time at which to begin a step if no frame has arrived, s, so that a frame need not wait.

    Touches come at a rate of their own. A few times a second, a step is due just before a touch,
    and the touch would have to wait for the whole step. Such a step is made earlier.

    Args:
        due: s, time at which the step is due.
        expected: s, time at which a frame is expected.
    """
    return due - ROOM if due - JITTER < expected < due + ROOM else due
