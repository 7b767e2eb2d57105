"""Plan of a participant's sessions: all steps, with expected durations.

A plan depends only on the design, the participant's number and the session's number. So it is not
stored: an interrupted session computes the same steps again.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from hashlib import blake2b
from typing import Any

from sandbox.study.design.balance import order_of, rows_of
from sandbox.study.design.conditions import before_camera, values_of
from sandbox.study.design.design import DEMOGRAPHICS, Design, Factor, Form, Instruction, Level
from sandbox.study.design.fields import END, START
from sandbox.study.design.questionnaires import arranged

READING = 20.0
"""Expected time to read an instruction, s."""
CONSENT = 60.0
"""Expected time to read and answer the consent form, s."""
ANSWERING = 7.0
"""Expected time to answer a question, s."""
CALIBRATING = 30.0
"""Expected time to measure a hand over a Leap, s."""
CHANGING = 4.0
"""Expected time between two trials, s."""

ABOUT_PERSON = f"form:{DEMOGRAPHICS}"
"""Id of the step with the questions about the person."""

LEAP = "leap"
"""Value of `device` and `second_device` for a hand over a Leap."""


@dataclass(frozen=True)
class Step:
    """A step of a session.

    Attributes:
        id: Id within the session; the same design and participant always give the same ids.
    """

    id: str


@dataclass(frozen=True)
class ConsentStep(Step):
    """The participant reads the consent form and agrees or declines."""


@dataclass(frozen=True)
class InstructionStep(Step):
    """The participant reads a text."""

    instruction: Instruction


@dataclass(frozen=True)
class CalibrationStep(Step):
    """The participant's hand is measured over a Leap, if some trials use one."""


@dataclass(frozen=True)
class FormStep(Step):
    """The participant answers a form.

    Attributes:
        form: The form, with its questions in the participant's order.
        block: Number of the block that the form is about; 0 if it is not about a block.
        levels: Levels, by factor, that the form is about.
    """

    form: Form
    block: int
    levels: dict[str, str]


@dataclass(frozen=True)
class BreakStep(Step):
    """A break of at least `least` seconds."""

    least: float


@dataclass(frozen=True)
class TrialStep(Step):
    """A trial.

    Attributes:
        number: 1, 2, ... in the session, practice included.
        block: 1, 2, ...; a block ends where a level changes.
        in_block: 1, 2, ... in the block.
        repetition: 1, 2, ... of this combination of levels; 0 in practice.
        practice: True for a practice trial.
        levels: Levels by factor.
        values: Settings by the names of `conditions.setting_types`.
        seed: Seed of the trial.
        session: Session number, from 1.
    """

    number: int
    block: int
    in_block: int
    repetition: int
    practice: bool
    levels: dict[str, str]
    values: dict[str, Any]
    seed: int
    session: int = 1


def session_plan(design: Design, number: int, session: int = 1) -> list[Step]:
    """Returns all steps of one session of a participant.

    Consent and demographics are in the first session only. In each later session, orders `latin`
    and `factorial` move on by one row, random orders are drawn again, and starts and goals are new
    unless all participants share them. `balance.rows_of` gives the rows of the first session.

    Args:
        design: Design of the study.
        number: Number of the participant, from 1; it determines the orders.
        session: 1, 2, ... up to `design.sessions`.
    """
    steps = list(_Plan(design, number, session).steps())
    if any(step.values.get("device") == LEAP for step in trials_of(steps)):
        return steps
    return [step for step in steps if not isinstance(step, CalibrationStep)]


def in_the_air(values: Mapping[str, Any]) -> bool:
    """Returns True if, with these settings, a hand is over a Leap or a camera sees it."""
    return over_a_leap(values) or before_camera(values)


def over_a_leap(values: Mapping[str, Any]) -> bool:
    """Returns True if, with these settings, a hand is over a Leap."""
    return LEAP in (values.get("device"), values.get("second_device"))


def trials_of(steps: list[Step]) -> list[TrialStep]:
    """Returns the trials among some steps."""
    return [step for step in steps if isinstance(step, TrialStep)]


def duration(design: Design, steps: list[Step]) -> float:
    """Expected duration of a session, s."""
    total = 0.0
    for step in steps:
        match step:
            case TrialStep():
                total += min(design.expected, design.time_limit) + CHANGING
            case BreakStep():
                total += step.least
            case FormStep():
                total += ANSWERING * len(step.form.items)
            case InstructionStep():
                total += READING
            case ConsentStep():
                total += CONSENT
            case CalibrationStep():
                total += CALIBRATING
    return total


