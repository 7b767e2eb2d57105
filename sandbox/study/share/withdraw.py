"""Withdrawal: deletes all data of a participant, and leaves a note with the pseudonym and the date.

The note marks data in a restored backup, or in a copy of another site, as withdrawn. The note is
written before the data are deleted, so that another call can complete an interrupted withdrawal.
"""

from __future__ import annotations

import csv
import gzip
import shutil
import zlib
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path

from models.errors import StudyError
from sandbox.study.record.copies import session_folders
from sandbox.study.record.durable_files import LOCK_FILES, locked, study_error, write_atomically
from sandbox.study.record.folder import REPORT, StudyFolder
from sandbox.study.record.journal import now
from sandbox.study.record.notes import (
    COPIED,
    NOTES,
    WITHDRAWN,
    add_note,
    read_notes,
    withdrawn,
    write_notes,
)
from sandbox.study.tables.column import TABLES, csv_bytes
from sandbox.study.tables.tables import BEFORE, make_tables
from sandbox.system.files import sync_folder


@dataclass(frozen=True)
class Withdrawal:
    """Result of a withdrawal.

    Attributes:
        files: Number of deleted files.
        before: True if the participant had been withdrawn before.
        copies: Shared folders that contain the data.
        still: Files in the study folder that still contain the pseudonym, or may contain it
            because they are damaged; and pages of reports, which include the participant.
        unmade: Reason why the tables could not be made again, such as another person's damaged
            journal; empty if they were made. In both cases they do not contain the participant.
    """

    files: int
    before: bool
    copies: tuple[Path, ...]
    still: tuple[Path, ...]
    unmade: str = ""


def withdraw(study: StudyFolder, ppid: str) -> Withdrawal:
    """Deletes all data of a participant. Another call completes an interrupted withdrawal.

    Raises:
        StudyError: The participant does not exist, a session is open, or a file cannot be deleted.
            If a file cannot be deleted, the note is already written, and another call continues.
    """
    before = ppid in withdrawn(study.records())
    if not before:
        study.find(ppid)
    with ExitStack() as stack:
        for session in session_folders(study.path / ppid):
            stack.enter_context(locked(session / ".lock", wait=False, what=f"participant {ppid}"))
        with study.lock():
            if not before:
                day = f"{now()[:10]}T00:00:00.000+00:00"
                add_note(study.notes, WITHDRAWN, ppid=ppid, time=day)
            files = _delete(study.path / ppid)
            _remove_from_tables(study.path / TABLES, ppid)
    unmade = ""
    try:
        make_tables(study)
    except StudyError as error:
        unmade = str(error)
    copied = [n["path"] for n in study.records() if n["kind"] == COPIED and ppid in n["ppids"]]
    with study.lock():
        for path in sorted((study.path / NOTES).glob("*.jsonl")):
            _remove_from_notes(path, ppid)
    return Withdrawal(files, before, tuple(map(Path, copied)), tuple(_traces(study, ppid)), unmade)


def _remove_from_notes(path: Path, ppid: str) -> None:
    """Removes a participant from the notes of a site, except the note of the withdrawal."""
    notes = read_notes(path)
    kept = [
        {**note, "ppids": [other for other in note["ppids"] if other != ppid]}
        if note["kind"] == COPIED
        else note
        for note in notes
        if note["kind"] == WITHDRAWN or note.get("ppid") != ppid
    ]
    if kept != notes:
        write_notes(path, kept)


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


def _remove_from_tables(folder: Path, ppid: str) -> None:
    """Removes a participant from all tables, including those from before an accepted loss."""
    for path in (*folder.glob("*.csv"), *folder.glob(f"{BEFORE}*/*.csv")):
        with path.open(encoding="utf-8", newline="") as file:
            rows = [*csv.reader(file)]
        if any(ppid in row for row in rows):
            names, *others = rows
            stay = [dict(zip(names, row, strict=False)) for row in others if ppid not in row]
            write_atomically(path, csv_bytes(stay, names))


def _traces(study: StudyFolder, ppid: str) -> list[Path]:
    """Files of the study that contain the pseudonym, or may contain it because they are damaged,
    and pages of reports, which include the participant.

    Folders of other participants, and notes of sites, are not searched.
    """
    others = {person.ppid for person in study.participants()}
    paths = []
    for path in sorted(study.path.rglob("*")):
        inside = path.relative_to(study.path).parts
        if inside[0] in (*others, NOTES) or not path.is_file():
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
