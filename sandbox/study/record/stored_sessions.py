"""Read-only access to the sessions in a study's folder."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from sandbox.study.design.design import Design
from sandbox.study.design.session_plan import Step, session_plan, trials_of
from sandbox.study.record.copies import JOURNAL, session_folders
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.record.journal import Record, read_journal
from sandbox.study.record.notes import person_notes
from sandbox.study.record.records import RUNS
from sandbox.study.record.state import SessionState, decisions_on


@dataclass(frozen=True)
class StoredSession:
    """A session that has begun.

    Attributes:
        person: The participant.
        number: Session number, from 1.
        path: Folder of the session.
        records: Records of the session.
        state: State of the session according to its records and to the decisions about it.
        notes: Notes about the participant that concern this session or no single session.
    """

    person: Participant
    number: int
    path: Path
    records: list[Record]
    state: SessionState
    notes: tuple[Record, ...] = ()


def session_path(study: Path, ppid: str, session: int = 1) -> Path:
    """Folder of a session."""
    return study / ppid / f"S{session:03d}"


def has_finished(study: StudyFolder, person: Participant) -> bool:
    """True if a participant has reached the end of every session of the design.

    Raises:
        StudyError: A journal is damaged.
    """
    ended = sum(session.state.complete for session in sessions_of(study, person))
    # More sessions than planned may have ended, if `--force-upgrade` reduced their number.
    return ended >= study.design.sessions


def sessions_of(study: StudyFolder, person: Participant) -> list[StoredSession]:
    """The sessions that a participant has begun, in order.

    Raises:
        StudyError: A journal is damaged.
    """
    sessions = []
    notes = person_notes(study.path, person.ppid)
    for path in session_folders(study.path / person.ppid):
        records, number = read_journal(path / JOURNAL), int(path.name[1:])
        state = SessionState.of(records, decisions_on(notes, number))
        if state.start:
            about = tuple(n for n in notes if n.get("session") in (None, number))
            sessions.append(StoredSession(person, number, path, records, state, about))
    return sessions


def all_sessions(study: StudyFolder) -> Iterator[tuple[Participant, list[StoredSession]]]:
    """All participants who have begun, in order of arrival, with their sessions.

    Raises:
        StudyError: A journal is damaged.
    """
    for person in study.participants():
        sessions = sessions_of(study, person)
        if sessions:
            yield person, sessions


def plan_of(study: StudyFolder, session: StoredSession) -> list[Step]:
    """All steps of a session."""
    return session_plan(design_of(study, session), session.person.number, session.number)


def design_of(study: StudyFolder, session: StoredSession) -> Design:
    """The design by which the last run of a session was made."""
    runs = [r for r in session.records if r["kind"] in RUNS]
    return study.design_of(runs[-1]["design"])


def planned_trials(study: StudyFolder, person: Participant, begun: Sequence[StoredSession]) -> int:
    """Number of trials of a participant in all their sessions, practice included.

    Args:
        study: The study.
        person: The participant.
        begun: The participant's sessions that have begun; each has the plan of its own design.
    """
    plans = {
        s + 1: session_plan(study.design, person.number, s + 1)
        for s in range(study.design.sessions)
    }
    plans |= {session.number: plan_of(study, session) for session in begun}
    return sum(len(trials_of(plan)) for plan in plans.values())
