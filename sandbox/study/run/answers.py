"""Answers to the items of a form: allowed values, checks, and drafts of unfinished forms."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Any

from models.errors import StudyError
from sandbox.study.design.design import Item
from sandbox.study.record.journal import plain_text
from sandbox.words import base

Answers = dict[str, Any]

RANGES = {
    "en": ("{low} to {high}", " in steps of {step}"),
    "de": ("{low} bis {high}", " in Schritten von {step}"),
    "fr": ("de {low} à {high}", " par pas de {step}"),
    "es": ("de {low} a {high}", " en pasos de {step}"),
    "zh": ("{low} 到 {high}", "，步长 {step}"),
    "ja": ("{low} から {high} まで", "、{step} 刻み"),
    "ar": ("من {low} إلى {high}", " بخطوات من {step}"),
}
"""Texts for allowed numbers and their steps, by language, for the terminal and the sheet; the page
draws scales instead. Native speakers have not checked them."""

LONGEST = 2000
"""Largest number of characters of a free-text answer."""


@dataclass
class Draft:
    """The answers in a form that is being filled in.

    Attributes:
        answers: Answers so far, by item, including those from before an interruption.
        write: Function that stores an answer durably; its arguments are item and answer.
        step: Id of the step. It identifies the form, which may occur more than once.
    """

    answers: Answers = field(default_factory=dict)
    write: Callable[[str, Any], object] = lambda item, value: None
    step: str = ""

    def store(self, item: str, value: Any) -> None:
        """Stores an answer; None removes an earlier answer."""
        self.write(item, value)
        self.answers[item] = value


def hint(item: Item, language: str = "", numbered: bool = False) -> str:
    """Description of the allowed answers; empty for free text.

    Args:
        item: The question.
        language: Language of the choices; empty for their stored values.
        numbered: True puts a number before each choice, if `read_answer` accepts this number.
    """
    if item.kind == "choice":
        words = [item.called(c, language) if language else c for c in item.choices]
        return f"({' / '.join(_numbered(words) if numbered else words)})"
    if item.kind in ("scale", "number"):
        return f"({_range(item, f'{item.low:g}', f'{item.high:g}', language)})"
    return ""


def _range(item: Item, low: str, high: str, language: str = "") -> str:
    """Text for the allowed values: both ends, and the step of a scale unless it is 1.

    Args:
        item: The question.
        low, high: The ends, as they are shown.
        language: Language of the text; English is used if `RANGES` does not have it.
    """
    ends, step = RANGES.get(base(language), RANGES["en"])
    text = ends.format(low=low, high=high)
    if item.kind == "scale" and item.step != 1:
        text += step.format(step=f"{item.step:g}")
    return text


def question(item: Item, language: str, numbered: bool = False) -> str:
    """An item as a line: the question, and the allowed answers; see `hint`."""
    if item.ends is None:
        return f"{item.ask[language]} {hint(item, language, numbered)}".rstrip()
    low, high = (
        f"{value:g} ({end[language]})"
        for value, end in zip((item.low, item.high), item.ends, strict=True)
    )
    return f"{item.ask[language]} {_range(item, low, high, language)}"


def read_answer(item: Item, text: str, language: str = "") -> Any:
    """Converts a typed answer to the value that is stored.

    A choice may be typed as its stored value, as its text in the language, or as its number.

    Raises:
        StudyError: The item does not allow this answer.
    """
    text = text.strip()
    if not text:
        if item.optional:
            return None
        raise StudyError(
            "an answer is needed", where=item.name, expected=hint(item, language) or None
        )
    if item.kind == "choice":
        place = chosen(text, item.choices)
        if place is None and language:
            place = chosen(text, [item.called(c, language) for c in item.choices])
        if place is None:
            raise StudyError(
                "the answer is not one of the choices",
                where=item.name,
                got=text,
                expected=", ".join(item.choices),
            )
        return item.choices[place]
    if item.kind == "text":
        return plain_text(text, item.name)
    try:
        value = float(text)
    except ValueError:
        value = float("nan")
    return _number(item, value, text)


def chosen(text: str, options: Sequence[str]) -> int | None:
    """Index, from 0, of the option that was typed, as its word or its number; None for neither.

    The numbers of options count from 1. If an option is itself a number, options have no numbers.
    """
    words = [option.lower() for option in options]
    text = text.strip().lower()
    if text in words:
        return words.index(text)
    numbers = _numbers(options)
    return numbers.index(text) if text in numbers else None


def choice_of(options: Sequence[str]) -> str:
    """Instructions for typing an option, such as `1 yes, 2 no`."""
    return ", ".join(_numbered(options))


def _numbers(options: Sequence[str]) -> list[str]:
    """Numbers by which options can be chosen; none if an option is itself a number."""
    if any(option.strip().isdecimal() for option in options):
        return []
    return [str(place) for place in range(1, len(options) + 1)]


def _numbered(options: Sequence[str]) -> list[str]:
    numbers = _numbers(options)
    return [f"{n} {o}" for n, o in zip(numbers, options, strict=True)] if numbers else [*options]


def check_answer(item: Item, value: object) -> Any:
    """Checks an answer from the page, and returns the value that is stored.

    The page may send any value. None removes an answer, also of a required item; the form cannot be
    finished then.

    Raises:
        StudyError: The item does not allow this answer.
    """
    match item.kind, value:
        case _, None:
            return None
        case "choice", str() if value in item.choices:
            return value
        case "text", str() if len(value) <= LONGEST:
            # Spaces around an answer are removed. An empty text counts as no answer.
            return plain_text(value, item.name).strip() or None
        case (("scale" | "number"), bool()):
            pass
        # The bounds are checked first, since a huge integer cannot be converted to a float.
        case (("scale" | "number"), float() | int()) if item.low <= value <= item.high:
            return _number(item, float(value), str(value))
    raise StudyError(
        "the question does not allow this answer",
        where=item.name,
        got=str(value)[:80],
        expected=hint(item) or "a text",
    )


def still_allowed(items: Sequence[Item], answers: Mapping[str, Any]) -> dict[str, Any]:
    """The stored answers that a form allows now; its design may have changed since then."""
    kept = {}
    for item in items:
        with suppress(StudyError):
            if item.name in answers:
                kept[item.name] = check_answer(item, answers[item.name])
    return kept


def _number(item: Item, value: float, given: str) -> Any:
    if not (item.low <= value <= item.high and (item.kind == "number" or _on_step(item, value))):
        raise StudyError(
            "the number is not allowed here",
            where=item.name,
            got=given,
            expected=_range(item, f"{item.low:g}", f"{item.high:g}"),
        )
    return int(value) if value == int(value) else value


def _on_step(item: Item, value: float) -> bool:
    """True if a value is on a step of a scale. Computed exactly, from the decimal digits."""
    exact = Fraction(repr(value)) - Fraction(repr(float(item.low)))
    return exact % Fraction(repr(float(item.step))) == 0
