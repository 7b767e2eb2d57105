"""Brings the files of a session up to date: compressed recordings, its seal, the tables."""

from __future__ import annotations

from collections.abc import Callable

from models.errors import InputError
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.trial_files import pack
from sandbox.study.tables.tables import make_tables


def bring_up_to_date(
    session: SessionFolder, say: Callable[[str], object], tables: bool = True
) -> None:
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
