"""State of a session according to its journal: finished steps, counted attempts, exclusions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

from models.errors import StudyError
from models.json_input import checked
from sandbox.session.own_layouts import Layouts
from sandbox.study.design.plan import ABOUT_PERSON, Step, TrialStep
from sandbox.study.record.chain import Record
from sandbox.study.record.session_clock import RUNS, SessionClock
from sandbox.trial.result import TrialResult


@dataclass
class Attempt:
    """One attempt of a trial.

    Attributes:
        start: Its `trial_start` record.
        end: Its `trial_end` record; None if it was broken off.
        set_aside: Reason why the finished attempt does not count; empty if it may count.
    """

    start: Record
    end: Record | None = None
    set_aside: str = ""

    @property
    def result(self) -> TrialResult:
        """The result of a finished attempt, as far as the journal stores it.

        Raises:
            RecordingError: The stored result is damaged.
        """
        assert self.end is not None
        where = f"trial_end of trial {self.end['trial']}, attempt {self.end['attempt']}"
        return TrialResult.from_json(self.end["result"], where)


@dataclass
class SessionState:
    """State of a session according to its journal.

    Attributes:
        start: The `session_start` record; empty before the session has begun.
        finished: Ids of finished or skipped steps.
        attempts: Attempts by trial number, in order.
        skipped: Reasons for skipping, by step.
        excluded: Reasons for exclusion, by trial number.
        excluded_participant: Reason for excluding the participant; empty if not excluded.
        design: Digest of the design that the session is run by now.
        answers: Records of completed forms by step, in order; the last one of a step counts.
        asked_by: Digest of the design that asked each of these forms, by step.
        drafts: Answers in unfinished forms, by step.
        consent: True if the participant consented; None before the question.
        calibration: Calibration of the hand over a Leap, in the format of `sandbox paalm
            calibrate`; None uses an average hand.
        learned: Layouts of five fingers that the last trial to find some has left, by hand.
        complete: True if the session reached its planned end.
        recordings: Digests of recordings by file (see `sandbox.study.record.file_digests`).
        tables: Digests of the tables derived from a recording, by name of the table, by recording.
        seconds: Time of each record since the session's start, s, by number of the record.
        clock_steps: Steps of the wall clock during the session, s.
    """

    start: Record = field(default_factory=dict)
    finished: set[str] = field(default_factory=set)
    attempts: dict[int, list[Attempt]] = field(default_factory=dict)
    skipped: dict[str, str] = field(default_factory=dict)
    excluded: dict[int, str] = field(default_factory=dict)
    excluded_participant: str = ""
    design: str = ""
    answers: dict[str, Record] = field(default_factory=dict)
    asked_by: dict[str, str] = field(default_factory=dict)
    drafts: dict[str, dict[str, Any]] = field(default_factory=dict)
    consent: bool | None = None
    calibration: dict[str, Any] | None = None
    learned: dict[str, Layouts] = field(default_factory=dict)
    complete: bool = False
    recordings: dict[str, dict[str, Any] | None] = field(default_factory=dict)
    tables: dict[str, dict[str, str]] = field(default_factory=dict)
    seconds: SessionClock = field(default_factory=SessionClock)
    clock_steps: list[float] = field(default_factory=list)

    @classmethod
    def of(cls, records: Iterable[Record]) -> SessionState:
        """Computes the state after some records."""
        state = cls()
        for record in records:
            state.take(record)
        return state

    def take(self, record: Record) -> None:
        """Updates the state by one record; kinds of later versions are ignored."""
        self.seconds.take(record)
        if record["kind"] in RUNS:
            self.design = record.get("design", "")
        if "recording" in record and "file" in record:
            self.recordings[record["file"]] = record["recording"]
        match record["kind"]:
            case "session_start":
                self.start = record
            case "clock_step":
                self.clock_steps.append(record["seconds"])
            case "tables":
                self.tables[record["file"]] = record["files"]
            case "moved":
                self.start = {**self.start, "study": record["study"], "ppid": record["ppid"]}
                self.recordings |= record["recordings"]
            case "trial_start":
                self.attempts.setdefault(record["trial"], []).append(Attempt(record))
            case "trial_end":
                self._attempt(record).end = record
                self.learned |= _learned(record)
                self.finished.add(record["step"])
            case "trial_broken":
                # What the experimenter excluded was this attempt; the trial begins anew.
                self.excluded.pop(record["trial"], None)
            case "repeat":
                self._set_aside(record)
            case "skip":
                self.skipped[record["step"]] = record["reason"]
                self.finished.add(record["step"])
            case "exclude":
                self._exclude(record)
            case "draft":
                self.drafts.setdefault(record["step"], {})[record["item"]] = record["answer"]
            case "answers":
                self.answers[record["step"]] = record
                self.asked_by[record["step"]] = self.design
                self.finished.add(record["step"])
            case "step_done":
                self.finished.add(record["step"])
            case "consent":
                self.consent = bool(record["agreed"])
                if self.consent:
                    self.finished.add(record["step"])
            case "calibration":
                # In an anonymous copy, the record has no calibration.
                self.calibration = record.get("calibration")
                self.finished.add(record["step"])
            case "session_end":
                self.complete = bool(record["complete"])

    @property
    def about_person(self) -> dict[str, Any] | None:
        """Answers to the questions about the person, by item; None without them."""
        record = self.answers.get(ABOUT_PERSON)
        return None if record is None else record["answers"]

    def counted(self, trial: int) -> Attempt | None:
        """The counted attempt of a trial: the last finished one that was not set aside."""
        finished = [
            a for a in self.attempts.get(trial, []) if a.end is not None and not a.set_aside
        ]
        return finished[-1] if finished else None

    def open_attempt(self) -> Attempt | None:
        """The last attempt, if it has no end."""
        started = [a for some in self.attempts.values() for a in some]
        last = max(started, key=lambda a: a.start["n"], default=None)
        return last if last and last.end is None else None

    def last_finished(self, steps: Sequence[Step]) -> TrialStep | None:
        """The trial whose attempt ended last; None before one has."""
        ended = [a.end for some in self.attempts.values() for a in some if a.end is not None]
        last = max(ended, key=lambda end: end["n"], default={"trial": None})
        trials = (step for step in steps if isinstance(step, TrialStep))
        return next((step for step in trials if step.number == last["trial"]), None)

    def next_step(self, steps: Sequence[Step]) -> Step | None:
        """The first step that is not finished; None at the end."""
        return next((step for step in steps if step.id not in self.finished), None)

    def done(self, steps: Sequence[Step]) -> tuple[int, int]:
        """Number of finished or skipped trials, and number of all trials."""
        trials = [step for step in steps if isinstance(step, TrialStep)]
        return sum(step.id in self.finished for step in trials), len(trials)

    def _attempt(self, record: Record) -> Attempt:
        attempts = self.attempts.get(record["trial"], [])
        if not 1 <= record["attempt"] <= len(attempts):
            raise StudyError(
                "the journal has the end of an attempt without its start",
                where=f"record {record['n']}",
                got=f"trial {record['trial']}, attempt {record['attempt']}",
                expected=f"one of {len(attempts)} attempts",
                remedy="Restore the journal from a backup",
            )
        return attempts[record["attempt"] - 1]

    def _set_aside(self, record: Record) -> None:
        for attempt in self.attempts.get(record["trial"], []):
            attempt.set_aside = attempt.set_aside or record["reason"] or "repeated"
        self.finished.discard(record["step"])
        self.skipped.pop(record["step"], None)
        self.excluded.pop(record["trial"], None)
        self.complete = False

    def _exclude(self, record: Record) -> None:
        if record.get("trial") is None:
            self.excluded_participant = record["reason"]
        else:
            self.excluded[record["trial"]] = record["reason"]


def _learned(record: Record) -> dict[str, Layouts]:
    """What a `trial_end` record says that later trials of its session know."""
    return checked(
        record["result"].get("learned", {}),
        dict[str, Layouts],
        StudyError,
        what="the journal has layouts of fingers that cannot be read",
        where=f"record {record['n']}",
        remedy="Restore the journal from a backup",
    )
