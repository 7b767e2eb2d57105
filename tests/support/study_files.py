"""Helpers for tests of user studies: a small design, a study in a folder, and children to kill."""

from __future__ import annotations

import csv
import os
import signal
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from sandbox.study.design.design import Design
from sandbox.study.design.design_file import parse_design
from sandbox.study.design.session_plan import session_plan, trials_of
from sandbox.study.record.folder import SIMULATED, Participant, StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.record.trial_files import finished_result
from sandbox.study.run.controls import Controls
from sandbox.study.run.forms import Forms, SimulatedForms
from sandbox.study.run.players import HeadlessPlayer
from sandbox.study.run.runner import OpenDevices, SessionOutcome, SessionRunner
from sandbox.study.run.simulated_study import simulated_devices
from sandbox.study.tables.trial_table import trial_rows
from sandbox.trial.result import TrialResult
from tasks.score import Status
from tests.support.needs import require

DESIGN = """
name = "quick"
seed = 3
participants = 2
[settings]
task = "tests/support/regress_tasks.py:Quick"
encoder = "linear"
[[factors]]
name = "contact"
order = "latin"
levels = ["hard", "soft"]
[trials]
repetitions = 2
practice = 1
practice_each = "contact"
[consent]
text = "Do you agree?"
[[demographics]]
name = "age"
kind = "number"
low = 18
ask = "How old are you?"
[[questionnaires]]
name = "effort"
at = "contact"
title = "About what you have just done"
[[questionnaires.items]]
name = "effort"
kind = "scale"
step = 5
ask = "How much effort was it?"
"""
SHORT = DESIGN.replace(
    'repetitions = 2\npractice = 1\npractice_each = "contact"\n', "practice = 0\n"
)
"""The same design with two trials, each with a form after it."""

SOUND = (
    DESIGN.replace("participants = 2", "participants = 24")
    .replace("Do you agree?", "Your touches are recorded. You may stop at any time. Do you agree?")
    .replace("step = 5\n", 'step = 5\nlow_means = "none"\nhigh_means = "very much"\n')
)
"""The same design, without anything that misleads: enough people, who are told what they need."""

PAIRS = """
name = "pairs"
seed = 3
participants = 1
[settings]
task = "carry-together"
encoder = "linear"
[[factors]]
name = "contact"
order = "blocked"
levels = ["hard"]
[trials]
time_limit_s = 4.0
"""
"""One trial of a task for two hands."""

TRIALS = 6
"""Number of trials in every session of this design, including practice."""

TWICE = DESIGN.replace("seed = 3", "seed = 3\nsessions = 2").replace(
    "repetitions = 2\npractice = 1\n", "repetitions = 1\npractice = 1\npractice_sessions = [1]\n"
)
"""The same study in two sessions."""

FIRST, SECOND = 4, 2
"""Trials of both sessions: the first one has practice before each of two levels."""


def quiet(text: str) -> None:
    """Nobody listens."""


def design(text: str = DESIGN) -> Design:
    return parse_design(text, Path("design.toml"))


def pilot(file: Path) -> list[str]:
    """The command that runs a session of a design in its folder with a simulated user."""
    out = ["--out", str(file.parent)]
    return ["study", "run", str(file), *out, "--pilot", "--device", "simulated", "--view", "none"]


def trial_result(time_s: float = 2.0, success: bool = True, **more: Any) -> TrialResult:
    """The result of a trial that was not played."""
    values: dict[str, Any] = {
        "task": "quick",
        "encoder": "linear",
        "seed": 0,
        "success": success,
        "instant": success,
        "held": success,
        "final": success,
        "status": Status.HELD if success else Status.TIMEOUT,
        "progress": float(success),
        "time_s": time_s,
        "reason": "" if success else "too far",
        "state_hash": "00",
    }
    return TrialResult(**(values | more))


def simulated_runner(
    session: SessionFolder,
    person: Participant,
    forms: Forms,
    controls: Controls | None = None,
    say: Callable[[str], object] = quiet,
) -> SessionRunner:
    """What runs a session, with simulated hands."""
    devices = simulated_devices(person)
    return SessionRunner(session, HeadlessPlayer(), devices, forms, controls or Controls(), say)


