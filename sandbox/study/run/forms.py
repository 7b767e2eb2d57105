"""What a participant reads and answers: an interface, and two that are behind it.

The page implements it, too (`sandbox.study.run.page_forms`); here are the terminal, and a simulated
participant.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from models.errors import StudyError
from sandbox.study.design.design import Form, Item
from sandbox.study.run.answers import Answers, Draft, hint, read_answer
from sandbox.study.run.controls import Terminal

Ready = Callable[[], None]
"""Called again and again while the participant thinks, so that the experimenter is heard; what it
raises ends the form."""


class Forms(Protocol):
    """Shows texts and asks questions, in the participant's language."""

    def consent(self, text: str, ready: Ready) -> bool:
        """Whether the participant agrees."""
        ...

    def instruct(self, text: str, ready: Ready) -> None:
        """Shows a text until it is read."""
        ...

    def ask(self, form: Form, language: str, ready: Ready, draft: Draft) -> Answers:
        """Answers by item; None where an optional one is left out.

        What was filled in before, in a form that was left or broken off, is in the draft; what is
        filled in now is to be kept in it at once.
        """
        ...

    def rest(self, least: float, ready: Ready) -> None:
        """A break of at least so many seconds, until the participant goes on."""
        ...


class TerminalForms:
    """Texts and questions in the terminal.

    Args:
        terminal: Where answers are typed.
        show: Prints a text.
    """

    def __init__(self, terminal: Terminal, show: Callable[[str], object]) -> None:
        self._terminal, self._show = terminal, show

    def consent(self, text: str, ready: Ready) -> bool:
        self._show(text)
        return self._choose(("yes", "no"), ready) == "yes"

    def instruct(self, text: str, ready: Ready) -> None:
        self._show(f"{text}\n[Enter]")
        self._line(ready)

    def ask(self, form: Form, language: str, ready: Ready, draft: Draft) -> Answers:
        with self._terminal.form():
            if form.title.get(language):
                self._show(form.title[language])
            for item in form.items:
                if item.name not in draft.answers:
                    draft.keep(item.name, self._item(item, language, ready))
            return {item.name: draft.answers[item.name] for item in form.items}

    def rest(self, least: float, ready: Ready) -> None:
        until = time.monotonic() + least
        self._show(f"a break of {least:g} s or longer\n[Enter]")
        while True:
            self._line(ready)
            left = until - time.monotonic()
            if left <= 0:
                return
            self._show(f"{left:.0f} s more, please")

    def _item(self, item: Item, language: str, ready: Ready) -> Any:
        ends = (
            ""
            if item.ends is None
            else " to ".join(
                f"{value:g} ({end[language]})"
                for value, end in zip((item.low, item.high), item.ends, strict=True)
            )
        )
        self._show(f"{item.ask[language]} {ends or hint(item, language)}")
        while True:
            text = self._line(ready)
            try:
                return read_answer(item, text, language)
            except StudyError as error:
                self._show(str(error))

    def _choose(self, options: tuple[str, ...], ready: Ready) -> str:
        while True:
            self._show(" / ".join(options))
            text = self._line(ready).strip().lower()
            if text in options:
                return text

    def _line(self, ready: Ready) -> str:
        text = self._terminal.ask(ready)
        if text is None:
            raise StudyError(
                "nobody can answer",
                where="the terminal",
                remedy="Use a terminal; the study resumes at this step",
            )
        return text


class SimulatedForms:
    """A participant without an opinion: answers by chance, at once.

    Args:
        seed: Of the participant's chance.
    """

    def __init__(self, seed: int) -> None:
        self._seed = seed

    def consent(self, text: str, ready: Ready) -> bool:
        ready()
        return True

    def instruct(self, text: str, ready: Ready) -> None:
        ready()

    def ask(self, form: Form, language: str, ready: Ready, draft: Draft) -> Answers:
        ready()
        # Equal after a kill: an answer follows from who is asked what at which step, not from when.
        return {item.name: self._answer(draft.step or form.name, item) for item in form.items}

    def rest(self, least: float, ready: Ready) -> None:
        ready()

    def _answer(self, step: str, item: Item) -> Any:
        rng = np.random.default_rng([self._seed, *f"{step}/{item.name}".encode()])
        if item.kind == "choice":
            return item.choices[rng.integers(len(item.choices))]
        if item.kind == "text":
            return "simulated"
        steps = int((item.high - item.low) / item.step)
        value = item.low + item.step * int(rng.integers(steps + 1))
        return int(value) if value == int(value) else value
