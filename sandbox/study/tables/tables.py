"""Derives the tables of a study from the records and frames of its sessions: `tables/*.csv`.

All values of the tables follow from the records and frames, so the tables may be deleted and made
again at any time. Each table is written as a whole, atomically. Tables are made at the end of a
session, before a report, and by `sandbox study tables`.
"""

from __future__ import annotations

import csv
import io
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from models.errors import InputError, StudyError
from models.message import counted
from sandbox.recording.recording import stored
from sandbox.study.record.durable_files import (
    locked,
    make_folder,
    remove_unfinished,
    write_atomically,
)
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.record.journal import now
from sandbox.study.record.stored_sessions import StoredSession, all_sessions, planned_trials
from sandbox.study.record.trial_files import frames_of, pack
from sandbox.study.tables.codebook import codebook, columns_by_table, facts_of
from sandbox.study.tables.column import (
    TABLES,
    UXF_NAMES,
    Column,
    Row,
    csv_bytes,
    is_empty,
    names_of,
)
from sandbox.study.tables.frame_table import make_frames
from sandbox.study.tables.rows import answer_rows, event_rows, participant_row, score_rows
from sandbox.study.tables.trial_table import FILE_NAMES, exclude_person, trial_rows

if TYPE_CHECKING:
    from sandbox.study.record.session_folder import SessionFolder

CODEBOOK = "codebook.csv"
BEFORE = "before-"
"""Prefix of folders in the folder of tables. Each has the tables as they were before the
experimenter accepted a loss of records."""

Say = Callable[[str], object]


def _silent(text: str) -> None:
    """Prints nothing."""


def make_tables(
    study: StudyFolder,
    say: Say = _silent,
    mine: Path | None = None,
    uxf_names: bool = False,
    compare: bool = False,
) -> dict[str, int]:
    """Makes all tables of a study.

    First, missing frames of trials are made by replays of their recordings, except in sessions that
    another program has open.

    Args:
        study: The study.
        say: Called with a line for every file that cannot be made.
        mine: Folder of a session that this program has open.
        uxf_names: True names columns as UXF does; see `UXF_NAMES`.
        compare: True reports existing tables that differ from the records, such as after a change
            by hand.

    Returns:
        Numbers of `participants`, of counted `trials` without practice, and of `excluded` trials
        among these.

    Raises:
        StudyError: A record is damaged, or a table cannot be written.
    """
    folder = study.path / TABLES
    make_folder(folder)
    # If two programs make tables at the same time, the program that reads last must write last.
    # The lock ensures this.
    with locked(folder / ".lock", wait=True):
        remove_unfinished(folder)
        people = _people(study)
        for _, sessions in people:
            for session in sessions:
                _complete_frames(session, say, session.path == mine)
        rows = _rows(study, people, say)
        for name, data in _files(study, rows, UXF_NAMES if uxf_names else {}).items():
            if compare and (differs := _difference(folder / name, data)):
                say(f"{TABLES}/{name} differed from the records, and was made again: {differs}")
            write_atomically(folder / name, data)
    counts = [r for r in rows["trials.csv"] if r["counted"] and not r["practice"]]
    return {
        "participants": len(rows["participants.csv"]),
        "trials": len(counts),
        "excluded": sum(row["excluded"] for row in counts),  # any order: whole numbers
    }


def bring_up_to_date(session: SessionFolder, say: Say, tables: bool = True) -> None:
    """Compresses the recordings of a session, seals its journal, and makes the study's tables.

    If a file cannot be written, the error is printed. The next call after the session is opened
    again writes the file.

    Args:
        session: The session.
        say: Prints a line.
        tables: False if the caller makes the tables.
    """
    try:
        for attempts in session.state.attempts.values():
            for attempt in attempts:
                if attempt.end is not None:
                    pack(session.path / attempt.start["file"])
        head, count = session.seal(), len(session.journal.records)
        say(f"{session.person.ppid}, session {session.number}: {count} records, digest {head}")
        if tables:
            make_tables(session.study, say, session.path)
    except InputError as error:
        say(f"tables are not up to date: {error}")


def _difference(path: Path, data: bytes) -> str:
    """Text on the first difference between an existing table and the table made from the records.

    Empty if there is none. Columns that only one of the tables has are not compared, and neither is
    the codebook, since another version of the program may have written them.
    """
    if not path.exists() or path.name == CODEBOOK:
        return ""
    theirs = {new: old for old, new in UXF_NAMES.items()}
    there, here = (
        [
            {theirs.get(name, name): cell for name, cell in row.items() if name is not None}
            for row in csv.DictReader(io.StringIO(text.decode(errors="replace"), newline=""))
        ]
        for text in (path.read_bytes(), data)
    )
    for number, (old, new) in enumerate(zip(there, here, strict=False), start=2):
        for name in old.keys() & new.keys():
            if old[name] != new[name]:
                return f"row {number}, {name}: {old[name]!r}, not {new[name]!r} as in the records"
    rows = f"{counted(len(there), 'row')}, not {len(here)} as in the records"
    return rows if len(there) != len(here) else ""


