"""What an answer may be, and what has been filled in of a form that is still open."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from models.errors import StudyError
from sandbox.study.design.design import Item

Answers = dict[str, Any]

LONGEST = 2000
"""Characters of an answer in words."""


@dataclass
class Draft:
    """A form that is being filled in.

    Attributes:
        answers: So far, by item; also from before the program was ended.
        write: Writes an answer down at once.
        step: Id of the step: the same form may be asked more than once.
    """

    answers: Answers = field(default_factory=dict)
    write: Callable[[str, Any], object] = lambda item, value: None
    step: str = ""

    def keep(self, item: str, value: Any) -> None:
        """An answer; None takes an earlier one back."""
        self.write(item, value)
        self.answers[item] = value


def hint(item: Item, language: str = "") -> str:
    """What may be answered."""
    if item.kind == "choice":
        called = [item.called(c, language) if language else c for c in item.choices]
        return "(" + " / ".join(called) + ")"
    if item.kind in ("scale", "number"):
        return f"({item.low:g} to {item.high:g})"
    return ""


def read_answer(item: Item, text: str, language: str = "") -> Any:
    """An answer that was typed, as it is kept.

    A choice may be called by what it is called in a language, too.

    Raises:
        StudyError: It is none that this item has.
    """
    text = text.strip()
    if not text:
        if item.optional:
            return None
        raise StudyError(
            "an answer is needed", where=item.name, expected=hint(item, language) or None
        )
    if item.kind == "choice":
        names = [(c, item.called(c, language) if language else c) for c in item.choices]
        found = [c for c, called in names if text.lower() in (c.lower(), called.lower())]
        if not found:
            raise StudyError(
                "this is none of the choices",
                where=item.name,
                got=text,
                expected=", ".join(item.choices),
            )
        return found[0]
    if item.kind == "text":
        return text
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    return _number(item, value, text)


def check_answer(item: Item, value: object) -> Any:
    """An answer that a page has sent, as it is kept; nothing it says is believed.

    None takes an answer back, which even a required item lets: the form cannot be left then.

    Raises:
        StudyError: It is none that this item has.
    """
    match item.kind, value:
        case _, None:
            return None
        case "choice", str() if value in item.choices:
            return value
        case "text", str() if len(value) <= LONGEST:
            # Spaces round it are no part of an answer, and nothing is none.
            return value.strip() or None
        case (("scale" | "number"), bool()):
            pass
        # The bounds come first: Python cannot make a float of every whole number.
        case (("scale" | "number"), float() | int()) if item.low <= value <= item.high:
            return _number(item, float(value), str(value))
    raise StudyError(
        "this is no answer to the question",
        where=item.name,
        got=str(value)[:80],
        expected=hint(item) or "words",
    )


def _number(item: Item, value: float, told: str) -> Any:
    if not (item.low <= value <= item.high and (item.kind == "number" or _on_step(item, value))):
        raise StudyError(
            "this is no such number",
            where=item.name,
            got=told,
            expected=f"{item.low:g} to {item.high:g} by {item.step:g}",
        )
    return int(value) if value == int(value) else value


def _on_step(item: Item, value: float) -> bool:
    """Whether a scale has this place: in decimals, as its steps were written down."""
    exact = Fraction(repr(value)) - Fraction(repr(float(item.low)))
    return exact % Fraction(repr(float(item.step))) == 0
