"""A study as its acceptance tests drive it: run, resume, tables, verify.

The tests know a study by these functions and its tables alone, so that they stay as they are when
the layout of its folder changes.
"""

from __future__ import annotations

import errno
import os
import signal
import sys
import traceback
from collections.abc import Callable, Iterable
from pathlib import Path
from types import FrameType
from typing import Any

from sandbox.cli.main import main
from sandbox.study.record.folder import SIMULATED, StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.decisions import losses
from sandbox.study.run.simulated_study import run_simulated
from sandbox.study.share import verify as verification
from sandbox.study.tables.tables import make_tables
from tests.support.needs import require
from tests.support.study_files import SHORT, design, rows_of

SHORT_TRIALS = 2
"""Trials of a session of `SHORT`."""

TABLES = ("trials.csv", "participants.csv", "answers.csv", "scores.csv")
LIVE = (
    *("participant", "date", "attempt", "adopted", "started_s", "ended_s", "time", "seconds"),
    *("recording", "frames"),
)
"""Columns that another run of the same study fills otherwise: names, times and attempts."""


def run(out: Path, text: str = SHORT, people: int = 1) -> Path:
    """Runs a study with simulated participants, or goes on with it; its folder."""
    study = StudyFolder(out, design(text), SIMULATED)
    for number in range(1, people + 1):
        run_simulated(study, number, lambda line: None)
    return study.path


def resume(folder: Path, text: str = SHORT, people: int = 1) -> Path:
    """Goes on with a study that was interrupted; its folder."""
    return run(folder.parent, text, people)


def tables(folder: Path) -> dict[str, bytes]:
    """Derives all tables again; their contents by name, those of trials too."""
    make_tables(StudyFolder.at(folder))
    return derived(folder)


def derived(folder: Path) -> dict[str, bytes]:
    """Contents of all tables of a study by name."""
    names = ("tables/*.csv", "*/S*/trials/*.frames.csv.gz")
    paths = (path for name in names for path in folder.glob(name))
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(paths)}


def results(folder: Path) -> dict[str, list[dict[str, str]]]:
    """Rows of the tables of a study, without what another run fills otherwise."""
    make_tables(StudyFolder.at(folder))
    return {
        name: [
            {k: v for k, v in row.items() if k not in LIVE}
            for row in rows_of(folder / "tables" / name)
        ]
        for name in TABLES
    }


def verify(folder: Path) -> list[str]:
    """What is not as it was written, a line each."""
    return [
        str(f) for found in verification.verify(folder, replays=False).found.values() for f in found
    ]


def lost(folder: Path) -> list[str]:
    """Participants whose record has lost something about which nobody has decided."""
    return [loss.person.ppid for loss in losses(StudyFolder.at(folder))]


def note(folder: Path, ppid: str, *words: str) -> int:
    """Notes something about a participant by the command; its exit status."""
    return main(["study", "note", str(folder), "--participant", ppid, *words])


def record_of(folder: Path, person: int = 0) -> Path:
    """The file with the record of a participant's first session."""
    return (
        session_path(folder, StudyFolder.at(folder).participants()[person].ppid) / "session.jsonl"
    )


def records(folder: Path, person: int = 0) -> list[dict[str, Any]]:
    """The record of a participant's first session."""
    return read_journal(record_of(folder, person))


def everything(folder: Path) -> dict[str, bytes]:
    """All files of a study but those that hold locks."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file() and ".lock" not in path.name
    }


def in_program(work: Callable[[], object]) -> int:
    """Does something in a program of its own; its exit status, -9 for one that was killed."""
    require("fork")
    pid = os.fork()
    if pid:
        return os.waitstatus_to_exitcode(os.waitpid(pid, 0)[1])
    try:
        work()
        os._exit(0)
    except BaseException:
        traceback.print_exc()
        os._exit(1)


class WritePoints:
    """The places of the program at which something reaches the disk, by call, file and function.

    Every `os.write`, `os.fsync` and `os.replace` of this program, which is a child of the test's,
    goes through it. At one place it kills the program, or lets the disk be full from there on.

    Args:
        fatal: The place; empty for none.
        how: `before` or `after` kills the program there, when it passes for the first time; `full`
            raises an error of a full disk there and at every later place.
        report: File to which every place is written when it is passed for the first time.
    """

    def __init__(self, fatal: str = "", how: str = "before", report: Path | None = None) -> None:
        self._fatal, self._how, self._report = fatal, how, report
        self._seen: set[str] = set()
        self._full = False

    def watch(self) -> None:
        """Watches from now on, to the end of the program."""
        for name in ("write", "fsync", "replace"):
            setattr(os, name, self._watched(name, getattr(os, name)))

    def _watched(self, name: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def watched(*args: Any, **options: Any) -> Any:
            place = _place(name)
            first = place not in self._seen
            self._seen.add(place)
            if first and self._report is not None:
                with self._report.open("a") as file:
                    file.write(f"{place}\n")
            fatal = first and place == self._fatal
            self._full |= fatal and self._how == "full"
            if self._full:
                raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
            if fatal and self._how == "before":
                os.kill(os.getpid(), signal.SIGKILL)
            result = call(*args, **options)
            if fatal:
                os.kill(os.getpid(), signal.SIGKILL)
            return result

        return watched


def _place(name: str) -> str:
    """The nearest lines of the study's own code that make a call, as `call file function`."""
    frame: FrameType | None = sys._getframe(2)
    places: list[str] = []
    while frame is not None and len(places) < 2:
        file = Path(frame.f_code.co_filename)
        if "study" in file.parts and file.name not in ("study_driver.py", "files.py"):
            places.append(f"{file.name}:{frame.f_code.co_name}")
        frame = frame.f_back
    return f"{name} {' '.join(places)}"


def places(file: Path) -> Iterable[str]:
    """The places that `WritePoints` has reported, each once."""
    return dict.fromkeys(file.read_text().splitlines())
