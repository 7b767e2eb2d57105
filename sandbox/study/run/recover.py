"""Recovers sessions whose journal has lost records, as somebody decides.

Whole recordings without a record are taken in as finished trials, or set aside. Nothing else that
was lost comes back: answers are asked for again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from sandbox.recording.recording import load_recording
from sandbox.study.design.plan import TrialStep, session_plan, trials_of
from sandbox.study.record.folder import Participant, StudyFolder
from sandbox.study.record.journal import read_journal
from sandbox.study.record.leftovers import logged_records, whole_leftovers
from sandbox.study.record.recorded_result import finished_result
from sandbox.study.record.session_folder import SessionFolder
from sandbox.study.record.state import SessionState
from sandbox.study.record.stored_sessions import JOURNAL, session_folders
from sandbox.study.record.trial_files import TRIALS
from sandbox.study.run.finished_trials import complete_trials
from sandbox.study.tables.tables import StudyTables, rebuild_session
from sandbox.trial.result import TrialResult

Say = Callable[[str], object]


@dataclass(frozen=True)
class Found:
    """A whole recording without a record.

    Attributes:
        file: The recording, without `.gz`.
        trial: The trial of the plan that it is of; None if it cannot be taken in.
        result: Its result; None if it cannot be taken in.
        why_not: Why it cannot be taken in; empty if it can.
    """

    file: str
    trial: TrialStep | None
    result: TrialResult | None
    why_not: str = ""


@dataclass(frozen=True)
class Loss:
    """Losses of a session.

    Attributes:
        person, session: The participant, and the number of the session.
        records: Number of records that the log has and the journal has not.
        found: Whole recordings without a record.
    """

    person: Participant
    session: int
    records: int
    found: tuple[Found, ...]


def losses(study: StudyFolder) -> Iterator[Loss]:
    """Losses of the sessions of a study that have lost something.

    Raises:
        StudyError: A journal is damaged.
    """
    for person in study.participants():
        for path in session_folders(study.path / person.ppid):
            # Before the journal, to which a session that is open adds first.
            logged = logged_records(path)
            journal = path / JOURNAL
            records = read_journal(journal) if journal.exists() else []
            state, number = SessionState.of(records), int(path.name[1:])
            plan = trials_of(session_plan(study.design, person.number, number))
            found = tuple(
                _found(person, number, plan, state, path / file)
                for file in whole_leftovers(path, state)
            )
            lost = max(0, logged - len(records))
            if found or lost:
                yield Loss(person, number, lost, found)


def recover(study: StudyFolder, loss: Loss, take_in: bool, reason: str, say: Say) -> None:
    """Takes in or sets aside what a session has lost, and builds its tables again.

    Args:
        study: The study.
        loss: What was lost; see `losses`.
        take_in: True takes in what can be taken in; False sets everything aside.
        reason: Reason, for the journal.
        say: Prints a line.

    Raises:
        StudyError: The session is open, or cannot be written.
    """
    with SessionFolder(study, loss.person, loss.session, recovering=True) as session:
        session.accept_loss(loss.records, reason)
        for found in loss.found:
            trial, result = found.trial, found.result
            # Of two attempts at one trial, the first one counts.
            counted = trial is not None and session.state.counted(trial.number) is not None
            if take_in and trial is not None and result is not None and not counted:
                session.take_in(trial, found.file, result)
                say(f"{found.file}: taken in as trial {trial.number}")
            else:
                session.set_aside(found.file, reason)
                say(f"{found.file}: set aside")
        complete_trials(session, say)
        session.seal()
        rebuild_session(session, say=say)
        StudyTables(study, say).update()


def _found(
    person: Participant, session: int, plan: list[TrialStep], state: SessionState, path: Path
) -> Found:
    """A recording, with the trial that it is of if it fits the plan and nothing counts yet."""
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
        return Found(file, None, None, "the plan has another trial of this number")
    if state.counted(trial.number) is not None:
        return Found(file, None, None, "another attempt of this trial counts")
    return Found(file, trial, result)
