"""What a participant reads and answers: an interface, and two that are behind it.

`Forms` is what a page or a window implements; here are the terminal, and a simulated participant.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from models.errors import StudyError
from sandbox.study.controls import Terminal
from sandbox.study.design import Form, Item

Answers = dict[str, Any]
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

    def ask(self, form: Form, language: str, ready: Ready) -> Answers:
        """Answers by item; None where an optional one is left out."""
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

    def ask(self, form: Form, language: str, ready: Ready) -> Answers:
        with self._terminal.form():
            if form.title.get(language):
                self._show(form.title[language])
            return {item.name: self._item(item, language, ready) for item in form.items}

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
        ends = "" if item.ends is None else " to ".join(
            f"{value:g} ({end[language]})"
            for value, end in zip((item.low, item.high), item.ends, strict=True)
        )  # fmt: skip
        self._show(f"{item.ask[language]} {ends or hint(item)}")
        while True:
            text = self._line(ready)
            try:
                return read_answer(item, text)
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
            raise StudyError("nobody can answer", where="the terminal",
                             remedy="Use a terminal; the study resumes at this step")  # fmt: skip
        return text


def hint(item: Item) -> str:
    """What may be answered."""
    if item.kind == "choice":
        return "(" + " / ".join(item.choices) + ")"
    if item.kind in ("scale", "number"):
        return f"({item.low:g} to {item.high:g})"
    return ""


def read_answer(item: Item, text: str) -> Any:
    """An answer as it is kept.

    Raises:
        StudyError: It is none that this item has.
    """
    text = text.strip()
    if not text:
        if item.optional:
            return None
        raise StudyError("an answer is needed", where=item.name, expected=hint(item) or None)
    if item.kind == "choice":
        found = [c for c in item.choices if c.lower() == text.lower()]
        if not found:
            raise StudyError("this is none of the choices", where=item.name, got=text,
                             expected=", ".join(item.choices))  # fmt: skip
        return found[0]
    if item.kind == "text":
        return text
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    steps = (value - item.low) / item.step
    on_step = item.kind == "number" or abs(steps - round(steps)) < 1e-9 * max(1.0, abs(steps))
    if not (item.low <= value <= item.high and on_step):
        raise StudyError("this is no such number", where=item.name, got=text,
                         expected=f"{item.low:g} to {item.high:g} by {item.step:g}")  # fmt: skip
    return int(value) if value == int(value) else value


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

    def ask(self, form: Form, language: str, ready: Ready) -> Answers:
        ready()
        # Equal after a kill: an answer follows from who is asked what, not from when.
        return {item.name: self._answer(form.name, item) for item in form.items}

    def rest(self, least: float, ready: Ready) -> None:
        ready()

    def _answer(self, form: str, item: Item) -> Any:
        rng = np.random.default_rng([self._seed, *f"{form}/{item.name}".encode()])
        if item.kind == "choice":
            return item.choices[rng.integers(len(item.choices))]
        if item.kind == "text":
            return "simulated"
        steps = int((item.high - item.low) / item.step)
        value = item.low + item.step * int(rng.integers(steps + 1))
        return int(value) if value == int(value) else value