def table_files(study: StudyFolder) -> dict[str, bytes]:
    """The tables of a study by name, made from its present records and frames.

    Raises:
        StudyError: A record is damaged.
    """
    return _files(study, _rows(study, _people(study), _silent), {})


def keep_tables(study: StudyFolder) -> Path:
    """Copies the tables of a study, before they are made again from fewer records.

    A folder of copies is named by the current time in ms. If it exists, its copies are not
    overwritten.

    Returns:
        The folder of the copies.

    Raises:
        StudyError: A table cannot be copied.
    """
    tables = study.path / TABLES
    folder = tables / f"{BEFORE}{now().replace(':', '')}"
    make_folder(folder)
    for path in sorted(tables.glob("*.csv")):
        if not (folder / path.name).exists():
            write_atomically(folder / path.name, path.read_bytes())
    return folder


def _people(study: StudyFolder) -> list[tuple[Participant, list[StoredSession]]]:
    """All people who have begun, sorted by site, number and pseudonym.

    Two people may have the same number, since a freed number is assigned again.
    """
    return sorted(all_sessions(study), key=lambda x: (x[0].site, x[0].number, x[0].ppid))


def _complete_frames(session: StoredSession, say: Say, mine: bool) -> None:
    """Makes the missing frames of the finished attempts of a session."""
    missing = [
        recording
        for attempts in session.state.attempts.values()
        for attempt in attempts
        if attempt.end is not None
        and stored(recording := session.path / attempt.start["file"]).exists()
        and not frames_of(recording).exists()
    ]
    if not missing:
        return
    where = f"{session.person.ppid}, session {session.number}"
    with ExitStack() as held:
        if not mine:
            try:
                held.enter_context(locked(session.path / ".lock", wait=False))
            except StudyError:
                say(f"{where}: open in another program, which makes its frames")
                return
        for recording in missing:
            if differs := make_frames(recording):
                say(
                    f"{where}, {recording.stem}: what pushed the objects is unknown, because a "
                    f"replay did not give the recorded states. What differs: {differs}"
                )


def _rows(
    study: StudyFolder, people: Sequence[tuple[Participant, list[StoredSession]]], say: Say
) -> dict[str, list[Row]]:
    """Rows of every table."""
    rows: dict[str, list[Row]] = {name: [] for name in columns_by_table(study.design)}
    empty: Counter[str] = Counter()
    for person, sessions in people:
        for name, some in _rows_of(study, person, sessions, empty).items():
            rows[name] += some
    for reason, number in empty.items():
        say(f"empty in {counted(number, 'trial')}: {reason}")
    return rows


def _rows_of(
    study: StudyFolder, person: Participant, sessions: Sequence[StoredSession], empty: Counter[str]
) -> dict[str, list[Row]]:
    """Rows of a participant in every table."""
    design, designs = study.design, study.design_of
    trials: list[Row] = []
    for session in sessions:
        inside = PurePosixPath(session.path.relative_to(study.path).as_posix())
        own = trial_rows(design, session.state, session.path, empty, designs(session.state.design))
        for row in own:
            row |= {name: str(inside / row[name]) for name in FILE_NAMES if row[name]}
        trials += own
    states = [session.state for session in sessions]
    exclude_person(design, states, trials)
    planned = planned_trials(study, person, sessions)
    return {
        "participants.csv": [participant_row(design, states, planned, trials, design.sessions)],
        "trials.csv": trials,
        "answers.csv": [row for session in sessions for row in answer_rows(session, designs)],
        "scores.csv": score_rows(states, designs),
        "events.csv": [row for session in sessions for row in event_rows(session)],
    }


def _files(
    study: StudyFolder, rows: Mapping[str, Sequence[Row]], names: Mapping[str, str]
) -> dict[str, bytes]:
    """Tables by name, without columns that are empty in all rows, and their codebook."""
    design = study.design
    columns = {name: _filled(of, rows[name]) for name, of in columns_by_table(design, rows).items()}
    files = {name: csv_bytes(rows[name], names_of(of), names) for name, of in columns.items()}
    return {**files, CODEBOOK: codebook(design, columns, names, facts_of(study))}


def _filled(columns: Sequence[Column], rows: Sequence[Row]) -> list[Column]:
    """The columns that have a value in some row; all columns if the table has no rows."""
    return [c for c in columns if not rows or any(not is_empty(row.get(c.name)) for row in rows)]
