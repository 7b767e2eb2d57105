"""The tables of a study, derived from journals: written whole and atomically, never the only place
of anything.

The tables of a session follow every trial, at a cost that does not depend on other participants.
Those of the study are put together when a session begins and ends: each participant has a part in
every table, and only parts whose journals or measures have changed are made again.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sandbox.study.design.design import Design
from sandbox.study.design.plan import Step
from sandbox.study.record.files import write_atomically
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.record.journal import Record
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import (
    JOURNAL,
    SESSIONS,
    planned_trials,
    session_folders,
    sessions_of,
)
from sandbox.study.tables.answer_table import answer_columns, answer_rows
from sandbox.study.tables.codebook import codebook
from sandbox.study.tables.column import Row, csv_bytes, csv_rows, names_of
from sandbox.study.tables.exclusions import exclude_person
from sandbox.study.tables.people_table import person_columns, person_row
from sandbox.study.tables.scoring_table import score_columns, score_rows
from sandbox.study.tables.trial_table import FILE_NAMES, trial_columns, trial_rows

MADE_FROM = ".tables.json"
"""File of a study that tells what its tables were made from: bytes of each session's journal."""
SETTLED = 1_000_000_000
"""ns after which a second change of a file cannot have the same time as the first: file systems
tell times in steps of a few milliseconds, some of them in steps of a second."""

Say = Callable[[str], object]


def _silent(text: str) -> None:
    """Says nothing."""


@dataclass(frozen=True)
class _ParticipantRows:
    """A participant's part of the study's tables.

    Attributes:
        person: The participant, as the study's journal has them.
        columns: Names of the columns of each table.
        changed: Size and times of the files that the part was made from, by session.
        settled: The files had not changed for `SETTLED` when they were read.
        rows: The rows, as CSV without the first line, by table.
        trials, excluded: Trials that count, and those of them that are left out.
    """

    person: Participant
    columns: dict[str, list[str]]
    changed: tuple[tuple[Any, ...], ...]
    settled: bool
    rows: dict[str, bytes]
    trials: int
    excluded: int


class StudyTables:
    """The tables of all participants together.

    The first update reads every journal. Later ones read only those that changed, in this program
    or in another one, so that what they cost hardly grows with the study.

    Args:
        study: The study.
        say: Called with a line for every measure that fails.
    """

    def __init__(self, study: StudyFolder, say: Say = _silent) -> None:
        self._study, self._say = study, say
        self._parts: dict[str, _ParticipantRows] = {}

    def update(self) -> dict[str, int]:
        """Brings the tables up to date with all journals.

        Returns:
            Number of participants, of trials that count, and of those that are left out.

        Raises:
            StudyError: A journal is damaged, or a table cannot be written.
        """
        study, design = self._study, self._study.design
        with study.lock():
            tables = _columns(design)
            people = study.participants()
            found = {p.ppid: part for p in people if (part := self._part(p, tables)) is not None}
            self._parts = found
            for name, columns in tables.items():
                rows = b"".join(part.rows[name] for part in found.values())
                write_atomically(study.path / name, csv_bytes([], columns) + rows)
            write_atomically(study.path / "codebook.csv", codebook(design))
            sizes = {f"{ppid}/{c[0]}": c[1] for ppid, part in found.items() for c in part.changed}
            write_atomically(study.path / MADE_FROM, json.dumps(sizes, indent=1).encode() + b"\n")
        return {
            "participants": len(found),
            "trials": sum(part.trials for part in found.values()),
            "excluded": sum(part.excluded for part in found.values()),
        }

    def _part(self, person: Participant, columns: dict[str, list[str]]) -> _ParticipantRows | None:
        """A participant's part; None for one who has not begun."""
        changed = _changed(self._study.path / person.ppid)
        part = self._parts.get(person.ppid)
        made_of = (person, columns, changed)
        if part and part.settled and (part.person, part.columns, part.changed) == made_of:
            return part
        newest = max((t for session in changed for t in session[2:]), default=0)
        settled = time.time_ns() - newest > SETTLED
        return _make_part(self._study, person, columns, changed, settled, self._say)


def rebuild_study(study: StudyFolder, say: Say = _silent) -> dict[str, int]:
    """Makes the tables of all participants anew, from everybody's journals.

    Returns, Raises: See `StudyTables.update`.
    """
    return StudyTables(study, say).update()


def tables_are_outdated(study: Path) -> bool:
    """Whether a study has journals that its tables were not made from.

    A program that was killed in the middle of a session leaves such tables. A copy that lacks a
    journal that its tables were made from is not behind: it cannot be made anew.

    Args:
        study: Folder of a study.
    """
    try:
        sizes = json.loads((study / MADE_FROM).read_bytes())
    except (OSError, ValueError):
        return False
    journals = study.glob(f"*/{SESSIONS}/{JOURNAL}")
    now = {f"{p.parent.parent.name}/{p.parent.name}": p.stat().st_size for p in journals}
    return sizes.keys() <= now.keys() and bool(sizes != now)


