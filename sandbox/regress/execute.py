"""Runs trials: one after another in this process, in several processes, or on a Ray cluster.

All ways give bit-identical results: every trial is built from its settings, and BLAS gets one
thread, so that a result does not depend on other trials or on the process. Ctrl-C and SIGTERM take
effect between two results, so that no result is lost.
"""

from __future__ import annotations

import multiprocessing
import signal
import threading
import traceback
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from tempfile import gettempdir
from types import FrameType
from typing import Any, Protocol

from models.errors import HandSandboxError, InputError
from sandbox.devices.device import Closeable
from sandbox.recording.versions import decisive_parts
from sandbox.regress.compared_measures import HandMeter
from sandbox.regress.run_plan import TrialJob, registered
from sandbox.trial.assembly import load_encoder
from sandbox.trial.driver import never, play_trial
from sandbox.trial.result import ResultRecord, record_fields
from tasks.guarded import build_scene, draw_task
from tasks.registry import find_task, is_built_in
from tasks.score import measure

Trial = dict[str, Any]
"""JSON of a trial: the fields of its result that `ResultRecord.REGRESS` names, its measures, and
its fingerprint with the fingerprint's parts."""

CRASHED = "crashed"
"""Status of a trial that has no result: its process died, or its code raised an error."""


Trials = Generator[Trial, None, None]
"""Generator of trials as they end; closing it stops the work."""

Stopped = Callable[[], bool]

STOPS_WITHIN = 0.1
"""Time (s) within which a request to stop takes effect, for trials in other processes."""


class Executor(Protocol):
    """Runs trials and yields each trial as it ends, in no particular order."""

    name: str

    def run(self, jobs: Sequence[TrialJob], stopped: Stopped = never) -> Trials:
        """Yields the trials; closing the generator stops the work.

        Args:
            jobs: The trials to run.
            stopped: Called often. Once it returns True, the generator ends, and trials that are
                still running are lost.

        Raises:
            HandSandboxError: The trials cannot be run at all.
        """
        ...


def run_job(job: TrialJob) -> Trial:
    """Runs one trial, from its settings to its result."""
    recording = job.recording
    if recording is not None:
        # A killed run may have left a partial recording.
        recording.unlink(missing_ok=True)
    with registered(job.own_task):
        meter = HandMeter()
        result = play_trial(
            job.settings,
            make_views=lambda session: [meter.see],
            record=recording,
            dump=Path(gettempdir()),
        )
    if recording is not None and result.success and not job.record_all:
        recording.unlink(missing_ok=True)
    return {
        **result.values_for(ResultRecord.REGRESS),
        "task": job.name,
        "measures": meter.values(result.respawned),
        "fingerprint": result.fingerprint,
        "depends_on": decisive_parts(result.versions or {}),
    }


def crashed(job: TrialJob, why: str) -> Trial:
    """A trial without a result, which counts as a failure."""
    names = (
        name for name in record_fields(ResultRecord.REGRESS) if name not in ("dump", "dump_error")
    )
    return {
        **dict.fromkeys(names),
        "task": job.name,
        "seed": job.seed,
        **dict.fromkeys(("success", "instant", "held", "final"), False),
        "status": CRASHED,
        "progress": 0.0,
        "reason": " ".join(why.split()),
        "state_hash": "",
        "measures": {},
        "fingerprint": "",
        "depends_on": {},
    }


def attempt(job: TrialJob) -> Trial | HandSandboxError:
    """Runs one trial. If its code fails, the trial is crashed; an error in its settings is
    returned."""
    try:
        return run_job(job)
    except HandSandboxError as error:
        return crashed(job, str(error)) if is_own_fault(error, job) else error
    except (Exception, SystemExit) as error:
        return crashed(job, _last_line(error))


def is_own_fault(error: HandSandboxError, job: TrialJob) -> bool:
    """True if an error came from the code of an external task that drew or measured a trial.

    Such code may fail for a single seed. A refusal by a built-in task follows from the settings,
    and holds for every trial.
    """
    codes = [frame.f_code for frame, _ in traceback.walk_tb(error.__traceback__)]
    if not any(call.__code__ in codes for call in (draw_task, build_scene, measure)):
        return False
    return not is_built_in(job.own_task or find_task(job.settings.task))


@dataclass
class Serial:
    """Runs trials one after another in this process, for debuggers and for a single core."""

    name: str = "serial"

    def run(self, jobs: Sequence[TrialJob], stopped: Stopped = never) -> Trials:
        """Yields the trials in order."""
        for job in jobs:
            if stopped():
                return
            yield _sound(attempt(job))


@dataclass
class _Worker:
    process: BaseProcess
    line: Connection
    job: TrialJob | None = None


