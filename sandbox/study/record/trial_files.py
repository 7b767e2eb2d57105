"""Finds recordings of a study by short names of trials, such as NAME/3B5G5T/S001/T007."""

from __future__ import annotations

import re
from pathlib import Path

from models.errors import RecordingError
from sandbox.recording.recording import SUFFIX, stored
from sandbox.study.record.journal import read_journal
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import JOURNAL, SESSIONS, session_folders

TRIAL = re.compile(r"T\d+(\.a\d+)?")
TRIALS = "trials"


def attempt_files(folder: Path) -> list[str]:
    """Names of the recordings of attempts in a session's folder of trials, without `.gz`, in order.

    The last states of an attempt that diverged lie beside its recording, and are no attempt.
    """
    names = {path.name.removesuffix(SUFFIX) for path in folder.glob("T*.jsonl*")}
    return sorted(name for name in names if TRIAL.fullmatch(name.removesuffix(".jsonl")))


def find_recordings(name: str, out: Path) -> list[Path]:
    """Finds the recordings that a name refers to, in order.

    Args:
        name: A file; or a trial such as `NAME/3B5G5T/S001/T007`, where a name without the session
            means that trial of every session; or a study, participant or session, which means all
            of its trials.
        out: Folder of studies, for names that do not exist in the current folder.

    Raises:
        RecordingError: No recording has that name.
    """
    path = Path(name)
    if stored(path).is_file():
        return [path]
    for base in (Path(), out):
        paths = _of_folder(base / path)
        if paths:
            return paths
    # The longest existing part of the name inside the folder of studies helps to find the mistake.
    near = next((p for p in (out / path).parents if p.is_relative_to(out) and p.is_dir()), None)
    kept = [p.name for p in near.iterdir() if p.is_dir() and p.name[0] != "."] if near else []
    raise RecordingError(
        "this folder has no recordings" if path.is_dir() else "no such recording",
        where=name,
        expected="a file, or a trial such as NAME/3B5G5T/S001/T007"
        + (f"; in {near} there are {', '.join(sorted(kept)[:6])}" if kept else ""),
        # Names of files have a suffix, those of trials have none.
        remedy=None if path.suffix else "For studies in another folder, add --out",
    )


def finished_only(files: list[Path]) -> tuple[list[Path], int]:
    """Leaves out recordings of attempts that were broken off, such as by a kill.

    Args:
        files: Recordings of a study.

    Returns:
        Those of finished attempts, and the number of others.

    Raises:
        StudyError: A journal is damaged.
    """
    ended: dict[Path, set[str]] = {}
    for session in {file.parent.parent for file in files}:
        journal = session / JOURNAL
        records = read_journal(journal) if journal.exists() else []
        ended[session] = {Path(r["file"]).name for r in records if r["kind"] == "trial_end"}
    finished = [file for file in files if file.name in ended[file.parent.parent]]
    return finished, len(files) - len(finished)


def _of_folder(path: Path) -> list[Path]:
    """Recordings of a trial, or of a folder of a study; empty if the path is neither."""
    if TRIAL.fullmatch(path.name):
        return [file for session in _sessions(path.parent) for file in _trial(session, path.name)]
    return [file for session in _sessions(path) for file in _all(session / TRIALS)]


def _sessions(path: Path) -> list[Path]:
    """Session folders at a path, which may be a session, a participant or a study."""
    if path.name == TRIALS:
        path = path.parent
    if (path / TRIALS).is_dir():
        return [path]
    return session_folders(path) or sorted(path.glob(f"*/{SESSIONS}"))


def _trial(session: Path, name: str) -> list[Path]:
    """Recording of a named attempt; for a name without attempt, the counted one."""
    exact = session / TRIALS / f"{name}.jsonl"
    journal = session / JOURNAL
    if "." not in name and journal.exists():
        counted = SessionState.of(read_journal(journal)).counted(int(name[1:]))
        if counted is not None:
            exact = session / counted.start["file"]
    return [exact] if stored(exact).is_file() else []


def _all(folder: Path) -> list[Path]:
    """All recordings of a session, compressed or not."""
    return [folder / name for name in attempt_files(folder)]
