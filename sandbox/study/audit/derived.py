"""Compares the tables of sessions and of the study with what follows from the journals.

Tables may be older than the journals: a program was killed before it wrote them again. They must
then be those of the first records of the journals. `.tables.json` says how much of every journal
the tables of the study have, and the log of a session how much its tables have. Tables that were
written before these two, when the program was killed, may be newer.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from sandbox.study.audit.findings import Findings, Kind
from sandbox.study.audit.journals import ReadJournal
from sandbox.study.record.folder import STUDY_JOURNAL, Participant, StudyFolder, participants_of
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import StoredSession
from sandbox.study.tables.column import united
from sandbox.study.tables.tables import (
    LOG,
    SOURCES,
    csv_of,
    earlier_of,
    log_bytes,
    participant_rows,
    session_files,
    study_files,
)

RESULTS = "trial_results.csv"
"""The table that depends on the files of trials, too: their names, and their measures."""
JOURNALS = "the journal and the design"


@dataclass(frozen=True)
class AuditedSession:
    """A session whose journal is sound.

    Attributes:
        person: The participant.
        number: Number of the session.
        journal: Its journal.
        files_are_sound: True if the files of all trials are as they were written.
        sealed: Number of records when the session was last closed; 0 if it never was.
    """

    person: Participant
    number: int
    journal: ReadJournal
    files_are_sound: bool
    sealed: int

    @property
    def path(self) -> Path:
        """Folder of the session."""
        return self.journal.path.parent

    @property
    def name(self) -> str:
        """Name in `.tables.json`."""
        return f"{self.person.ppid}/{self.path.name}"

    def at(self, count: int) -> StoredSession | None:
        """The session after its first records; None before it has begun."""
        records = self.journal.records[:count]
        state = SessionState.of(records)
        if not state.start:
            return None
        return StoredSession(self.person, self.number, self.path, records, state)


def check_session_tables(
    findings: Findings, study: StudyFolder, session: AuditedSession, least: int
) -> None:
    """Compares the tables of a session.

    Args:
        findings: Takes what is wrong.
        study: The study.
        session: The session.
        least: Number of records that the tables have at least, since tables of the study, which
            are written after them, have as many.
    """
    whole, log = len(session.journal.records), session.path / LOG
    count = _logged(findings, session, log, least)
    if count is None:
        return
    if count < whole:
        findings.notes.append(
            f"{findings.name(session.path)}: its tables are those of the first {count} of {whole} "
            "records; they are built again when the study is opened"
        )
    made: dict[int, dict[str, bytes]] = {}

    def files(n: int) -> dict[str, bytes]:
        if n not in made:
            stored = session.at(n)
            made[n] = session_files(study, stored) if stored else {}
        return made[n]

    for name in files(whole):
        path = session.path / name
        if name == LOG or (name == RESULTS and not session.files_are_sound):
            continue
        if not path.exists() and not session.sealed:
            continue
        _check_one(findings, path, (files(n).get(name) for n in range(count, whole + 1)))


def check_study_tables(
    findings: Findings,
    study: StudyFolder,
    journal: ReadJournal,
    sessions: Sequence[AuditedSession],
) -> dict[str, int]:
    """Compares the tables of the study.

    Returns:
        Number of records that the tables have of every journal, by name in `.tables.json`.
    """
    path = study.path / SOURCES
    if not path.exists() and not any(session.sealed for session in sessions):
        return {}
    sizes = _sizes(findings, path, journal, sessions)
    if sizes is None:
        return {}
    now = {STUDY_JOURNAL: len(journal.records)} | {s.name: len(s.journal.records) for s in sessions}
    before = {name: sizes.get(name, 0) for name in now}
    # The journal of the study grows with seals and copies, on which no row depends.
    open_ = [n for n in now if before[n] < now[n] and n != STUDY_JOURNAL]
    candidates: list[dict[str, int]] = [before, now]
    if len(open_) == 1:
        (name,) = open_
        candidates += [{**now, name: n} for n in range(before[name] + 1, now[name])]
    files_are_sound = all(session.files_are_sound for session in sessions)
    made: dict[int, dict[str, bytes]] = {}

    def files(index: int) -> dict[str, bytes]:
        if index not in made:
            made[index] = _study_files(study, journal, sessions, candidates[index])
        return made[index]

    for name in files(0):
        if name == RESULTS and not files_are_sound:
            continue
        _check_one(
            findings, study.path / name, (files(i).get(name) for i in range(len(candidates)))
        )
    return before


def _check_one(findings: Findings, path: Path, expected: Iterator[bytes | None]) -> None:
    """Compares a table with what follows from ever more records; the first of these is named."""
    data = path.read_bytes() if path.exists() else None
    first: bytes | None = None
    for content in expected:
        if content is None:
            continue
        first = content if first is None else first
        if data == content:
            findings.counts["tables compared"] += 1
            return
    if first is not None:
        findings.compare(path, first, JOURNALS)


def _logged(findings: Findings, session: AuditedSession, log: Path, least: int) -> int | None:
    """Number of records in the log of a session; None if it is not the log of this journal."""
    records = session.journal.records
    if not log.exists():
        if session.sealed:
            findings.add(Kind.MISSING, log, f"it follows from {JOURNALS}")
            return None
        return 0
    data = log.read_bytes()
    try:
        count = sum(1 for _ in csv.reader(io.StringIO(data.decode(), newline=""))) - 1
    except (UnicodeDecodeError, csv.Error):
        count = len(records)
    whole = log_bytes(records)
    if count > len(records) and data.startswith(whole):
        line = whole.count(b"\n") + 1
        findings.add(Kind.CHANGED, log, "it has more records than the journal", line)
        findings.add(
            Kind.MISSING,
            session.journal.path,
            f"records {len(records) + 1} to {count}; {findings.name(log)} has them",
            len(records) + 1,
        )
        return None
    if not findings.compare(log, log_bytes(records[:count]), "the journal"):
        return None
    if count < least:
        findings.add(Kind.CHANGED, log, f"it is older than the tables of the study ({SOURCES})")
        return None
    findings.counts["tables compared"] += 1
    return count


def _sizes(
    findings: Findings, path: Path, journal: ReadJournal, sessions: Sequence[AuditedSession]
) -> dict[str, int] | None:
    """Number of records by journal that the tables of the study have; None if nothing fits."""
    try:
        sizes = json.loads(path.read_bytes())
    except FileNotFoundError:
        findings.add(Kind.MISSING, path, "the tables of the study were built with it")
        return None
    except ValueError:
        sizes = None
    journals = {STUDY_JOURNAL: journal} | {s.name: s.journal for s in sessions}
    if not isinstance(sizes, dict) or not all(isinstance(n, int) for n in sizes.values()):
        findings.add(Kind.CHANGED, path, "it is not a list of journals and sizes")
        return None
    counts = {}
    for name, size in sizes.items():
        of = journals.get(name)
        count = None if of is None else of.count_at(size)
        if of is None:
            findings.add(Kind.CHANGED, path, f"it names {name}, of which there is no journal")
        elif count is not None:
            counts[name] = count
        elif of.ends and size > of.ends[-1]:
            findings.add(
                Kind.MISSING,
                of.path,
                f"what came after byte {of.ends[-1]}; {SOURCES} knows of {size} bytes",
                len(of.records) + 1,
            )
        else:
            findings.add(Kind.CHANGED, path, f"no record of {name} ends at byte {size}")
    return counts if counts.keys() == sizes.keys() else None


def _study_files(
    study: StudyFolder,
    journal: ReadJournal,
    sessions: Sequence[AuditedSession],
    counts: Mapping[str, int],
) -> dict[str, bytes]:
    """Tables of the study that follow from the first records of every journal."""
    by_person: dict[str, list[StoredSession]] = {}
    sizes = {STUDY_JOURNAL: _end(journal, counts[STUDY_JOURNAL])}
    people = participants_of(journal.records[: counts[STUDY_JOURNAL]])
    of_person: Callable[[str], Iterable[AuditedSession]] = lambda ppid: (  # noqa: E731
        session for session in sessions if session.person.ppid == ppid
    )
    for person in people:
        for session in of_person(person.ppid):
            stored = session.at(counts[session.name])
            if stored is not None:
                by_person.setdefault(person.ppid, []).append(stored)
                sizes[session.name] = _end(session.journal, counts[session.name])
    rows = [
        participant_rows(study, person, by_person[person.ppid])
        for person in people
        if person.ppid in by_person
    ]
    earlier = united(earlier_of(study.design, one) for one in rows)
    written = [csv_of(study.design, one, earlier) for one in rows]
    return study_files(study.design, written, sizes, earlier)


def _end(journal: ReadJournal, count: int) -> int:
    return journal.ends[count - 1] if count else 0
