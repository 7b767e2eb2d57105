"""Notes: decisions and seals, in files apart from the journals of sessions.

A file of notes has append-only lines of JSON. `PERSON/notes.jsonl` begins with the person's
pseudonym, number and hand, and contains the decisions about the person. `notes/SITE.jsonl` of the
study contains the study's name and mode, its lock, seals of sessions, copies and withdrawals. Each
line is on the disk when the function that writes it returns.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

from msgspec import Struct

from models.errors import StudyError
from models.json_input import checked, decoded_record
from sandbox.study.record.durable_files import study_error, write_atomically
from sandbox.study.record.journal import HASH, Record, check_texts, now
from sandbox.study.record.records import Shared, Words, number_from_one, refuse_later_layout
from sandbox.system.files import OPEN, sync_folder

NOTES = "notes"
"""Folder in a study's folder, with the notes of each site."""
PERSON_NOTES = "notes.jsonl"
"""File in a person's folder, with the notes about the person."""
STUDY, UPGRADE, ANEW, LIBRARIES = "study", "upgrade", "locked_anew", "libraries"
SEALED, WITHDRAWN, COPIED, ANONYMISED = "sealed", "withdrawn", "copied", "anonymised"
PARTICIPANT, EXCLUDE, INCLUDE = "participant", "exclude", "include"
RELEASE, REMARK, LOSS = "release", "remark", "loss_accepted"

DECISIONS = (EXCLUDE, INCLUDE, RELEASE, REMARK)
"""Kinds of decisions about a participant that can be undone."""


class _Head(Struct):
    time: datetime
    kind: Shared[str]


class _Participant(_Head):
    ppid: str
    site: Shared[str]
    number: Shared[int]
    schema: Shared[int] = 0
    hand: Shared[str] = "right"
    hand_size: Shared[float] = 1.0
    language: Shared[str] = "en"
    user: Shared[dict[str, Any] | None] = None


class _Decision(_Head):
    """Exclusion, inclusion or remark: about a trial of a session, or about the person.

    Attributes:
        after: Number of records of each session at that time, by session number.
        number: New number of a participant who is included again after the number was freed.
    """

    reason: Words[str]
    after: Shared[dict[int, int]]
    number: Shared[int | None] = None
    schema: Shared[int] = 0
    session: Shared[int | None] = None
    trial: Shared[int | None] = None


class _Reason(_Head):
    reason: Words[str]


class _Loss(_Reason):
    """A loss of records that the experimenter accepted.

    Attributes:
        records: Number of lost records.
        voids: Hashes of the seals that are void since then.
    """

    session: int
    records: int
    voids: list[str]


class _Study(_Head):
    schema: Shared[int]
    experiment: Shared[str]
    mode: Shared[str]
    build: Shared[dict[str, Any]]
    settings: Shared[dict[str, Any] | None] = None


class _Changed(_Head):
    changed: list[str]
    before: dict[str, Any]
    after: dict[str, Any]


class _Sealed(_Head):
    ppid: str
    session: int
    records: int
    hash: str


class _Withdrawn(_Head):
    ppid: str


class _Copied(_Head):
    path: str
    ppids: list[str]


class _Anonymised(_Head):
    about: dict[str, Any]


FORMS: dict[str, type[_Head]] = {
    PARTICIPANT: _Participant,
    EXCLUDE: _Decision,
    INCLUDE: _Decision,
    REMARK: _Decision,
    RELEASE: _Reason,
    LOSS: _Loss,
    STUDY: _Study,
    UPGRADE: _Changed,
    ANEW: _Changed,
    LIBRARIES: _Changed,
    SEALED: _Sealed,
    WITHDRAWN: _Withdrawn,
    COPIED: _Copied,
    ANONYMISED: _Anonymised,
}