class Processes:
    """Runs trials in a given number of processes, each with one trial at a time.

    If a process dies, its trial is reported as crashed, and another process replaces the dead one.
    The processes ignore Ctrl-C and SIGTERM, since this process handles these signals. The processes
    end when this process ends.
    """

    name = "processes"

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._context = multiprocessing.get_context("spawn")

    def run(self, jobs: Sequence[TrialJob], stopped: Stopped = never) -> Trials:
        """Yields the trials as they end."""
        for name in {job.settings.pipeline.encoder for job in jobs}:
            # Encoders that must be trained are trained once here, not in every process.
            load_encoder(name)
        waiting = list(reversed(jobs))
        workers = [self._start() for _ in range(min(self.workers, len(jobs)))]
        try:
            for worker in workers:
                _give(worker, waiting)
            while not stopped() and (busy := [w for w in workers if w.job is not None]):
                # The pipe of a process closes when the process ends, so that it is enough to wait
                # for pipes.
                ready = wait([w.line for w in busy], STOPS_WITHIN)
                for worker in [w for w in busy if w.line in ready]:
                    job = worker.job
                    assert job is not None
                    try:
                        trial = worker.line.recv()
                    except (EOFError, OSError):
                        worker.process.join()
                        workers.remove(worker)
                        worker.line.close()
                        if stopped():
                            # The signal that stops the run came before the worker could ignore it.
                            continue
                        trial = crashed(job, _death(worker.process.exitcode))
                        if waiting:
                            worker = self._start()
                            workers.append(worker)
                    worker.job = None
                    if worker in workers:
                        _give(worker, waiting)
                    yield _sound(trial)
        finally:
            for worker in workers:
                worker.line.close()
                worker.process.kill()
            for worker in workers:
                worker.process.join()

    def _start(self) -> _Worker:
        here, there = self._context.Pipe()
        process = self._context.Process(target=_work, args=(there,), daemon=True)
        process.start()
        # Now only the worker holds this end of the pipe. It closes when the worker ends in any way.
        there.close()
        return _Worker(process, here)


def _give(worker: _Worker, waiting: list[TrialJob]) -> None:
    if waiting:
        worker.job = waiting.pop()
        # A worker that is already dead is detected when this process waits for its answer.
        with suppress(ConnectionError):
            worker.line.send(worker.job)


def _work(line: Connection) -> None:
    """A worker's loop: a job, its result, and the next job, until the pipe is closed."""
    for number in SIGNALS:
        signal.signal(number, signal.SIG_IGN)
    # If the parent process is killed, the pipe breaks, and no result is needed any more.
    with suppress(EOFError, ConnectionError):
        while True:
            line.send(_answer(line))


def _answer(line: Connection) -> Trial | HandSandboxError:
    try:
        job = line.recv()
    except (EOFError, ConnectionError):
        raise
    except Exception as error:
        # A task's class is sent by name, so its module must be importable here.
        return InputError(
            "a worker cannot load its trial",
            got=_last_line(error),
            remedy="Run the trials serially, or put the task's module on the Python path",
        )
    return attempt(job)


def _sound(found: Trial | HandSandboxError) -> Trial:
    if isinstance(found, HandSandboxError):
        raise found
    return found


def _death(code: int | None) -> str:
    if code is not None and code < 0:
        with suppress(ValueError):
            return f"its process was ended by {signal.Signals(-code).name}"
    return f"its process ended with status {code}"


def _last_line(error: BaseException) -> str:
    place = traceback.extract_tb(error.__traceback__)[-1]
    return f"{type(error).__name__}: {error} ({place.filename}:{place.lineno})"


SIGNALS = (signal.SIGINT, signal.SIGTERM)
"""The signal of Ctrl-C, and the signal of CI systems and schedulers."""


class Interrupt(Closeable):
    """Handles SIGINT and SIGTERM in a `with` block.

    The first signal only sets a flag that executors check. A second signal raises
    `KeyboardInterrupt` while trials are running. Outside a program's main thread, and for ignored
    signals, it changes nothing.
    """

    def __init__(self) -> None:
        self._running = False
        self._signal: int | None = None
        self._before = {}
        if threading.current_thread() is threading.main_thread():
            before = {number: signal.getsignal(number) for number in SIGNALS}
            self._before = {n: how for n, how in before.items() if how is not signal.SIG_IGN}
        for number in self._before:
            signal.signal(number, self._receive)

    @property
    def requested(self) -> bool:
        """True once a signal has arrived."""
        return self._signal is not None

    @property
    def name(self) -> str:
        """Name of the first signal; empty before any signal."""
        return "" if self._signal is None else signal.Signals(self._signal).name

    @property
    def status(self) -> int:
        """Exit status of a program that the signal ended, as in shells: 130 or 143."""
        return 128 + (self._signal or signal.SIGINT)

    @contextmanager
    def while_running(self) -> Iterator[None]:
        """Context for running trials: a second signal interrupts only code in this context."""
        self._running = True
        try:
            yield
        finally:
            self._running = False

    def close(self) -> None:
        """Restores the earlier handlers of the signals."""
        for number, how in self._before.items():
            signal.signal(number, how)
        self._before = {}

    def _receive(self, number: int, frame: FrameType | None) -> None:
        if self.requested and self._running:
            raise KeyboardInterrupt
        self._signal = self._signal or number
