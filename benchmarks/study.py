"""Measures the cost of recording a study: per touch frame, per minute, and on opening a large one.

python -m benchmarks.study [--seconds 10]
"""

from __future__ import annotations

import argparse
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from benchmarks.machine import describe_machine
from sandbox.devices.simulated.simulated import SimulatedDevice
from sandbox.recording.recorded_device import RecordedDevice
from sandbox.recording.recording import load_recording, packed
from sandbox.session.session import Session
from sandbox.study.design.design import Design
from sandbox.study.design.design_file import load_design
from sandbox.study.design.session_plan import TrialStep
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import Journal, SyncThread
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.run.controls import Controls
from sandbox.study.run.forms import SimulatedForms
from sandbox.study.run.players import HeadlessPlayer, PlayedAttempt, TrialRequest
from sandbox.study.run.runner import SessionRunner
from sandbox.study.run.simulated_study import simulated_devices, simulated_person
from sandbox.study.tables.frame_table import FrameTable
from sandbox.study.tables.tables import make_tables
from sandbox.system.files import sync_file
from sandbox.trial.assembly import DeviceMaker, build
from sandbox.trial.driver import RealTime, TrialRecorder, trial_header, undisturbed
from sandbox.trial.replay import replay, settings_of
from sandbox.trial.settings import Settings
from tasks.user import UserConfiguration

DESIGN = Path(__file__).resolve().parent.parent / "examples" / "study" / "design.toml"
PEOPLE = 24
CASES = (
    ("at real time, by the clock", time.perf_counter, True),
    ("at real time, processor time", time.thread_time, True),
    ("without pauses, processor time", time.thread_time, False),
)
"""Name of each case, its clock, and whether the loop pauses until a control period is due. Times of
`perf_counter` also include other work of a busy machine."""


def main() -> None:
    """Prints all numbers."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--seconds", type=float, default=10.0, help="duration of touches per case")
    seconds = parser.parse_args().seconds
    print(describe_machine())
    with tempfile.TemporaryDirectory() as folder, undisturbed():
        logging(Path(folder), seconds)
        difference(Path(folder))
        replaying(Path(folder))
        journal(Path(folder))
        between(Path(folder))
        opening(Path(folder))


class Timed:
    """A recorder that measures the time for which the session's loop waits.

    Attributes:
        now: Time (s) since it was last set to 0.
    """

    def __init__(self, recorder: Any, clock: Callable[[], float]) -> None:
        self.now = 0.0
        self.input = self._timed(recorder.input, clock)
        self.state = self._timed(recorder.state, clock)
        self.event = self._timed(recorder.event, clock)

    def _timed(self, call: Callable[..., None], clock: Callable[[], float]) -> Callable[..., None]:
        def timed(*arguments: Any, **more: Any) -> None:
            began = clock()
            call(*arguments, **more)
            self.now += clock() - began

        return timed


def logging(folder: Path, seconds: float) -> None:
    """Measures the time of logging per touch frame, with one frame in every control period, and the
    bytes of recordings and tables."""
    # `random` touches all the time and never succeeds, so that the trial lasts `seconds`.
    settings = Settings(task="box-to-goal", seed=3)
    user = UserConfiguration(kind="random")
    costs: list[list[float]] = []
    writing: list[float] = []
    simulated = 0.0
    size = small = frames = 0
    packing: list[float] = []
    for seed, (_, clock, paced) in enumerate(CASES, start=3):
        costs.append([])
        record = folder / f"trial{seed}.jsonl"
        trial_recorder = TrialRecorder(trial_header(settings, {}), record)
        timed, table = Timed(trial_recorder.recorder, clock), FrameTable()
        session = build(settings, (_user_of(user, seed),), timed)
        table.watch(session)
        device: Any = session.rigs[0].device
        syncing = SyncThread(lambda path=record: sync_file(path))  # type: ignore[misc]
        pace = RealTime()
        while not session.over and session.time < seconds:
            timed.now = 0.0
            snapshot = session.advance()
            began = clock()
            table.show(snapshot)
            costs[-1].append(timed.now + clock() - began)
            device.show(snapshot)
            if paced:
                pace.wait(snapshot.time)
        syncing.close()
        simulated += session.time
        trial_recorder.end(session)
        trial_recorder.close()
        began = time.perf_counter()
        data = table.data()
        writing.append(time.perf_counter() - began)
        size += record.stat().st_size
        began = time.perf_counter()
        small += len(packed(record.read_bytes()))
        packing.append(time.perf_counter() - began)
        frames += len(data)
    to_rate = 60.0 / simulated / 1e6
    for (what, _, _), values in zip(CASES, costs, strict=True):
        p50, p99, most = 1e6 * np.percentile(values, [50, 99, 100])
        mean = 1e6 * np.mean(values)
        print(
            f"per touch frame, {what}: mean {mean:.0f}, median {p50:.0f}, "
            f"p99 {p99:.0f}, largest {most:.0f} microseconds ({len(values)} frames)"
        )
    print(
        f"recording: {size * to_rate:.2f} MB per minute, {small * to_rate:.2f} compressed, in "
        f"{1e3 * max(packing):.0f} ms at most; derived tables and measures: "
        f"{frames * to_rate:.2f} MB per minute, made in {1e3 * max(writing):.0f} ms at most "
        "between trials"
    )


def _user_of(user: UserConfiguration, seed: int) -> DeviceMaker:
    """Returns a function that opens the simulated user's device."""
    return lambda task, surface: SimulatedDevice(task, user, surface, seed)


