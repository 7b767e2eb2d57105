"""Folders of people and sessions, and copies of such folders, which are not data.

A folder belongs to a person if its name is the pseudonym in its first note. It belongs to a session
if its path is the one in the first undamaged record of a run. A copy of a folder inside of the
study has another path, and is therefore ignored: each record counts at most once.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sandbox.study.record.journal import HASH, follows
from sandbox.study.record.notes import PERSON_NOTES, site_notes, withdrawn
from sandbox.study.record.records import RUNS

JOURNAL = "session.jsonl"
"""File of a session's folder: its journal."""
SESSIONS = "S[0-9][0-9][0-9]"
"""Pattern of the names of session folders."""


@dataclass(frozen=True)
class Copy:
    """A folder whose path differs from the path in its notes or journal.

    Attributes:
        path: The folder.
        of: The path according to its notes or journal.
        of_person: True for the folder of a person, False for the folder of a session.
        withdrawn: True if the person whose data it contains has withdrawn.
    """

    path: Path
    of: Path
    of_person: bool
    withdrawn: bool

    def __str__(self) -> str:
        if self.withdrawn:
            return f"holds the data of {self._name}, who has withdrawn; delete it"
        if not self.of.exists():
            return (
                f"holds the data of {self._name}: rename it to {self._name}, or move it out of the "
                "study"
            )
        file = PERSON_NOTES if self.of_person else JOURNAL
        equal = _bytes(self.path / file) == _bytes(self.of / file)
        what = "is a copy of" if equal else "holds other data of"
        return f"{what} {self._name}; move it out of the study"

    @property
    def _name(self) -> str:
        return self.of.name if self.of_person else f"{self.of.parent.name}/{self.of.name}"


def person_folders(study: Path) -> list[Path]:
    """Folders of the people of a study, in the order of their names, without copies."""
    paths = sorted(path.parent for path in study.glob(f"*/{PERSON_NOTES}"))
    return [path for path in paths if _person_in(path) in (None, path.name)]


def session_folders(person: Path) -> list[Path]:
    """Folders of all sessions of a participant, in order, without copies.

    Sessions that have not begun are included.
    """
    paths = sorted(person.glob(SESSIONS))
    return [path for path in paths if _session_in(path) in (None, _place(path))]


def copies(study: Path) -> list[Copy]:
    """Folders of a study whose path differs from the path in their notes or journal.

    Raises:
        StudyError: Notes of a site are damaged.
    """
    people = sorted(path.parent for path in study.glob(f"*/{PERSON_NOTES}"))
    gone = withdrawn(site_notes(study))
    found = []
    for path in people:
        ppid = _person_in(path)
        if ppid not in (None, path.name):
            found.append(Copy(path, study / str(ppid), True, ppid in gone))
    whole = {copy.path for copy in found}
    for path in sorted(file.parent for file in study.glob(f"*/*/{JOURNAL}")):
        place = _session_in(path)
        if path.parent not in whole and place not in (None, _place(path)):
            gone_too = str(place).partition("/")[0] in gone
            found.append(Copy(path, study / str(place), False, gone_too))
    return found


def _place(session: Path) -> str:
    """Path of the folder of a session, relative to its study."""
    return f"{session.parent.name}/{session.name}"


def _person_in(folder: Path) -> str | None:
    """The pseudonym in the first note of a folder; None if it has none."""
    first = _decoded(_bytes(folder / PERSON_NOTES).partition(b"\n")[0])
    ppid = first.get("ppid")
    return ppid if isinstance(ppid, str) else None


def _session_in(folder: Path) -> str | None:
    """The path, relative to the study, according to the journal in a folder; None without one.

    Only undamaged lines are read.
    """
    for record in _sound(folder / JOURNAL):
        if record.get("kind") in RUNS:
            ppid, number = record.get("ppid"), record.get("session", 1)
            named = isinstance(ppid, str) and isinstance(number, int)
            return f"{ppid}/S{number:03d}" if named else None
    return None


def _sound(path: Path) -> Iterator[dict[str, Any]]:
    """Records of a session up to the first damaged or changed line."""
    head = ""
    for line in _bytes(path).split(b"\n")[:-1]:
        record = _decoded(line)
        own = record.get(HASH)
        if not isinstance(own, str) or not follows(line, own, head):
            return
        yield record
        head = own


def _decoded(line: bytes) -> dict[str, Any]:
    """A line of JSON; empty if it is damaged, which `read_notes` and `read_journal` report."""
    try:
        value = json.loads(line)
    except (ValueError, RecursionError):
        return {}
    return value if isinstance(value, dict) else {}


def _bytes(path: Path) -> bytes:
    """Content of a file; empty if it cannot be read, which the readers of whole files report."""
    try:
        return path.read_bytes()
    except OSError:
        return b""