def play_session(
    study: StudyFolder, person: Participant, devices: OpenDevices, **more: Any
) -> SessionOutcome:
    """Runs a participant's session without a window; `more` are attributes of `SessionRunner`."""
    usual = {"player": HeadlessPlayer(), "forms": SimulatedForms(1), "controls": Controls()}
    with SessionFolder(study, person) as session:
        return SessionRunner(session, open_devices=devices, **{**usual, "say": quiet, **more}).run()


def first_session(study: StudyFolder) -> Path:
    """The folder of the first participant's first session."""
    return session_path(study.path, study.participants()[0].ppid)


def state_of(session: Path) -> SessionState:
    """The state of a session, by its folder."""
    return SessionState.of(read_journal(session / "session.jsonl"))


def open_study(out: Path, text: str = DESIGN, mode: str = SIMULATED) -> StudyFolder:
    return StudyFolder(out, design(text), mode)


def in_child(work: Callable[[Callable[[str], object]], object]) -> tuple[int, int]:
    """Runs `work(say)` in a process of its own; its id, and the end of a pipe with what it says."""
    require("fork")
    reading, writing = os.pipe()
    pid = os.fork()
    if pid:
        os.close(writing)
        return pid, reading
    try:
        os.close(reading)
        work(lambda text: os.write(writing, f"{text}\n".encode()))
        os._exit(0)
    except BaseException as error:
        os.write(writing, "".join(traceback.format_exception(error)).encode())
        os._exit(1)


def killed_after(
    child: tuple[int, int], seconds: float, soon: Callable[[], bool] = lambda: False
) -> tuple[bool, str]:
    """Kills a child that is still alive; returns whether it was, and all its output.

    It is killed after so long, or `soon` after something has become true.
    """
    pid, reading = child
    end = time.monotonic() + seconds
    status = None
    while status is None and time.monotonic() < end and not soon():
        done, found = os.waitpid(pid, os.WNOHANG)
        status = found if done else None
        time.sleep(0.001)
    killed = status is None
    if killed:
        os.kill(pid, signal.SIGKILL)
        _, status = os.waitpid(pid, 0)
    said = b""
    while piece := os.read(reading, 65_536):
        said += piece
    os.close(reading)
    text = said.decode()
    assert killed or status == 0, text
    return killed, text


def told_finished(said: str) -> int:
    """Number of trials that a session had finished at least when it printed this."""
    numbers = [
        int(line.split("trial ")[1].split()[0]) for line in said.splitlines() if "  trial " in line
    ]
    return max(numbers, default=1) - 1


def check_session(study: StudyFolder, number: int, at_least: int, nth: int = 1) -> int:
    """Checks what must hold for a session at any moment; returns its number of trials that are
    finished."""
    person = next((p for p in study.participants() if p.number == number), None)
    if person is None:
        assert at_least == 0
        return 0
    path = session_path(study.path, person.ppid, nth)
    if not (path / "session.jsonl").exists():
        assert at_least == 0
        return 0
    state = state_of(path)
    ended = {n: [a for a in some if a.end] for n, some in state.attempts.items()}
    finished = [n for n, some in ended.items() if some]
    # A finished trial may still wait to be taken in from its recording: one at most.
    left = state.open_attempt()
    waits = left is not None and finished_result(path / left.start["file"]) is not None
    assert len(finished) + waits >= at_least
    assert all(len(some) <= 1 for some in ended.values()), "no trial is finished twice"
    for some in ended.values():
        for attempt in some:
            assert finished_result(path / attempt.start["file"]) is not None
    files = [a.start["file"] for some in state.attempts.values() for a in some]
    assert len(set(files)) == len(files), "no attempt wrote over another"
    rows = trial_rows(study.design, state)
    assert sorted(r["trial"] for r in rows if r["counted"]) == sorted(finished)
    planned = [t.number for t in trials_of(session_plan(study.design, number, nth))]
    assert planned[: len(finished)] == sorted(finished), "they come in the order of the plan"
    return len(finished)


def recordings(folder: Path, count: int) -> dict[Path, bytes]:
    """Files that look like recordings, and what is in them."""
    rng = np.random.default_rng(8)
    made = {}
    for i in range(count):
        lines = [b'{"kind":"input","hash":"%s"}' % rng.bytes(16).hex().encode() for _ in range(900)]
        path = folder / f"T{i:03d}.jsonl"
        path.write_bytes(b"\n".join(lines) + b"\n")
        made[path] = path.read_bytes()
    return made


def rows_of(path: Path) -> list[dict[str, str]]:
    """The rows of a table."""
    return list(csv.DictReader(path.open(encoding="utf-8")))
