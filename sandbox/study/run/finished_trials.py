"""Brings the files of finished trials up to date: tables, measures and compressed recordings."""

from __future__ import annotations

from collections.abc import Callable

from sandbox.study.measures.kept import kept_lines
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.tables.frames import complete_tables


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