def rebuild_session(session: SessionFolder, durable: bool = True, say: Say = _silent) -> None:
    """Writes the tables of an open session anew.

    Raises:
        StudyError: One cannot be written; the older one is still there.
    """
    write_session(
        session.study,
        session.path,
        session.state,
        session.steps,
        session.journal.records,
        durable,
        say,
    )


def write_session(
    study: StudyFolder,
    path: Path,
    state: SessionState,
    steps: Sequence[Step],
    records: Sequence[Record],
    durable: bool = True,
    say: Say = _silent,
) -> None:
    """Writes the tables of a session that need not be open.

    Args:
        study: The study of the session.
        path: Folder of the session.
        state: State that its journal gives.
        steps: Its plan.
        records: Its journal.
        durable: They are on the disk when this returns.
        say: Called with a line for every measure that fails.

    Raises:
        StudyError: One cannot be written; the older one is still there.
    """
    design = study.design
    rows = trial_rows(design, state, path, say)
    person = person_row(design, [state], state.done(steps)[1], rows)
    tables = {
        "trial_results.csv": rows,
        "questionnaires.csv": answer_rows(state),
        "questionnaire_scores.csv": score_rows(design, state),
        "participants.csv": [person],
    }
    names = {"participants.csv": "session_info/participant_details.csv"}
    files = {
        names.get(table, table): csv_bytes(tables[table], columns)
        for table, columns in _columns(design).items()
    }
    settings = {"settings": design.settings, "build": study.build, "design": design.digest}
    files |= {
        "codebook.csv": codebook(design),
        "session_info/settings.json": json.dumps(settings, indent=1, sort_keys=True).encode()
        + b"\n",
        "session_info/log.csv": log_bytes(records),
    }
    for name, data in files.items():
        write_atomically(path / name, data, durable)


def log_bytes(records: Iterable[Record]) -> bytes:
    """UXF's log: time, kind, and the record itself."""
    rows = [
        {
            "timestamp": r["time"],
            "log_type": r["kind"],
            "message": json.dumps(
                {k: v for k, v in r.items() if k not in ("time", "kind")}, ensure_ascii=False
            ),
        }
        for r in records
    ]
    return csv_bytes(rows, ["timestamp", "log_type", "message"])


def _columns(design: Design) -> dict[str, list[str]]:
    """Names of the columns of each table."""
    return {
        "participants.csv": names_of(person_columns(design)),
        "trial_results.csv": names_of(trial_columns(design)),
        "questionnaires.csv": names_of(answer_columns(design)),
        "questionnaire_scores.csv": names_of(score_columns(design)),
    }


def _changed(folder: Path) -> tuple[tuple[Any, ...], ...]:
    """Name, bytes of the journal, and times of change of each session of a participant.

    The times are those of the journal, and of the folders of recordings and of measures, whose
    files are only ever replaced.
    """
    found = []
    for path in session_folders(folder):
        journal = path / JOURNAL
        if journal.exists():
            size = journal.stat().st_size
            watched = (journal, path / "trials", path / "trackers")
            times = (p.stat().st_mtime_ns for p in watched if p.exists())
            found.append((path.name, size, *times))
    return tuple(found)


def _make_part(
    study: StudyFolder,
    person: Participant,
    columns: dict[str, list[str]],
    changed: tuple[tuple[Any, ...], ...],
    settled: bool,
    say: Say,
) -> _ParticipantRows | None:
    """A participant's part of the tables, from their journals."""
    design = study.design
    sessions = sessions_of(study, person)
    if not sessions:
        return None
    trials: list[Row] = []
    answers: list[Row] = []
    scores: list[Row] = []
    for session in sessions:
        inside = session.path.relative_to(study.path).as_posix()
        for row in trial_rows(design, session.state, session.path, say):
            trials.append(row | {name: f"{inside}/{row[name]}" for name in FILE_NAMES})
        answers += answer_rows(session.state)
        scores += score_rows(design, session.state)
    states = [session.state for session in sessions]
    exclude_person(design, states, trials)
    planned = planned_trials(study, person)
    rows = {
        "participants.csv": [person_row(design, states, planned, trials, design.sessions)],
        "trial_results.csv": trials,
        "questionnaires.csv": answers,
        "questionnaire_scores.csv": scores,
    }
    counted = [row for row in trials if row["counted"] and not row["practice"]]
    return _ParticipantRows(
        person,
        columns,
        changed,
        settled,
        {name: csv_rows(rows[name], names) for name, names in columns.items()},
        len(counted),
        sum(row["excluded"] for row in counted),
    )
