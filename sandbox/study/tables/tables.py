"""Builds the tables of sessions and of the whole study from the journals.

Each table is written as a whole and atomically. Everything in it is derived from journals and
recordings, so that it can be built again at any time.

The tables of a session are written after every trial, at a cost that does not depend on other
participants. The tables of the study are written when a session begins and ends: the rows of each
participant are kept, and built again only if their journals or measures have changed.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from models.errors import StudyError
from sandbox.study.design.design import Design
from sandbox.study.design.plan import trials_of
from sandbox.study.record.chain import Record, without_chain
from sandbox.study.record.files import locked, write_atomically
from sandbox.study.record.folder import STUDY_JOURNAL, Participant, StudyFolder
from sandbox.study.record.session_clock import RUNS
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.stored_sessions import (
    JOURNAL,
    SESSIONS,
    StoredSession,
    all_sessions,
    design_of,
    plan_of,
    planned_trials,
    session_folders,
    sessions_of,
)
from sandbox.study.tables.codebook import codebook, columns_by_table
from sandbox.study.tables.column import (
    NO_EARLIER,
    Earlier,
    Row,
    csv_bytes,
    csv_rows,
    earlier_factors,
    names_of,
    united,
)
from sandbox.study.tables.exclusions import exclude_person
from sandbox.study.tables.participant_table import earlier_questions, participant_row
from sandbox.study.tables.questionnaire_tables import answer_rows, score_rows
from sandbox.study.tables.trial_table import FILE_NAMES, trial_rows

SOURCES = ".tables.json"
"""File of a study with the size of every journal, bytes, when the tables were built from it."""
LOG = "session_info/log.csv"
"""The log of a session; of its tables it is written last."""
SETTLED = 1_000_000_000
"""ns after which a second change of a file has another modification time than the first. File
systems store times in steps of a few milliseconds, some of them in steps of a second."""

Say = Callable[[str], object]


def _silent(text: str) -> None:
    """Prints nothing."""


@dataclass(frozen=True)
class _ParticipantRows:
    """Rows of one participant in the tables of the study.

    Attributes:
        person: The participant, as in the journal of the study.
        columns: Names of the columns of each table.
        sources: Sizes and modification times of the files that the rows were built from, by
            session.
        settled: True if the files had not changed for `SETTLED` when they were read.
        rows: Rows as CSV without the header line, by table.
        trials, excluded: Number of counted trials, and how many of them are excluded.
        earlier: What the participant has from an earlier design.
    """

    person: Participant
    columns: dict[str, list[str]]
    sources: tuple[tuple[Any, ...], ...]
    settled: bool
    rows: dict[str, bytes]
    trials: int
    excluded: int
    earlier: Earlier


class StudyTables:
    """Writes the tables of all participants together.

    The first update reads every journal. Later updates read only the journals that have changed,
    in this program or in another one, so that their cost hardly grows with the study.

    Args:
        study: The study.
        say: Called with a line for every failed measure.
    """

    def __init__(self, study: StudyFolder, say: Say = _silent) -> None:
        self._study, self._say = study, say
        self._kept: dict[str, _ParticipantRows] = {}
        self._earlier: Earlier = NO_EARLIER

    def update(self) -> dict[str, int]:
        """Brings the tables up to date with all journals.

        Returns:
            Numbers of participants, of counted trials, and of excluded ones among these.

        Raises:
            StudyError: A journal is damaged, or a table cannot be written.
        """
        study, design = self._study, self._study.design
        with study.lock():
            # Its size first: what is added meanwhile is in the tables of the next update.
            journal = study.path / STUDY_JOURNAL
            sizes = {STUDY_JOURNAL: journal.stat().st_size if journal.exists() else 0}
            people = study.participants()
            self._keep(people)
            earlier = united(rows.earlier for rows in self._kept.values())
            if earlier != self._earlier:
                # Somebody has factors or answers of an earlier design: all rows have their columns.
                self._earlier = earlier
                self._keep(people)
            kept = self._kept.values()
            sizes |= {f"{p.person.ppid}/{name}": size for p in kept for name, size, *_ in p.sources}
            files = study_files(design, [person.rows for person in kept], sizes, earlier)
            for name, data in files.items():
                write_atomically(study.path / name, data)
        return {
            "participants": len(kept),
            "trials": sum(person.trials for person in kept),  # any order: whole numbers
            "excluded": sum(person.excluded for person in kept),  # any order: whole numbers
        }

    def _keep(self, people: Iterable[Participant]) -> None:
        """Keeps the rows of everybody, with columns for what earlier designs had."""
        columns = _column_names(self._study.design, self._earlier)
        self._kept = {
            person.ppid: rows
            for person in people
            if (rows := self._rows(person, columns)) is not None
        }

    def _rows(self, person: Participant, columns: dict[str, list[str]]) -> _ParticipantRows | None:
        """Rows of a participant; None for one who has not begun."""
        sources = _sources(self._study.path / person.ppid)
        kept = self._kept.get(person.ppid)
        needed = (person, columns, sources)
        if kept and kept.settled and (kept.person, kept.columns, kept.sources) == needed:
            return kept
        newest = max((t for session in sources for t in session[2:]), default=0)
        settled = time.time_ns() - newest > SETTLED
        sessions = sessions_of(self._study, person)
        if not sessions:
            return None
        rows = participant_rows(self._study, person, sessions, self._say)
        counted = [r for r in rows["trial_results.csv"] if r["counted"] and not r["practice"]]
        return _ParticipantRows(
            person,
            columns,
            sources,
            settled,
            csv_of(self._study.design, rows, self._earlier),
            len(counted),
            sum(row["excluded"] for row in counted),  # any order: whole numbers
            earlier_of(self._study.design, rows),
        )


def participant_rows(
    study: StudyFolder, person: Participant, sessions: Sequence[StoredSession], say: Say = _silent
) -> dict[str, list[Row]]:
    """Rows of a participant in the tables of the study, by table."""
    planned, times = planned_trials(study, person, sessions), study.design.sessions
    of = study.design_of
    return _rows_by_table(study.design, sessions, of, study.path, planned, times, say)


def earlier_of(design: Design, rows: Mapping[str, list[Row]]) -> Earlier:
    """What the rows of a participant or a session have from an earlier design.

    Args:
        design: The design.
        rows: The rows by table.
    """
    factors = earlier_factors(design, (row for some in rows.values() for row in some))
    return united([factors, earlier_questions(design, rows["participants.csv"])])


def csv_of(design: Design, rows: Mapping[str, list[Row]], earlier: Earlier) -> dict[str, bytes]:
    """Rows as CSV without the header line, by table."""
    columns = _column_names(design, earlier)
    return {name: csv_rows(rows[name], names) for name, names in columns.items()}


def study_files(
    design: Design,
    rows: Sequence[Mapping[str, bytes]],
    sizes: Mapping[str, int],
    earlier: Earlier,
) -> dict[str, bytes]:
    """Tables of a study by name, in the order in which they are written.

    Args:
        design: The design.
        rows: Rows of every participant; see `csv_of`.
        sizes: Size of every journal, bytes.
        earlier: What anybody has from an earlier design; see `earlier_of`.
    """
    return {
        **{
            name: csv_bytes([], columns) + b"".join(of_person[name] for of_person in rows)
            for name, columns in _column_names(design, earlier).items()
        },
        "codebook.csv": codebook(design, earlier),
        SOURCES: json.dumps(sizes, indent=1).encode() + b"\n",
    }


def rebuild_study(study: StudyFolder, say: Say = _silent) -> dict[str, int]:
    """Builds the tables of all participants again, from all journals.

    Returns, Raises: See `StudyTables.update`.
    """
    return StudyTables(study, say).update()


def rebuild_all(study: StudyFolder) -> dict[str, list[StoredSession]]:
    """Builds the tables of every session, and then those of the study; no session may be open.

    Returns:
        Sessions of every participant, by pseudonym.

    Raises:
        StudyError: A journal is damaged, or a table cannot be written.
    """
    by_person = {}
    for person, sessions in all_sessions(study):
        for session in sessions:
            (session.path / "session_info").mkdir(exist_ok=True)
            write_session(study, session)
        by_person[person.ppid] = sessions
    rebuild_study(study)
    return by_person


def rebuild_closed(study: StudyFolder) -> None:
    """Builds the tables of sessions again that are older than their journals and not open.

    Raises:
        StudyError: A journal is damaged, or a table cannot be written.
    """
    for _, sessions in all_sessions(study):
        for session in sessions:
            log = session.path / LOG
            if log.exists() and log.read_bytes() == log_bytes(session.records):
                continue
            with ExitStack() as held:
                try:
                    held.enter_context(locked(session.path / ".lock", wait=False))
                except StudyError:
                    # It is open: whoever has it open builds them.
                    continue
                (session.path / "session_info").mkdir(exist_ok=True)
                write_session(study, session)


def tables_are_outdated(study: Path) -> bool:
    """Returns True if a study has journals that its tables were not built from.

    This happens if the program was killed in the middle of a session. It returns False for a copy
    without some of the journals, since its tables cannot be built again.

    Args:
        study: Folder of the study.
    """
    try:
        sizes = json.loads((study / SOURCES).read_bytes())
    except (OSError, ValueError):
        return False
    journals = study.glob(f"*/{SESSIONS}/{JOURNAL}")
    now = {f"{p.parent.parent.name}/{p.parent.name}": p.stat().st_size for p in journals}
    # The journal of the study grows with copies, too, on which no table depends.
    sizes.pop(STUDY_JOURNAL, None)
    return sizes.keys() <= now.keys() and bool(sizes != now)


def rebuild_session(session: SessionFolder, durable: bool = True, say: Say = _silent) -> None:
    """Builds the tables of an open session again; see `write_session`."""
    # Tables must not tell of records that a power cut can take away.
    session.journal.sync()
    stored = StoredSession(
        session.person, session.number, session.path, session.journal.records, session.state
    )
    write_session(session.study, stored, durable, say)


def write_session(
    study: StudyFolder, session: StoredSession, durable: bool = True, say: Say = _silent
) -> None:
    """Writes the tables of a session.

    Args:
        study: The study of the session.
        session: The session.
        durable: True ensures that they are on the disk when this returns.
        say: Called with a line for every failed measure.

    Raises:
        StudyError: A table cannot be written; its older version is still there.
    """
    for name, data in session_files(study, session, say).items():
        write_atomically(session.path / name, data, durable)


def session_files(
    study: StudyFolder, session: StoredSession, say: Say = _silent
) -> dict[str, bytes]:
    """Tables of a session by name, in the order in which they are written.

    They follow from the journal, the design by which the session was run last and the measures of
    the trials.
    """
    design = design_of(study, session)
    planned = len(trials_of(plan_of(study, session)))
    of = study.design_of
    rows = _rows_by_table(design, [session], of, session.path, planned, 1, say)
    earlier = earlier_of(design, rows)
    names = {"participants.csv": "session_info/participant_details.csv"}
    builds = [r["build"] for r in session.records if r["kind"] in RUNS]
    settings = {"settings": design.settings, "build": builds[-1], "design": design.digest}
    return {
        **{
            names.get(table, table): csv_bytes(rows[table], columns)
            for table, columns in _column_names(design, earlier).items()
        },
        "codebook.csv": codebook(design, earlier),
        "session_info/settings.json": json.dumps(settings, indent=1, sort_keys=True).encode()
        + b"\n",
        LOG: log_bytes(session.records),
    }


def log_bytes(records: Iterable[Record]) -> bytes:
    """The log of a session in the format of UXF: time, kind, and the rest of each record, without
    its digests."""
    rows = [
        {
            "timestamp": r["time"],
            "log_type": r["kind"],
            "message": json.dumps(
                {k: v for k, v in without_chain(r).items() if k not in ("time", "kind")},
                ensure_ascii=False,
            ),
        }
        for r in records
    ]
    return csv_bytes(rows, ["timestamp", "log_type", "message"])


def _column_names(design: Design, earlier: Earlier) -> dict[str, list[str]]:
    by_table = columns_by_table(design, earlier)
    return {table: names_of(columns) for table, columns in by_table.items()}


def _sources(folder: Path) -> tuple[tuple[Any, ...], ...]:
    """Name, size of the journal in bytes, and modification times of each session of a participant.

    The times are those of the journal and of the folders of recordings and of measures. Files in
    these folders are only replaced, which changes the time of the folder.
    """
    sources = []
    for path in session_folders(folder):
        journal = path / JOURNAL
        if journal.exists():
            size = journal.stat().st_size
            watched = (journal, path / "trials", path / "trackers")
            times = (p.stat().st_mtime_ns for p in watched if p.exists())
            sources.append((path.name, size, *times))
    return tuple(sources)


def _rows_by_table(
    design: Design,
    sessions: Sequence[StoredSession],
    designs: Callable[[str], Design],
    base: Path,
    planned: int,
    planned_sessions: int,
    say: Say,
) -> dict[str, list[Row]]:
    """Rows of every table for one participant.

    Args:
        design: The design.
        sessions: Sessions of the participant, at least one.
        designs: Function from the digest of a design that was in use to this design.
        base: Folder that names of files in `trial_results.csv` are relative to.
        planned: Planned number of trials, practice included.
        planned_sessions: Planned number of sessions.
        say: Called with a line for every failed measure.
    """
    trials: list[Row] = []
    for session in sessions:
        inside = PurePosixPath(session.path.relative_to(base).as_posix())
        trials += [
            row | {name: str(inside / row[name]) for name in FILE_NAMES}
            for row in trial_rows(design, session.state, session.path, say)
        ]
    states = [session.state for session in sessions]
    exclude_person(design, states, trials)
    return {
        "participants.csv": [participant_row(design, states, planned, trials, planned_sessions)],
        "trial_results.csv": trials,
        "questionnaires.csv": [row for state in states for row in answer_rows(state)],
        "questionnaire_scores.csv": score_rows(states, designs),
    }