def read_notes(path: Path) -> list[Record]:
    """Reads the notes of a person or of a site; empty if the file does not exist.

    A half-written last line, which a killed program leaves, is ignored.

    Raises:
        StudyError: The file cannot be read, or a line is damaged.
    """
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return []
    except OSError as error:
        raise StudyError(
            "the notes cannot be read",
            where=str(path),
            got=error.strerror,
            remedy="Give read permission, or restore them from a backup",
        ) from None
    lines = data.split(b"\n")[:-1]
    what, remedy = "the notes are damaged", "Restore them from a backup; nothing was changed"
    notes = []
    for number, line in enumerate(lines, start=1):
        where = f"{path}, line {number}"
        note = decoded_record(line, StudyError, what=what, where=where, remedy=remedy)
        refuse_later_layout(note, where)
        head = checked(note, _Head, StudyError, what=what, where=where, remedy=remedy)
        form = FORMS.get(head.kind)
        if form is None:
            raise StudyError(what, where=where, got=head.kind, expected=", ".join(FORMS))
        checked(note, form, StudyError, what=what, where=where, remedy=remedy)
        if head.kind in (PARTICIPANT, INCLUDE):
            number_from_one(note)
        notes.append(note)
    return notes


def add_note(path: Path, kind: str, /, **values: Any) -> Record:
    """Appends a note durably; the caller holds the lock of the study.

    Raises:
        StudyError: The note cannot be written; the file is unchanged.
    """
    note = {"time": now(), "kind": kind, **values}
    check_texts(note, f"{path}, {kind}")
    line = json.dumps(note, separators=(",", ":"), ensure_ascii=False).encode() + b"\n"
    try:
        data = path.read_bytes() if path.exists() else b""
        fd = os.open(path, os.O_WRONLY | os.O_CREAT | OPEN, 0o666)
        try:
            # A killed program may have left a part of a line at the end, which is overwritten.
            whole = data.rfind(b"\n") + 1
            try:
                os.ftruncate(fd, whole)
                os.lseek(fd, whole, os.SEEK_SET)
                while line:
                    line = line[os.write(fd, line) :]
                os.fsync(fd)
            except OSError:
                os.ftruncate(fd, whole)
                raise
        finally:
            os.close(fd)
        if not data:
            sync_folder(path.parent)
    except OSError as error:
        raise study_error(error, path, "the note cannot be written") from None
    return note


def write_notes(path: Path, notes: Iterable[Record]) -> None:
    """Replaces a file of notes atomically: in a copy of a study, or after a withdrawal."""
    lines = (json.dumps(note, separators=(",", ":"), ensure_ascii=False) for note in notes)
    write_atomically(path, "".join(f"{line}\n" for line in lines).encode())


def site_notes(study: Path) -> list[Record]:
    """Notes of all sites of a study, site by site, in the order in which they were written.

    Raises:
        StudyError: A file is damaged.
    """
    return [note for path in sorted((study / NOTES).glob("*.jsonl")) for note in read_notes(path)]


def withdrawn(notes: Iterable[Record]) -> set[str]:
    """Pseudonyms of participants who withdrew, according to the notes of all sites."""
    return {note["ppid"] for note in notes if note["kind"] == WITHDRAWN}


def person_notes(study: Path, ppid: str) -> list[Record]:
    """Notes about a person.

    Raises:
        StudyError: The file is damaged.
    """
    return read_notes(study / ppid / PERSON_NOTES)


@dataclass(frozen=True)
class Seal:
    """Length and hash of a session's journal at the time when the session was closed.

    Attributes:
        records: Number of records in the journal.
        hash: Hash of the last record.
    """

    records: int
    hash: str


def seals_of(study: Path, ppid: str, session: int) -> list[Seal]:
    """Valid seals of a session, in order: seals that no accepted loss has made void.

    Raises:
        StudyError: Notes are damaged.
    """
    losses = (note for note in person_notes(study, ppid) if note["kind"] == LOSS)
    void = {seal for loss in losses if loss["session"] == session for seal in loss["voids"]}
    return [
        Seal(note["records"], note[HASH])
        for note in site_notes(study)
        if note["kind"] == SEALED
        and (note["ppid"], note["session"]) == (ppid, session)
        and note[HASH] not in void
    ]


def broken_seals(records: Sequence[Record], seals: Iterable[Seal]) -> tuple[int, bool]:
    """Compares the records of a session with its seals.

    Returns:
        Number of sealed records that are missing at the end, and True if a sealed record has
        changed.
    """
    lacks, unlike = 0, False
    for seal in seals:
        lacks = max(lacks, seal.records - len(records))
        if 0 < seal.records <= len(records):
            unlike |= records[seal.records - 1][HASH] != seal.hash
    return lacks, unlike
