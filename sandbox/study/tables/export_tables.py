"""All tables of a study that nobody has open, made from its journals."""

from __future__ import annotations

from sandbox.study.record.folder import StudyFolder
from sandbox.study.record.stored_sessions import StoredSession, all_sessions, plan_of
from sandbox.study.tables.tables import rebuild_study, write_session


def rebuild_all(study: StudyFolder) -> dict[str, list[StoredSession]]:
    """Makes the tables of every session, and those of the study.

    Returns:
        Everybody's sessions, by pseudonym.

    Raises:
        StudyError: A journal is damaged, or a table cannot be written.
    """
    found = {}
    for person, sessions in all_sessions(study):
        for session in sessions:
            (session.path / "session_info").mkdir(exist_ok=True)
            write_session(
                study, session.path, session.state, plan_of(study, session), session.records
            )
        found[person.ppid] = sessions
    rebuild_study(study)
    return found
