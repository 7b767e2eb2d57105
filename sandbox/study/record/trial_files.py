"""Finds the recordings of a study's trials by what people call them: NAME/3B5G5T/S001/T007."""

from __future__ import annotations

import re
from pathlib import Path

from models.errors import RecordingError
from sandbox.recording.recording_file import SUFFIX, stored
from sandbox.study.record.journal import read_journal
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import JOURNAL, SESSIONS, session_folders

TRIAL = re.compile(r"T\d+(\.a\d+)?")
TRIALS = "trials"


def find_recordings(name: str, out: Path) -> list[Path]:
    """Finds the recordings that a name refers to, in order.

    Args:
        name: A file; or a trial of a study, such as `NAME/3B5G5T/S001/T007`, without the session
            that of each session; or a study, a participant or a session: then all of its trials.
        out: Folder of studies, for names that are not found from the current folder.

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
    # As much of the name as there is; no other folder than that of studies is anybody's business.
    near = next((p for p in (out / path).parents if p.is_relative_to(out) and p.is_dir()), None)
    kept = [p.name for p in near.iterdir() if p.is_dir() and p.name[0] != "."] if near else []
    raise RecordingError(
        "no such recording",
        where=name,
        expected="a file, or a trial such as NAME/3B5G5T/S001/T007"
        + (f"; in {near} there are {', '.join(sorted(kept)[:6])}" if kept else ""),
        remedy="Studies that are elsewhere are found with --out",
    )


def _of_folder(path: Path) -> list[Path]:
    """The recordings of a trial or a folder of a study; none where it is neither."""
    if TRIAL.fullmatch(path.name):
        return [file for session in _sessions(path.parent) for file in _trial(session, path.name)]
    return [file for session in _sessions(path) for file in _all(session / TRIALS)]


def _sessions(path: Path) -> list[Path]:
    """Session folders: the one itself, those of a participant, or those of a study."""
    if path.name == TRIALS:
        path = path.parent
    if (path / TRIALS).is_dir():
        return [path]
    return session_folders(path) or sorted(path.glob(f"*/{SESSIONS}"))


def _trial(session: Path, name: str) -> list[Path]:
    """The attempt of a name; of several attempts of a trial, the one that counts."""
    exact = session / TRIALS / f"{name}.jsonl"
    journal = session / JOURNAL
    if "." not in name and journal.exists():
        counted = SessionState.of(read_journal(journal)).counted(int(name[1:]))
        if counted is not None:
            exact = session / counted.start["file"]
    return [exact] if stored(exact).is_file() else []


def _all(folder: Path) -> list[Path]:
    """All recordings of a session, compressed or not."""
    names = {p.name.removesuffix(SUFFIX) for p in folder.glob("T*.jsonl*")}
    return [folder / name for name in sorted(names) if name.endswith(".jsonl")]
