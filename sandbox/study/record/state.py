"""State of a session according to its journal: finished steps, counted attempts, exclusions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from typing import Any

from models.errors import StudyError
from models.json_input import checked
from sandbox.session.own_layouts import Layouts
from sandbox.study.design.session_plan import (
    ABOUT_PERSON,
    BreakStep,
    InstructionStep,
    Step,
    TrialStep,
)
from sandbox.study.record import records
from sandbox.study.record.journal import Record
from sandbox.study.record.notes import EXCLUDE, INCLUDE
from sandbox.trial.result import TrialResult


class SessionClock:
    """Time of every record since the start of the session, s.

    As long as the machine is not restarted, times are differences of the monotonic clock, which
    does not change when the wall clock is set. The monotonic clock restarts with the machine. So
    the time from the last record before a restart to the first record after it is taken from the
    wall clock; it is 0 if the wall clock went backwards.
    """

    def __init__(self) -> None:
        self.of: dict[int, float] = {}
        self._offset: float | None = None
        self._boot = ""
        self._last: dict[str, Any] = {}

    def __getitem__(self, n: int) -> float:
        return self.of[n]

    def take(self, record: dict[str, Any]) -> None:
        """Processes the next record of the journal."""
        if record["kind"] in records.RUNS:
            self._begin(record)
        if self._offset is not None:
            self.of[record["n"]] = round(record["clock"] + self._offset, 6)
            self._last = record

    def _begin(self, record: dict[str, Any]) -> None:
        boot = record.get("boot", "")
        if self._offset is None:
            self._offset = -record["clock"]
        elif not boot or boot != self._boot:
            wall = datetime.fromisoformat(record["time"]) - datetime.fromisoformat(
                self._last["time"]
            )
            now = self.of[self._last["n"]] + max(0.0, wall.total_seconds())
            self._offset = now - record["clock"]
        self._boot = boot


@dataclass
class Attempt:
    """One attempt of a trial.

    Attributes:
        start: The `trial` record.
        end: The `trial_end` record; None if the attempt was broken off or still runs.
        set_aside: Reason why the finished attempt does not count; empty if it may count.
        over: True once the attempt has ended, with or without a result.
    """

    start: Record
    end: Record | None = None
    set_aside: str = ""
    over: bool = False

    @property
    def result(self) -> TrialResult:
        """The result of a finished attempt, as far as the journal stores it.

        Raises:
            RecordingError: The stored result is damaged.
        """
        assert self.end is not None
        where = f"trial_end of trial {self.end['trial']}, attempt {self.end['attempt']}"
        return TrialResult.from_json(self.end["result"], where)


@dataclass(frozen=True)
class Decision:
    """A decision about a session that was made while the session was not open.

    Attributes:
        after: Number of records of the session at that time.
        trial: Number of the trial; None if the decision is about the participant.
        excluded: Reason for the exclusion; empty if the decision ends an exclusion.
    """

    after: int
    trial: int | None
    excluded: str


def decisions_on(notes: Iterable[Record], session: int) -> list[Decision]:
    """Decisions about a session in the notes about its participant."""
    return [
        Decision(
            note["after"].get(str(session), 0),
            note.get("trial"),
            note["reason"] if note["kind"] == EXCLUDE else "",
        )
        for note in notes
        if note["kind"] in (EXCLUDE, INCLUDE) and note.get("session") in (None, session)
    ]


@dataclass
class SessionState:
    """State of a session according to its journal.

    Attributes:
        start: The `session` record; empty before the session has begun.
        finished: Ids of finished or skipped steps.
        attempts: Attempts by trial number, in order.
        skipped: Reasons for skipping, by step.
        excluded: Reasons for exclusion, by trial number.
        excluded_participant: Reason for excluding the participant; empty if not excluded.
        design: Digest of the design by which the session is run now.
        answers: Records of completed forms by step, in order. The last record of a step counts.
        asked_by: Digest of the design by which each of these forms was asked, by step.
        drafts: Answers in unfinished forms, by step.
        consent: True if the participant consented, False if not; None before the answer.
        calibration: Calibration of the hand over a Leap, in the format of `sandbox paalm
            calibrate`; None for an average hand.
        learned: Layouts of five fingers from the last trial that found such layouts; the keys are
            `right` and `left`.
        complete: True if the session reached its planned end.
        recordings: Digest of each recording by file; None for a missing recording.
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
    recordings: dict[str, Any] = field(default_factory=dict)
    seconds: SessionClock = field(default_factory=SessionClock)
    clock_steps: list[float] = field(default_factory=list)

    @classmethod
    def of(cls, lines: Iterable[Record], decided: Sequence[Decision] = ()) -> SessionState:
        """Computes the state after some records and decisions, in the order of their time.

        Args:
            lines: Records of the session.
            decided: Decisions, in order; see `decisions_on`.
        """
        state, waiting = cls(), list(decided)
        for record in lines:
            while waiting and waiting[0].after <= record["n"]:
                state.decide(waiting.pop(0))
            state.take(record)
        for decision in waiting:
            state.decide(decision)
        return state

    def decide(self, decision: Decision) -> None:
        """Updates the state by a decision that was made while the session was not open."""
        if decision.trial is None:
            self.excluded_participant = decision.excluded
        elif decision.excluded:
            self.excluded[decision.trial] = decision.excluded
        else:
            self.excluded.pop(decision.trial, None)

    def take(self, record: Record) -> None:
        """Updates the state by one record; kinds of later versions are ignored."""
        self.seconds.take(record)
        if record["kind"] in records.RUNS:
            self.design = record.get("design", "")
        if "recording" in record and "file" in record:
            self.recordings[record["file"]] = record["recording"]
        match record["kind"]:
            case records.SESSION:
                self.start = record
            case records.RESUME if "number" in record:
                # The number differs only if no trial has begun; see `StudyFolder.include`.
                self.start = {**self.start, "number": record["number"]}
            case records.CLOCK_STEP:
                self.clock_steps.append(record["seconds"])
            case records.TRIAL:
                self.attempts.setdefault(record["trial"], []).append(Attempt(record))
            case records.TRIAL_END if is_broken(record):
                # An exclusion during this attempt ends, since the trial is repeated.
                self.excluded.pop(record["trial"], None)
                self._attempt(record).over = True
            case records.TRIAL_END:
                attempt = self._attempt(record)
                attempt.end, attempt.over = record, True
                self.learned |= _learned(record)
                self.finished.add(record["step"])
            case records.COMMAND:
                self._command(record)
            case records.ANSWER:
                self.drafts.setdefault(record["step"], {})[record["item"]] = record["answer"]
            case records.FORM:
                self.answers[record["step"]] = record
                self.asked_by[record["step"]] = self.design
                self.finished.add(record["step"])
            case records.DONE:
                if "calibration" in record:
                    self.calibration = record["calibration"]
                self.finished.add(record["step"])
            case records.CONSENT:
                self.consent = bool(record["agreed"])
                if self.consent:
                    self.finished.add(record["step"])
            case records.END:
                self.complete = bool(record["complete"])

    def _command(self, record: Record) -> None:
        match record["command"]:
            case "repeat":
                self._set_aside(record["trial"], record["step"], record["reason"] or "repeated")
            case "begin_again":
                self._begin_again(record["steps"], record["reason"])
            case "skip":
                self.skipped[record["step"]] = record["reason"]
                self.finished.add(record["step"])
            case "exclude":
                self._exclude(record)

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
        """The last attempt, if it is not over."""
        started = [a for some in self.attempts.values() for a in some]
        last = max(started, key=lambda a: a.start["n"], default=None)
        return last if last and not last.over else None

    def last_finished(self, steps: Sequence[Step]) -> TrialStep | None:
        """The trial whose attempt ended last; None before the first end of an attempt."""
        ended = [a.end for some in self.attempts.values() for a in some if a.end is not None]
        last = max(ended, key=lambda end: end["n"], default={"trial": None})
        trials = (step for step in steps if isinstance(step, TrialStep))
        return next((step for step in trials if step.number == last["trial"]), None)

    def next_step(self, steps: Sequence[Step]) -> Step | None:
        """The first step that is not finished; None at the end."""
        return next((step for step in steps if step.id not in self.finished), None)

    def block_under_way(self, steps: Sequence[Step]) -> list[Step]:
        """The finished steps of the block under way, with the block's instructions and practice.

        Empty if the next trial is the first trial of its block.
        """
        upcoming = self.next_step(steps)
        if upcoming is None:
            return []
        end = [*steps].index(upcoming)
        block = next((s.block for s in steps[end:] if isinstance(s, TrialStep)), None)
        first = next(
            (i for i, s in enumerate(steps) if isinstance(s, TrialStep) and s.block == block), end
        )
        while first > 0 and _belongs_to_next(steps[first - 1]):
            first -= 1
        again = [*steps[first:end]]
        return again if any(isinstance(step, TrialStep) for step in again) else []

    def done(self, steps: Sequence[Step]) -> tuple[int, int]:
        """Number of trials that are finished or skipped, and number of all trials."""
        trials = [step for step in steps if isinstance(step, TrialStep)]
        return sum(step.id in self.finished for step in trials), len(trials)

    def _attempt(self, record: Record) -> Attempt:
        attempts = self.attempts.get(record["trial"], [])
        if not 1 <= record["attempt"] <= len(attempts):
            raise StudyError(
                "the journal has an end of an attempt, but not its start",
                where=f"record {record['n']}",
                got=f"trial {record['trial']}, attempt {record['attempt']}",
                expected=f"one of {len(attempts)} attempts",
                remedy="Restore the journal from a backup",
            )
        return attempts[record["attempt"] - 1]

    def _set_aside(self, trial: int, step: str, reason: str) -> None:
        for attempt in self.attempts.get(trial, []):
            attempt.set_aside = attempt.set_aside or reason
        self.finished.discard(step)
        self.skipped.pop(step, None)
        self.excluded.pop(trial, None)
        self.complete = False

    def _begin_again(self, steps: list[str], reason: str) -> None:
        for trial, attempts in self.attempts.items():
            if attempts[0].start["step"] in steps:
                self._set_aside(trial, attempts[0].start["step"], reason)
        for step in steps:
            self.finished.discard(step)
            self.skipped.pop(step, None)
            self.drafts.pop(step, None)

    def _exclude(self, record: Record) -> None:
        if record.get("trial") is None:
            self.excluded_participant = record["reason"]
        else:
            self.excluded[record["trial"]] = record["reason"]


def _belongs_to_next(step: Step) -> bool:
    """True for a step that is repeated with the block after it: text, practice or break."""
    practice = isinstance(step, TrialStep) and step.practice
    return practice or isinstance(step, InstructionStep | BreakStep)


def is_broken(record: Record) -> bool:
    """True for the end of an attempt that was broken off."""
    return record["kind"] == records.TRIAL_END and record.get("result") is None


def _learned(record: Record) -> dict[str, Layouts]:
    """Layouts of five fingers in a `trial_end` record, which later trials of the session use."""
    return checked(
        record["result"].get("learned", {}),
        dict[str, Layouts],
        StudyError,
        what="the journal has layouts of fingers that cannot be read",
        where=f"record {record['n']}",
        remedy="Restore the journal from a backup",
    )
