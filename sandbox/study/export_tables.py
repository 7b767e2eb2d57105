"""All tables of a study that nobody has open, made from its journals."""

from __future__ import annotations

from sandbox.study.folder import StudyFolder
from sandbox.study.journal import read_journal
from sandbox.study.plan import session_plan
from sandbox.study.session_folder import session_path
from sandbox.study.state import SessionState
from sandbox.study.tables import rebuild_study, write_session


def rebuild_all(study: StudyFolder) -> dict[str, SessionState]:
    """Makes the tables of every session, and those of the study.

    Returns:
        What the journals say, by pseudonym.

    Raises:
        StudyError: A journal is damaged, or a table cannot be written.
    """
    found = {}
    for person in study.participants():
        path = session_path(study.path, person.ppid)
        if not (path / "journal.jsonl").exists():
            continue
        records = read_journal(path / "journal.jsonl")
        state = SessionState.of(records)
        if not state.start:
            continue
        (path / "session_info").mkdir(exist_ok=True)
        write_session(study, path, state, session_plan(study.design, person.number), records)
        found[person.ppid] = state
    rebuild_study(study)
    return found
