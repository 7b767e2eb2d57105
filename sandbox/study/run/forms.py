"""Interface for texts and questions to a participant, with two implementations.

This module has the texts about a task, forms in the terminal, and forms for a simulated
participant. Forms on the page are in `sandbox.study.run.page_forms`.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, Protocol

import numpy as np

from models.errors import StudyError
from sandbox.study.design.design import Form, Item, PageSettings
from sandbox.study.run.answers import Answers, Draft, question, read_answer
from sandbox.study.run.controls import YES_OR_NO, Terminal
from sandbox.words import words_in
from tasks.task import summary

Poll = Callable[[], None]
"""Called repeatedly while a form waits for the participant. It executes commands of the
experimenter; an exception that it raises ends the form."""


@dataclass(frozen=True)
class NewTask:
    """Text for a participant before a new task, and at the end of a task's practice.

    Attributes:
        number: Number of the next trial in the session, from 1.
        count: Number of trials of the session.
        title, goal: Name and goal of the task; each is empty if the design does not show it.
        practice: True if the next trial is practice.
        picture: Data URL of a picture of the task; empty without a picture.
    """

    number: int
    count: int
    title: str
    goal: str
    practice: bool = False
    picture: str = ""


def task_texts(
    page: PageSettings, key: str, name: str, goal: str, language: str, words: Mapping[str, str]
) -> tuple[str, str]:
    """Title and goal of a task.

    They come from the design; or else from the page's words in the language; or else from the task.

    Args:
        page: Settings of trials on the page.
        key: The task as in the design: a name or a file.
        name: Name of the task.
        goal: The task's own summary.
        language: Language of the participant.
        words: Words of the page in this language, by key.
    """
    title = page.names.get(key, {}).get(language, words.get(f"task_{name}", _readable(name)))
    return title, page.goals.get(key, {}).get(language, words.get(f"goal_{name}", goal))


def task_hint(page: PageSettings, name: str, words: Mapping[str, str]) -> str:
    """Text on how a task is done, in a language; empty unless the design shows hints.

    Args:
        page: Settings of trials on the page.
        name: Name of the task.
        words: Words of the page in this language, by key.
    """
    return words.get(f"how_{name}", words["how_any"]) if "hint" in page.shows else ""


def texts_by_design(
    page: PageSettings, key: str, language: str, words: Mapping[str, str]
) -> tuple[str, str]:
    """Title and goal of a task as in `task_texts`; each is empty if the design hides it."""
    from tasks.registry import find_task

    task = find_task(key)
    title, goal = task_texts(page, key, task.name, summary(task), language, words)
    return title if "task" in page.shows else "", goal if "goal" in page.shows else ""


def _readable(task: str) -> str:
    """Title from the name of a task: `box-to-goal` becomes `Box to goal`."""
    words = task.replace("-", " ").replace("_", " ")
    return words[:1].upper() + words[1:]


class Forms(Protocol):
    """Shows texts and asks questions, in the participant's language."""

    def consent(self, text: str, poll: Poll) -> bool:
        """Shows the consent form; returns True if the participant agrees."""
        ...

    def instruct(self, text: str, poll: Poll) -> None:
        """Shows a text until the participant has read it."""
        ...

    def introduce(self, task: NewTask, poll: Poll) -> None:
        """Shows the next task and its goal until the participant has read them."""
        ...

    def ask(self, form: Form, language: str, poll: Poll, draft: Draft) -> Answers:
        """Asks the questions of a form; returns the answers by item, with None for no answer.

        Args:
            form: The form.
            language: Language of the participant.
            poll: See `Poll`.
            draft: Answers from before an interruption; new answers must be stored in it at once.
        """
        ...

    def rest(self, least: float, poll: Poll) -> None:
        """Makes a break of at least `least` seconds, until the participant continues."""
        ...


class TerminalForms:
    """Texts and questions in the terminal.

    Args:
        terminal: Terminal in which answers are typed.
        show: Prints a text.
        again: Command that resumes the session; the error names it if the input ends.
    """

    def __init__(
        self, terminal: Terminal, show: Callable[[str], object], again: str = "the same command"
    ) -> None:
        self._terminal, self._show, self._again = terminal, show, again

    def consent(self, text: str, poll: Poll) -> bool:
        self._show(text)
        return self._terminal.choose(YES_OR_NO, self._show, poll, self._ended) == 0

    def instruct(self, text: str, poll: Poll) -> None:
        self._show(f"{text}\n[Enter]")
        self._line(poll)

    def introduce(self, task: NewTask, poll: Poll) -> None:
        kind = "practice, " if task.practice else ""
        parts = (f"{kind}{task.number} / {task.count}", task.title, task.goal)
        self.instruct("\n".join(part for part in parts if part), poll)

    def ask(self, form: Form, language: str, poll: Poll, draft: Draft) -> Answers:
        with self._terminal.form():
            if form.title.get(language):
                self._show(form.title[language])
            if note := words_in(language).get(f"wording_{form.wording.get(language)}"):
                self._show(note)
            for item in form.items:
                if item.name not in draft.answers:
                    draft.store(item.name, self._item(item, language, poll))
            return {item.name: draft.answers[item.name] for item in form.items}

    def rest(self, least: float, poll: Poll) -> None:
        until = time.monotonic() + least
        self._show(f"a break of {least:g} s or longer\n[Enter]")
        while True:
            self._line(poll)
            left = until - time.monotonic()
            if left <= 0:
                return
            self._show(f"{left:.0f} s more, please")

    def _item(self, item: Item, language: str, poll: Poll) -> Any:
        skips = " [optional: Enter alone skips it]" if item.optional else ""
        self._show(question(item, language, numbered=True) + skips)
        while True:
            text = self._line(poll)
            try:
                return read_answer(item, text, language)
            except StudyError as error:
                self._show(str(error))

    def _line(self, poll: Poll) -> str:
        text = self._terminal.ask(poll)
        if text is None:
            raise self._ended()
        return text

    def _ended(self) -> StudyError:
        return StudyError(
            "the input has ended, so that questions cannot be answered",
            where="the terminal",
            remedy=f"In a terminal, `{self._again}` resumes the session at this step. `sandbox "
            "study simulate` runs without answers",
        )


class SimulatedForms:
    """Forms for a simulated participant, who answers at once and at random.

    Args:
        seed: Seed of the answers.
    """

    def __init__(self, seed: int) -> None:
        self._seed = seed

    def consent(self, text: str, poll: Poll) -> bool:
        poll()
        return True

    def instruct(self, text: str, poll: Poll) -> None:
        poll()

    def introduce(self, task: NewTask, poll: Poll) -> None:
        poll()

    def ask(self, form: Form, language: str, poll: Poll, draft: Draft) -> Answers:
        poll()
        # An answer depends on seed, step and item only, so it is the same after an interruption.
        return {item.name: self._answer(draft.step or form.name, item) for item in form.items}

    def rest(self, least: float, poll: Poll) -> None:
        poll()

    def _answer(self, step: str, item: Item) -> Any:
        rng = np.random.default_rng([self._seed, *f"{step}/{item.name}".encode()])
        if item.kind == "choice":
            return item.choices[rng.integers(len(item.choices))]
        if item.kind == "text":
            return "simulated"
        low, high, one = (Fraction(repr(float(n))) for n in (item.low, item.high, item.step))
        value = float(low + one * int(rng.integers((high - low) // one + 1)))
        return int(value) if value == int(value) else value
