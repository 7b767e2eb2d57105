"""Brings the files of a session up to date: tables, measures, compressed recordings, its seal."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from models.errors import InputError
from sandbox.study.measures.kept import kept_lines
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.witness import add_witnesses, witnesses_of
from sandbox.study.tables.frames import complete_tables
from sandbox.study.tables.tables import StudyTables, rebuild_session


def complete_trials(session: SessionFolder, say: Callable[[str], object]) -> None:
    """Builds what is missing of the finished attempts of a session, and records its digests.

    Args:
        session: The session.
        say: Prints a line.

    Raises:
        StudyError: A file cannot be written.
    """
    differs = []
    attempts = [a for some in session.state.attempts.values() for a in some if a.end is not None]
    for attempt in attempts:
        file = attempt.start["file"]
        # Tables without a record may be those of a program that was killed.
        anew = file not in session.state.tables
        rebuilt = complete_tables(session.path / file, session.path / "trackers", anew)
        for notice in rebuilt.notices:
            say(notice)
        differs.append(rebuilt.differs)
        if rebuilt.built:
            session.note_tables(attempt)
        session.pack(file)
    for line in kept_lines(differs):
        say(line)


def bring_up_to_date(
    session: SessionFolder,
    tables: StudyTables,
    say: Callable[[str], object],
    seal: bool = True,
    witness: Path | None = None,
) -> None:
    """Builds the tables of a session and of its study, and missing tables of trials.

    What cannot be built or written is said, and built when the session is opened again.

    Args:
        session: The session.
        tables: Tables of the study.
        say: Prints a line.
        seal: True records the journal's end in the journal of the study before, says its last
            digest, and writes the witnesses.
        witness: File to which the witnesses are appended; None writes none.
    """
    try:
        complete_trials(session, say)
        if seal:
            head, count = session.seal(), len(session.journal.records)
            say(f"{session.person.ppid}, session {session.number}: {count} records, digest {head}")
            if witness is not None:
                add_witnesses(witness, witnesses_of(session))
        rebuild_session(session, say=say)
        tables.update()
    except InputError as error:
        say(f"tables are not up to date: {error}")
