"""Recordings of a session that no record of its journal names, and records that it has lost."""

from __future__ import annotations

import csv
import json
from pathlib import Path

from models.errors import RecordingError
from sandbox.recording.recording import load_recording, stored
from sandbox.study.record.recorded_result import finished_result
from sandbox.study.record.state import SessionState
from sandbox.study.record.trial_files import TRIALS, attempt_files

LOG = "session_info/log.csv"
"""The log of a session: a row for every record that its journal had when its tables were built."""


def unknown_recordings(session: Path, state: SessionState) -> list[str]:
    """Recordings that no record names, without `.gz`, in order.

    Args:
        session: Folder of the session.
        state: State of the session according to its journal.
    """
    started = {a.start["file"] for attempts in state.attempts.values() for a in attempts}
    known = started | state.recordings.keys()
    files = [f"{TRIALS}/{name}" for name in attempt_files(session / TRIALS)]
    return [file for file in files if file not in known]


def is_whole(path: Path) -> bool:
    """True if a recording has its end, whether the attempt was broken off or not."""
    if finished_result(path) is not None:
        return True
    try:
        recording = load_recording(path) if stored(path).exists() else None
    except RecordingError:
        return False
    return recording is not None and recording.end is not None and not recording.damage


def lost_records(session: Path, there: int) -> int:
    """Number of records that the log of a session has and its journal has not.

    Args:
        session: Folder of the session.
        there: Number of records in the journal.
    """
    return max(0, logged_records(session) - there)


def logged_records(session: Path) -> int:
    """Number of records that the log of a session has; 0 if it cannot be read."""
    log = session / LOG
    if not log.exists():
        return 0
    try:
        with log.open(encoding="utf-8", newline="") as file:
            last = json.loads(list(csv.reader(file))[-1][-1])["n"]
    except (ValueError, KeyError, IndexError, TypeError, csv.Error):
        # A table that cannot be read is built again.
        return 0
    return last + 1 if isinstance(last, int) else 0


def whole_leftovers(session: Path, state: SessionState) -> list[str]:
    """Those of `unknown_recordings` that have their end; see `is_whole`."""
    return [file for file in unknown_recordings(session, state) if is_whole(session / file)]
