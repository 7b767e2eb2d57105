"""Withdrawal: deletes all data of a participant, and leaves a tombstone record.

The tombstone contains the pseudonym and the reason, so that data in a restored backup or in a copy
of another site can be recognised as withdrawn.
"""

from __future__ import annotations

import gzip
import shutil
import time
import zlib
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sandbox.study.record.chain import (
    DIGEST,
    REPLACED,
    WITHDRAWAL,
    Record,
    chained,
    record_line,
    replaced,
)
from sandbox.study.record.files import LOCK_FILES, locked, study_error, write_atomically
from sandbox.study.record.folder import REPORT, STUDY_JOURNAL, WITHDRAWN, StudyFolder
from sandbox.study.record.journal import now, read_journal
from sandbox.study.record.stored_sessions import session_folders
from sandbox.study.share.export_log import COPIES, Copy, copies
from sandbox.study.tables.tables import rebuild_study
from sandbox.system.files import sync_folder

REMOVED = "removed"
"""Kind of the record that takes the place of every other one of the participant."""
SITES = "sites.csv"


@dataclass(frozen=True)
class Withdrawal:
    """Result of a withdrawal.

    Attributes:
        files: Number of deleted files.
        before: True if the participant had been withdrawn before.
        copies: Backups, exports and merged folders that contain the data.
        still: Files in the study folder that still contain the pseudonym, or may contain it
            because they are damaged, and pages of reports, which have the participant in them.
    """

    files: int
    before: bool
    copies: tuple[Copy, ...]
    still: tuple[Path, ...]


def withdraw(study: StudyFolder, ppid: str, reason: str) -> Withdrawal:
    """Deletes all data of a participant. Another call completes an interrupted withdrawal.

    Raises:
        StudyError: The participant does not exist, a session is open, or a file cannot be deleted;
            in the last case the tombstone has been written, and another call continues.
    """
    before = ppid in withdrawn(study)
    if not before and ppid not in {p.ppid for p in study.participants()}:
        study.find(ppid)
    with ExitStack() as stack:
        for session in session_folders(study.path / ppid):
            stack.enter_context(locked(session / ".lock", wait=False, what=f"participant {ppid}"))
        with study.lock():
            _write_tombstone(study.path / STUDY_JOURNAL, ppid, reason)
            files = _delete(study.path / ppid)
            _remove_from_sites(study.path / SITES, ppid)
    rebuild_study(study)
    return Withdrawal(files, before, tuple(copies(study, ppid)), tuple(_traces(study, ppid)))


def withdrawn(study: StudyFolder) -> set[str]:
    """Pseudonyms of withdrawn participants."""
    return {r["ppid"] for r in study.records() if r["kind"] == WITHDRAWN}


def _write_tombstone(path: Path, ppid: str, reason: str) -> None:
    """Replaces the records of a participant in the study's journal, atomically.

    The records that take their places keep the digests, and a last record names them.
    """
    records = read_journal(path)
    lines, old_digests = [], {}
    for record in records:
        new = _without(record, ppid, reason)
        if new == record:
            lines.append(record_line(record))
            continue
        line, old_digests[str(record["n"])] = replaced(new, record)
        lines.append(line)
    if old_digests:
        entry = {**_head(len(records), WITHDRAWAL), REPLACED: old_digests}
        lines.append(chained(entry, records[-1][DIGEST])[1])
        write_atomically(path, b"".join(lines))


def _head(n: int, kind: str) -> Record:
    return {"n": n, "time": now(), "clock": round(time.monotonic(), 6), "kind": kind}


def _without(record: Record, ppid: str, reason: str) -> Record:
    if record["kind"] == WITHDRAWN:
        return record
    if record.get("ppid") == ppid:
        if record["kind"] == "participant":
            return {**_head(record["n"], WITHDRAWN), "ppid": ppid, "reason": reason}
        return _head(record["n"], REMOVED)
    return {key: _scrubbed(value, ppid) for key, value in record.items()}


def _scrubbed(value: Any, ppid: str) -> Any:
    """A JSON value without a pseudonym in its lists and objects."""
    if isinstance(value, dict):
        return {k: _scrubbed(v, ppid) for k, v in value.items() if ppid not in (k, v)}
    if isinstance(value, list):
        return [_scrubbed(v, ppid) for v in value if v != ppid]
    return value


def _delete(folder: Path) -> int:
    if not folder.exists():
        return 0
    count = sum(path.is_file() for path in folder.rglob("*") if path.name not in LOCK_FILES)
    try:
        shutil.rmtree(folder)
        sync_folder(folder.parent)
    except OSError as error:
        raise study_error(error, folder, "not everything could be deleted") from None
    return count


def _remove_from_sites(path: Path, ppid: str) -> None:
    if path.exists():
        kept = [
            line
            for line in path.read_bytes().splitlines(keepends=True)
            if not line.startswith(f"{ppid},".encode())
        ]
        write_atomically(path, b"".join(kept))


def _traces(study: StudyFolder, ppid: str) -> list[Path]:
    """Files of the study that contain the pseudonym or may contain it, since they are damaged, and
    pages of reports, which count the participant; not in folders of other participants."""
    others = {person.ppid for person in study.participants()}
    own = {study.path / STUDY_JOURNAL, study.path / COPIES}
    paths = []
    for path in sorted(study.path.rglob("*")):
        inside = path.relative_to(study.path).parts
        if inside[0] in others or path in own or not path.is_file():
            continue
        try:
            data = path.read_bytes()
            data = gzip.decompress(data) if path.suffix == ".gz" else data
        except (OSError, EOFError, zlib.error):
            paths.append(path)
            continue
        if path.name == REPORT or ppid.encode() in data or ppid in str(Path(*inside)):
            paths.append(path)
    return paths
