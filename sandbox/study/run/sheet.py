"""The sheet of a session: everything that a participant will meet, in order.

The steps are those of `session_plan`, and the texts are those that forms get from the session.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from itertools import groupby

from models.errors import StudyError
from models.message import counted
from sandbox.server.frames import summary
from sandbox.study.design.conditions import WEBCAM, consent_text, run_settings
from sandbox.study.design.design import Design, Form
from sandbox.study.design.plan import (
    BreakStep,
    CalibrationStep,
    ConsentStep,
    FormStep,
    InstructionStep,
    Step,
    TrialStep,
    duration,
    in_the_air,
    session_plan,
)
from sandbox.study.run.answers import question
from sandbox.study.run.task_texts import task_texts
from sandbox.words.words import words_in


@dataclass(frozen=True)
class SheetPart:
    """A part of a sheet.

    Attributes:
        steps: Ids of its steps; several for trials of one condition that follow each other.
        heading: What it is, for the experimenter.
        texts: What the participant reads, in their language.
        form: The form that is asked; None if none is.
    """

    steps: tuple[str, ...]
    heading: str
    texts: tuple[str, ...] = ()
    form: Form | None = None


@dataclass(frozen=True)
class SessionSheet:
    """Everything that a participant will meet in a session.

    Attributes:
        design: Design of the study.
        number: Number of the participant, from 1 in order of arrival.
        session: Number of the session, from 1.
        language: Language of the participant.
        minutes: Expected duration, min.
        parts: Parts in order.
    """

    design: Design
    number: int
    session: int
    language: str
    minutes: float
    parts: tuple[SheetPart, ...]

    @property
    def words(self) -> dict[str, str]:
        """Words of the page in the participant's language, by key."""
        return words_in(self.language, self.design.page.words.get(self.language))

    @property
    def title(self) -> str:
        """Study, participant, session, language and duration."""
        sessions = self.design.sessions
        of_several = f", session {self.session} of {sessions}" if sessions > 1 else ""
        return (
            f"{self.design.name}: participant number {self.number}{of_several}, language "
            f"{self.language}, about {self.minutes:.0f} min"
        )


def session_sheet(
    design: Design, number: int, session: int = 1, language: str = ""
) -> SessionSheet:
    """Returns the sheet of a session.

    Args:
        design: Design of the study.
        number: Number of the participant, from 1 in order of arrival.
        session: Number of the session, from 1.
        language: Language of the participant; empty means the first one of the design.

    Raises:
        StudyError: There is no such number, or the design has no texts in the language.
    """
    if number < 1:
        raise StudyError(
            "not the number of a participant",
            where="--participant-number",
            got=number,
            expected="1 for the first who comes, 2 for the second, and so on",
        )
    if language and language not in design.languages:
        raise StudyError(
            "the design has no texts in this language",
            where="--language",
            got=language,
            expected=", ".join(design.languages),
        )
    language = language or design.languages[0]
    steps = session_plan(design, number - 1, session)
    minutes = duration(design, steps) / 60
    sheet = SessionSheet(design, number, session, language, minutes, ())
    return replace(sheet, parts=tuple(_parts(sheet, steps)))


def sheet_lines(sheet: SessionSheet) -> Iterator[str]:
    """The sheet as lines of plain text."""
    yield sheet.title
    for number, part in enumerate(sheet.parts, 1):
        yield ""
        yield f"{number}. {part.heading}"
        for text in part.texts:
            yield from (f"   {line}".rstrip() for line in text.strip().splitlines())
        for item in part.form.items if part.form else ():
            optional = f" [{sheet.words['optional']}]" if item.optional else ""
            yield f"   - {question(item, sheet.language)}{optional}"


def _parts(sheet: SessionSheet, steps: Iterable[Step]) -> Iterator[SheetPart]:
    for _, some in groupby(enumerate(steps), key=_together):
        same = [step for _, step in some]
        first = same[0]
        ids = tuple(step.id for step in same)
        heading, texts = _told(sheet, first)
        if isinstance(first, TrialStep):
            heading = _trials([step for step in same if isinstance(step, TrialStep)])
        form = first.form if isinstance(first, FormStep) else None
        yield SheetPart(ids, heading, tuple(text for text in texts if text), form)


def _together(numbered: tuple[int, Step]) -> object:
    """Key of steps that are one part: trials of one condition, and each other step by itself."""
    place, step = numbered
    if isinstance(step, TrialStep):
        return step.practice, tuple(step.levels.items())
    return place


def _told(sheet: SessionSheet, step: Step) -> tuple[str, list[str]]:
    """Heading of a step, and what the participant reads."""
    design, language, words = sheet.design, sheet.language, sheet.words
    match step:
        case ConsentStep():
            text = consent_text(design, language)
            return "consent", [text, f"[{words['agree']}]  [{words['decline']}]"]
        case InstructionStep():
            return "instructions", [step.instruction.text[language]]
        case CalibrationStep():
            return "the hand is measured over the Leap", [words["measure_hand"]]
        case FormStep():
            asked = counted(len(step.form.items), "question")
            about = ", ".join(f"{name} = {level}" for name, level in step.levels.items())
            note = words.get(f"wording_{step.form.wording.get(language)}", "")
            return (
                f"{step.form.name}, {asked}" + (f", about {about}" if about else ""),
                [step.form.title.get(language, ""), note],
            )
        case BreakStep():
            return f"break of {step.least:g} s or longer", [words["rest"], words["rest_over"]]
        case TrialStep():
            return "", _trial_texts(sheet, step)
    raise AssertionError(f"no such step: {step.id}")


def _trials(trials: list[TrialStep]) -> str:
    """Heading of trials of one condition."""
    first, last = trials[0], trials[-1]
    several = f"s {first.number} to {last.number}" if last is not first else f" {first.number}"
    levels = ", ".join(f"{name} = {level}" for name, level in first.levels.items())
    kind = "practice, trial" if first.practice else "trial"
    where = ", with the hand in the air" if in_the_air(first.values) else ""
    if WEBCAM in (first.values.get("device"), first.values.get("second_device")):
        where = ", before the camera"
    return f"{kind}{several}: {levels}{where}"


def _trial_texts(sheet: SessionSheet, trial: TrialStep) -> list[str]:
    """What the page shows of a trial's task."""
    from tasks.registry import find_task

    page = sheet.design.page
    key = run_settings(trial.values, trial.seed).task
    task = find_task(key)
    title, goal = task_texts(page, key, task.name, summary(task), sheet.language, sheet.words)
    shown = [text for name, text in (("task", title), ("goal", goal)) if name in page.shows]
    return shown
