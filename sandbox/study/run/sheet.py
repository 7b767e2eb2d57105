"""The sheet of a session: all texts, questions and trials for a participant, in order.

The steps come from `session_plan`, and the texts are the same as in the session. A sheet can be
printed as lines of text, or as one HTML page without scripts.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from html import escape
from itertools import groupby

from models.errors import StudyError
from models.message import counted
from sandbox.study.design.conditions import before_camera, consent_text, run_settings
from sandbox.study.design.design import Design
from sandbox.study.design.session_plan import (
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
from sandbox.study.run.forms import texts_by_design
from sandbox.words import words_in

STYLE = """
body { margin: 2rem auto; max-width: 44rem; padding: 0 1rem; font: 11pt/1.45 system-ui, sans-serif;
  color: #1c2430; background: #fff; }
h1 { font-size: 1.3rem; }
h2 { font-size: 1rem; margin: 1.4rem 0 0.3rem; border-top: 1px solid #c8ced6; padding-top: 0.6rem; }
section { break-inside: avoid; }
p { margin: 0.3rem 0; white-space: pre-line; }
ul { margin: 0.3rem 0; padding-inline-start: 1.4rem; }
li { margin: 0.5rem 0; }
.read { border-inline-start: 3px solid #1f5fa8; padding-inline-start: 0.8rem; }
@media print { body { margin: 0; max-width: none; } h1 + section h2 { border-top: 0; } }
"""


@dataclass(frozen=True)
class SheetPart:
    """A part of a sheet.

    Attributes:
        steps: Ids of the steps. Successive trials of one condition are one part.
        heading: Heading for the experimenter.
        texts: Texts for the participant, in the participant's language.
        questions: Questions for the participant, each in one line.
    """

    steps: tuple[str, ...]
    heading: str
    texts: tuple[str, ...] = ()
    questions: tuple[str, ...] = ()


@dataclass(frozen=True)
class SessionSheet:
    """All texts, questions and trials of a session for a participant.

    Attributes:
        title: Study, participant, session, language and duration.
        language: Language of the participant.
        parts: Parts in order.
    """

    title: str
    language: str
    parts: tuple[SheetPart, ...]


def session_sheet(
    design: Design, number: int, session: int = 1, language: str = ""
) -> SessionSheet:
    """Returns the sheet of a session.

    Args:
        design: Design of the study.
        number: Number of the participant, from 1 in order of arrival.
        session: Number of the session, from 1.
        language: Language of the participant; empty for the first language of the design.

    Raises:
        StudyError: The number is below 1, or the design has no texts in the language.
    """
    if number < 1:
        raise StudyError(
            "this is not the number of a participant",
            where="--participant-number",
            got=number,
            expected="1 for the first participant, 2 for the second, and so on",
        )
    language = design.language_of(language)
    steps = session_plan(design, number, session)
    of_several = f", session {session} of {design.sessions}" if design.sessions > 1 else ""
    title = (
        f"{design.name}: participant number {number}{of_several}, language {language}, about "
        f"{duration(design, steps) / 60:.0f} min"
    )
    groups = [[step for _, step in some] for _, some in groupby(enumerate(steps), key=_together)]
    return SessionSheet(title, language, tuple(_part(design, language, some) for some in groups))


def sheet_lines(sheet: SessionSheet) -> Iterator[str]:
    """The sheet as lines of plain text."""
    yield sheet.title
    for number, part in enumerate(sheet.parts, 1):
        yield ""
        yield f"{number}. {part.heading}"
        for text in part.texts:
            yield from (f"   {line}".rstrip() for line in text.strip().splitlines())
        yield from (f"   - {asked}" for asked in part.questions)


def sheet_page(sheets: Sequence[SessionSheet]) -> str:
    """Returns one HTML page with several sheets, in the order of the sessions."""
    body = "\n".join(line for sheet in sheets for line in _html(sheet))
    return (
        '<!doctype html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        f"<title>{escape(sheets[0].title)}</title>\n<style>{STYLE}</style>\n</head>\n"
        f"<body>\n{body}\n</body>\n</html>\n"
    )


def _html(sheet: SessionSheet) -> Iterator[str]:
    """Lines of the page. Texts for the participant are marked with the participant's language."""
    yield f"<h1>{escape(sheet.title)}</h1>"
    for number, part in enumerate(sheet.parts, 1):
        yield f"<section>\n<h2>{number}. {escape(part.heading)}</h2>"
        yield f'<div class="read" lang="{escape(sheet.language)}" dir="auto">'
        yield from (f'<p dir="auto">{escape(text.strip())}</p>' for text in part.texts)
        if part.questions:
            asked = (f'<li dir="auto">{escape(one)}</li>' for one in part.questions)
            yield from ("<ul>", *asked, "</ul>")
        yield "</div>\n</section>"


def _together(numbered: tuple[int, Step]) -> object:
    """Key by which steps are grouped: trials of one condition together, any other step alone."""
    place, step = numbered
    if isinstance(step, TrialStep):
        return step.practice, tuple(step.levels.items())
    return place


def _part(design: Design, language: str, steps: list[Step]) -> SheetPart:
    """The part of the sheet for steps that belong together."""
    words = words_in(language, design.page.words.get(language))
    questions: list[str] = []
    match step := steps[0]:
        case ConsentStep():
            heading = "consent"
            texts = [consent_text(design, language), f"[{words['agree']}]  [{words['decline']}]"]
        case InstructionStep():
            heading, texts = "instructions", [step.instruction.text[language]]
        case CalibrationStep():
            heading, texts = "the hand is measured over the Leap", [words["measure_hand"]]
        case FormStep():
            about = ", ".join(f"{name} = {level}" for name, level in step.levels.items())
            heading = f"{step.form.name}, {counted(len(step.form.items), 'question')}"
            heading += f", about {about}" if about else ""
            note = words.get(f"wording_{step.form.wording.get(language)}", "")
            texts = [step.form.title.get(language, ""), note]
            for item in step.form.items:
                optional = f" [{words['optional']}]" if item.optional else ""
                questions.append(question(item, language) + optional)
        case BreakStep():
            heading = f"break of {step.least:g} s or longer"
            texts = [words["rest"], words["rest_over"]]
        case TrialStep():
            heading = _trials([trial for trial in steps if isinstance(trial, TrialStep)])
            texts = _trial_texts(design, language, step)
        case _:
            raise AssertionError(f"no such step: {step.id}")
    ids = tuple(each.id for each in steps)
    return SheetPart(ids, heading, tuple(filter(None, texts)), tuple(questions))


def _trials(trials: list[TrialStep]) -> str:
    """Heading for successive trials of one condition."""
    first, last = trials[0], trials[-1]
    several = f"s {first.number} to {last.number}" if last is not first else f" {first.number}"
    levels = ", ".join(f"{name} = {level}" for name, level in first.levels.items())
    kind = "practice, trial" if first.practice else "trial"
    where = ", with the hand in the air" if in_the_air(first.values) else ""
    if before_camera(first.values):
        where = ", before the camera"
    return f"{kind}{several}: {levels}{where}"


def _trial_texts(design: Design, language: str, trial: TrialStep) -> list[str]:
    """Texts of a trial's task on the page."""
    key = run_settings(trial.values, trial.seed).task
    words = words_in(language, design.page.words.get(language))
    return [text for text in texts_by_design(design.page, key, language, words) if text]