class _Plan:
    """Generator of the steps of one session."""

    def __init__(self, design: Design, number: int, session: int) -> None:
        self._design, self._session = design, session
        # Rows and seeds count people from 0.
        self._participant = number - 1
        self._rows = rows_of(design, self._participant)
        # Number of rows from the orders of the first session to those of this session. If a factor
        # has one level a session, all sessions share one order, and each session is a place in it.
        one_a_session = any(factor.one_a_session for factor in design.factors)
        self._moved = 0 if one_a_session else session - 1
        # In sessions after the first, these values are added to the parts of every seed.
        self._later: tuple[object, ...] = () if session == 1 else ("session", session)
        self._trial = self._block = self._in_block = self._count = 0
        self._levels: dict[str, Level] = {}
        inside = [f.name for f in design.factors]
        # Number of factors outside of the loop over repetitions.
        self._round = (
            inside.index(design.repeat_inside) + 1 if design.repeat_inside else len(inside)
        )

    def steps(self) -> Iterator[Step]:
        design = self._design
        if design.consent and self._session == 1:
            yield ConsentStep("consent")
        if design.demographics and self._session == 1:
            title = dict.fromkeys(design.languages, "")
            form = Form(DEMOGRAPHICS, title, design.demographics, START)
            yield FormStep(ABOUT_PERSON, form, 0, {})
        yield from self._instructions(START)
        yield from self._forms(START)
        yield CalibrationStep("calibration")
        if design.practice and not design.practice_each:
            yield from self._practice()
        yield from self._factor(0, self._moved, 0)
        yield from self._forms(END)
        yield from self._instructions(END)

    def _now(self, sessions: tuple[int, ...]) -> bool:
        """True if this session is among `sessions`, or `sessions` is empty, which means all."""
        return not sessions or self._session in sessions

    def _factor(self, depth: int, moved: int, repetition: int) -> Iterator[Step]:
        """Steps of the factors from `depth` on, within the chosen levels; rows are moved by
        `moved`."""
        design = self._design
        if depth == self._round and not repetition:
            for again in range(1, design.repetitions + 1):
                yield from self._factor(depth, moved + again - 1, again)
            return
        if depth == len(design.factors):
            yield from self._rest()
            yield self._make_trial(repetition)
            return
        factor = design.factors[depth]
        levels = self._ordered(factor, moved, depth, repetition)
        for level in levels:
            self._levels[factor.name] = level
            if depth < self._round:
                self._block += 1
                self._in_block = 0
            yield from self._instructions(factor.name, level.name)
            if design.practice_each == factor.name:
                yield from self._practice()
            yield from self._factor(depth + 1, moved, repetition)
            if depth < self._round:
                yield from self._forms(factor.name)
            self._levels.pop(factor.name)

    def _ordered(self, factor: Factor, moved: int, depth: int, repetition: int) -> list[Level]:
        levels = factor.within(self._levels)
        p = self._participant
        row = self._rows[depth]
        if factor.order != "between":
            row += moved
        chosen = ",".join(f"{k}={v.name}" for k, v in self._levels.items())
        later = () if factor.one_a_session else self._later
        seed = _seed(self._design.seed, "order", p, factor.name, chosen, repetition, *later)
        ordered = [levels[i] for i in order_of(factor.order, len(levels), row, (seed,))]
        return [ordered[self._session - 1]] if factor.one_a_session else ordered

    def _make_trial(self, repetition: int, practice: int = 0) -> TrialStep:
        design = self._design
        self._trial += 1
        self._in_block += 1
        levels = {name: level.name for name, level in self._levels.items()}
        values = values_of(design, self._levels)
        who = "everybody" if design.seeds == "shared" else self._participant
        # Shared starts are equal in all conditions, too: they depend on task and repetition only.
        what = values.get("task", "") if design.seeds == "shared" else sorted(levels.items())
        later = () if design.seeds == "shared" else self._later
        seed = _seed(design.seed, "trial", who, what, repetition, practice, *later)
        return TrialStep(
            f"trial:{self._trial}",
            self._trial,
            self._block,
            self._in_block,
            repetition,
            practice > 0,
            levels,
            values,
            seed % 2**31,
            self._session,
        )

    def _practice(self) -> Iterator[Step]:
        """Practice trials with the chosen levels, and with levels of the other factors in turn."""
        design = self._design
        if not self._now(design.practice_sessions):
            return
        missing = [f for f in design.factors if f.name not in self._levels]
        for number in range(1, design.practice + 1):
            for factor in missing:
                depth = design.factors.index(factor)
                levels = self._ordered(factor, self._moved, depth, 0)
                self._levels[factor.name] = levels[(number - 1) % len(levels)]
            yield self._make_trial(0, number)
            for factor in missing:
                self._levels.pop(factor.name)
        self._in_block = 0

    def _rest(self) -> Iterator[Step]:
        done = self._count
        self._count += 1
        if self._design.break_every and done and done % self._design.break_every == 0:
            yield BreakStep(f"break:{done}", self._design.break_time)

    def _instructions(self, at: str, level: str = "") -> Iterator[Step]:
        for i, instruction in enumerate(self._design.instructions):
            here = instruction.at == at and instruction.level in ("", level)
            if here and self._now(instruction.sessions):
                yield InstructionStep(f"instruction:{i}:{at}:{self._trial}", instruction)

    def _forms(self, at: str) -> Iterator[Step]:
        levels = {name: level.name for name, level in self._levels.items()}
        if at in levels:
            # The form is about the level that has just ended, and the levels of outer factors.
            names = [f.name for f in self._design.factors]
            levels = {k: v for k, v in levels.items() if names.index(k) <= names.index(at)}
        for form in self._design.questionnaires:
            if form.at == at and self._now(form.sessions):
                block = self._block if at not in (START, END) else 0
                step = f"form:{form.name}:{self._trial}"
                seed = _seed(self._design.seed, "form", self._participant, step, *self._later)
                yield FormStep(step, arranged(form, seed), block, levels)


def _seed(*parts: object) -> int:
    """Derives a seed of 63 bits from some values."""
    text = "\0".join(map(str, parts))
    return int.from_bytes(blake2b(text.encode(), digest_size=8).digest()) >> 1
