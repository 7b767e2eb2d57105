"""Decisions about participants after their sessions. Each is a note in the participant's folder.

Exclusions, releases and remarks can be undone, and delete no data. An accepted loss is final: a
session whose journal has lost lines is continued without them. A complete recording without a
record is added as a trial if it fits the plan, and is set aside otherwise. Forms whose answers were
lost are asked again. The earlier tables remain in `tables/before-DATE`; they may have the lost
answers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from models.errors import StudyError
from sandbox.recording.recording import load_recording
from sandbox.study.design.session_plan import TrialStep, session_plan, trials_of
from sandbox.study.record.copies import JOURNAL, session_folders
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.record.journal import readable_records
from sandbox.study.record.notes import INCLUDE, broken_seals, seals_of
from sandbox.study.record.records import END
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import all_sessions, sessions_of
from sandbox.study.record.trial_files import TRIALS, finished_result, whole_leftovers
from sandbox.study.tables.tables import bring_up_to_date, keep_tables
from sandbox.trial.result import TrialResult

Say = Callable[[str], object]


def decide(
    study: StudyFolder,
    ppid: str,
    kind: str,
    reason: str,
    session: int | None = None,
    trial: int | None = None,
) -> str:
    """Writes a note with a decision or a remark about a participant or one of their trials.

    If a participant whose number was freed is included again, `StudyFolder.include` gives them a
    number.

    Args:
        study: The study.
        ppid: Pseudonym of the participant.
        kind: `EXCLUDE`, `INCLUDE` or `REMARK`.
        reason: Reason for the decision, or the text of the remark, for the tables.
        session: Session of the trial.
        trial: Number of the trial; None for the participant.

    Returns:
        A sentence on the number that the participant has again; empty if none was freed.

    Raises:
        StudyError: There is no such participant or trial, or the note cannot be written.
    """
    person = study.find(ppid)
    sessions = sessions_of(study, person)
    of = next((s for s in sessions if s.number == session), None)
    if trial is not None and (of is None or trial not in of.state.attempts):
        known = ", ".join(str(n) for n in sorted(of.state.attempts)) if of else ""
        raise StudyError(
            "no such trial has begun",
            where=f"participant {ppid}, session {session}",
            got=trial,
            expected=known or ", ".join(f"session {s.number}" for s in sessions) or None,
        )
    after = {str(s.number): len(s.records) for s in sessions}
    about = {"reason": reason, "session": session, "trial": trial, "after": after}
    if kind != INCLUDE or trial is not None or not study.is_released(ppid):
        study.note_about(ppid, kind, **about)
        return ""
    begun = any(session.state.attempts for session in sessions)
    now, other = study.include(person, begun, **about)
    if other is None:
        return f"{ppid} has number {now.number} again"
    given = f"number {person.number} was given to {other.ppid} meanwhile"
    if begun:
        return f"{given}: both participants have the orders of this number, and both count"
    return f"{given}: {ppid} has number {now.number} now, and its orders"


@dataclass(frozen=True)
class Found:
    """A complete recording to which no record of its session refers.

    Attributes:
        file: The recording, without `.gz`.
        trial: The trial of the plan to which the recording can be added; None if there is none.
        result: Result at the end of the recording; None if it cannot be added.
        why_not: Reason why the recording cannot be added; empty if it can be added.
    """

    file: str
    trial: TrialStep | None
    result: TrialResult | None
    why_not: str = ""


@dataclass(frozen=True)
class Loss:
    """Losses of a session.

    Attributes:
        person: The participant.
        session: Number of the session.
        records: Number of lost lines of the journal. This is the larger of two numbers: sealed
            lines that are missing at the end, and lines from the first damaged line to the end.
        damaged: Number of the first damaged line, from 1; None if no line is damaged.
        unlike: True if sealed lines have changed.
        found: Complete recordings without a record.
    """

    person: Participant
    session: int
    records: int
    unlike: bool
    damaged: int | None
    found: tuple[Found, ...]


def losses(study: StudyFolder) -> Iterator[Loss]:
    """Yields the losses of each session of a study that has lost data or has a damaged journal.

    Raises:
        StudyError: Notes are damaged, or a journal cannot be read.
    """
    for person in study.participants():
        for path in session_folders(study.path / person.ppid):
            journal = path / JOURNAL
            records, behind = readable_records(journal)
            state, number = SessionState.of(records), int(path.name[1:])
            plan = trials_of(session_plan(study.design, person.number, number))
            found = tuple(
                _found(person, number, plan, state, path / file)
                for file in whole_leftovers(path, state)
            )
            lacks, unlike = broken_seals(records, seals_of(study.path, person.ppid, number))
            if found or lacks or unlike or behind:
                damaged = len(records) + 1 if behind else None
                yield Loss(person, number, max(lacks, behind), unlike, damaged, found)


def unsealed(study: StudyFolder) -> list[str]:
    """Ended sessions without a seal, such as in a copy of a study without its notes.

    Raises:
        StudyError: A journal is damaged.
    """
    return [
        f"{person.ppid}, session {session.number}"
        for person, sessions in all_sessions(study)
        for session in sessions
        if any(record["kind"] == END for record in session.records)
        and not seals_of(study.path, person.ppid, session.number)
    ]


def accept_loss(study: StudyFolder, loss: Loss, reason: str, say: Say) -> None:
    """Accepts the losses of a session, adds fitting recordings, and builds the tables again.

    Raises:
        StudyError: The session is open, or cannot be written.
    """
    with SessionFolder(study, loss.person, loss.session, recovering=True) as session:
        say(f"the earlier tables are in {keep_tables(study)}")
        if session.damaged is not None:
            say(f"a copy of the damaged journal is {session.damaged}")
        session.accept_loss(loss.records, loss.unlike, reason)
        for found in loss.found:
            trial, result = found.trial, found.result
            # If there are two recordings of one trial, the first one is added.
            counted = trial is not None and session.state.counted(trial.number) is not None
            if trial is not None and result is not None and not counted:
                session.take_in(trial, found.file, result)
                say(f"{found.file}: added as trial {trial.number}")
            else:
                session.set_aside(found.file, reason)
                say(f"{found.file}: set aside")
        bring_up_to_date(session, say)


def _found(
    person: Participant, session: int, plan: list[TrialStep], state: SessionState, path: Path
) -> Found:
    """A recording, with its trial if it fits the plan and no attempt at the trial counts yet."""
    file = f"{TRIALS}/{path.name}"
    result = finished_result(path)
    if result is None:
        return Found(file, None, None, "the attempt was broken off")
    header = load_recording(path).header
    about = header.get("study", {})
    trial = next((t for t in plan if t.number == about.get("trial")), None)
    mine = (person.ppid, session)
    if (about.get("ppid"), about.get("session")) != mine or trial is None:
        return Found(file, None, None, "it is of another participant or session")
    if (header["settings"]["seed"], about.get("levels")) != (trial.seed, trial.levels):
        return Found(file, None, None, "the plan has another trial with this number")
    if state.counted(trial.number) is not None:
        return Found(file, None, None, "another attempt at this trial counts")
    return Found(file, trial, result)