def difference(folder: Path, rounds: int = 5) -> None:
    """Measures the processor time of the loop with and without logging, on the same touches."""
    record = max(folder.glob("trial*.jsonl"), key=lambda path: path.stat().st_size)
    recording = load_recording(record)
    settings = settings_of(recording)
    found: dict[bool, list[float]] = {False: [], True: []}
    for n in range(2 * rounds):
        logged = n % 2 == 1
        trial_recorder = TrialRecorder(trial_header(settings, {}), folder / f"again{n}.jsonl")
        table = FrameTable()
        session = build(
            settings,
            (lambda task, surface: RecordedDevice(recording),),
            trial_recorder.recorder if logged else None,
        )
        table.watch(session)
        began, steps = time.thread_time(), 0
        with undisturbed():
            while not session.over:
                snapshot = session.advance()
                steps += 1
                if logged:
                    table.show(snapshot)
        found[logged].append((time.thread_time() - began) / steps)
        trial_recorder.close()
    without, with_ = (1e6 * float(np.median(found[logged])) for logged in (False, True))
    print(
        f"a control period takes {without:.0f} microseconds of processor time without logging, "
        f"{with_:.0f} with it: {with_ - without:.0f} more "
        f"(medians of {rounds} runs each)"
    )


def replaying(folder: Path) -> None:
    """Measures how fast trials are replayed and compared, including loading and building."""
    user = UserConfiguration()
    for task in ("box-to-goal", "stack", "wrench-turn"):
        record = folder / f"{task}.jsonl"
        settings = Settings(task=task, seed=3)
        trial_recorder = TrialRecorder(trial_header(settings, {}), record)
        session = build(settings, (_user_of(user, 3),), trial_recorder.recorder)
        while not session.over:
            look(session)
        trial_recorder.end(session)
        trial_recorder.close()
        times = []
        for _ in range(3):
            began, worked = time.perf_counter(), time.process_time()
            again, found = replay(load_recording(record))
            times.append((time.perf_counter() - began, time.process_time() - worked))
            assert found.exact and found.complete
        took, worked = np.median(times, axis=0)
        print(
            f"{task}: {again.time:.1f} s of trial compared, {found.compared} states, in "
            f"{took:.2f} s by the clock and {worked:.2f} s of processor time: "
            f"{again.time / took:.1f} and {again.time / worked:.1f} times faster than it "
            "was"
        )


def look(session: Session) -> None:
    """Advances a simulated user's session by one control period."""
    snapshot = session.advance()
    device: Any = session.rigs[0].device
    device.show(snapshot)


def journal(folder: Path) -> None:
    """Measures the time of a journal record, with and without waiting for the disk."""
    book = Journal(folder / "session.jsonl")
    for durable in (False, True):
        costs = []
        for i in range(300):
            began = time.perf_counter()
            book.append("command", durable, command="note", text=f"note {i}", trial=i)
            costs.append(time.perf_counter() - began)
        p50, p99 = 1e6 * np.percentile(costs, [50, 99])
        what = "on the disk" if durable else "written"
        print(f"journal record, {what}: median {p50:.0f}, p99 {p99:.0f} microseconds")
    book.close()


class Waiting(HeadlessPlayer):
    """A player that measures the time from the end of a trial until the next may begin.

    Attributes:
        waited: This time (s) for each trial, as wall time and processor time.
    """

    waited: ClassVar[list[tuple[float, float]]] = []
    _since: tuple[float, float] | None = None

    def play(self, request: TrialRequest) -> PlayedAttempt:
        if self._since is not None:
            now = time.perf_counter(), time.thread_time()
            self.waited.append((now[0] - self._since[0], now[1] - self._since[1]))
        played = super().play(request)
        self._since = time.perf_counter(), time.thread_time()
        return played


def between(folder: Path, trials: int = 12) -> None:
    """Measures the time between two trials of a session, without the time of a page."""
    study = StudyFolder(folder / "between", load_design(DESIGN), SIMULATED)
    person, controls = study.add(**simulated_person(study.design, 1)), Controls()

    def say(line: str) -> None:
        if len(Waiting.waited) >= trials:
            controls.type("q")

    with SessionFolder(study, person) as session:
        devices = simulated_devices(person)
        SessionRunner(
            session, Waiting(), devices, SimulatedForms(1), controls, say, makes_tables=False
        ).run()
    wall, worked = 1e3 * np.array(Waiting.waited).T
    print(
        f"between two trials: median {np.median(wall):.0f} ms, largest {wall.max():.0f} ms by the "
        f"clock, {np.median(worked):.0f} and {worked.max():.0f} ms of processor time "
        f"({len(wall)} times)"
    )


def opening(folder: Path) -> None:
    """Measures the time of opening a finished study of 24 people and making all its tables."""
    design = load_design(DESIGN)
    study = fill(folder, design)
    began = time.perf_counter()
    design = load_design(DESIGN)
    loaded = time.perf_counter()
    study = StudyFolder(folder, design, SIMULATED)
    # Tables that exist are not written again. The worst case is that all have to be written.
    for name in ("trials.csv", "participants.csv", "answers.csv", "codebook.csv"):
        (study.path / "tables" / name).unlink(missing_ok=True)
    found = make_tables(study)
    ended = time.perf_counter()
    print(
        f"opening a study of {found['participants']} people and {found['trials']} trials that "
        f"count: {ended - began:.2f} s, of which the design {loaded - began:.2f} s"
    )


def fill(folder: Path, design: Design) -> StudyFolder:
    """Makes a finished study with all its records, without recordings."""
    study = StudyFolder(folder, design, SIMULATED)
    result = {
        "task": "box-to-goal",
        "task_version": 1,
        "seed": 1,
        "success": True,
        "instant": True,
        "held": True,
        "final": True,
        "status": "held",
        "progress": 1.0,
        "reason": "",
        "time_s": 4.56,
        "diverged": "",
        "respawned": 0,
        "state_hash": "0" * 32,
        "encoder": "population",
        "digests": {"encoder": "0" * 32, "labels": "0" * 32},
        "measures": {"first_contact_s": 0.3, "lost_s": 0.0},
    }
    for number in range(1, PEOPLE + 1):
        person = study.add(**simulated_person(design, number))
        with SessionFolder(study, person) as session:
            for step in session.steps:
                if not isinstance(step, TrialStep):
                    session.write("done", step=step.id)
                    continue
                file = session.begin(step)
                session.write(
                    "trial_end",
                    step=step.id,
                    trial=step.number,
                    attempt=1,
                    file=f"trials/{file.name}",
                    result=result,
                )
            session.write("end", complete=True)
    return study


if __name__ == "__main__":
    main()
