"""All texts of a design that participants read, with their places, and their sentences."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from textwrap import wrap

from sandbox.study.design.design import Design, Form, Item
from sandbox.study.design.reading import Text
from sandbox.study.design.told.plain import plain
from sandbox.study.design.toml_lines import Path
from sandbox.words.words import base

CONSENT, INSTRUCTION, GOAL, QUESTION, TITLE = "consent", "instruction", "goal", "question", "title"

LONGEST_SENTENCE = 500
"""Characters of a piece that is searched at once, so that a text without stops is read quickly."""
LONGEST_QUOTE = 70
"""Characters of a sentence that a finding quotes."""


@dataclass(frozen=True)
class Told:
    """A text that participants read.

    Attributes:
        path: Place in the design file.
        kind: One of the words above.
        text: The text by language.
        at: `start`, `end` or a factor, of an instruction; empty for other texts.
    """

    path: Path
    kind: str
    text: Text
    at: str = ""


def told_texts(design: Design) -> Iterator[Told]:
    """All texts that participants read."""
    if design.consent:
        yield Told(("consent", "text"), CONSENT, design.consent)
    for i, instruction in enumerate(design.instructions):
        yield Told(("instructions", i, "text"), INSTRUCTION, instruction.text, instruction.at)
    for i, goal in enumerate(design.page.goals.values()):
        yield Told(("tasks", i, "goal"), GOAL, goal)
    for i, form in enumerate(design.questionnaires):
        yield Told(("questionnaires", i, "title"), TITLE, form.title)
    for path, item in asked_items(design):
        yield Told((*path, "ask"), QUESTION, item.ask)


def asked_items(design: Design) -> Iterator[tuple[Path, Item]]:
    """All questions of demographics and questionnaires."""
    for i, item in enumerate(design.demographics):
        yield ("demographics", i), item
    for path, form in asked_forms(design):
        for j, item in enumerate(form.items):
            yield (*path, "items", j), item


def asked_forms(design: Design) -> Iterator[tuple[Path, Form]]:
    """All questionnaires."""
    for i, form in enumerate(design.questionnaires):
        yield ("questionnaires", i), form


def is_own(form: Form) -> bool:
    """True if the wording of a questionnaire is the design's own, in all languages."""
    return all(wording == "own" for wording in form.wording.values())


_END = re.compile(r"(?<=[.!?;:])\s+|(?<=[。！？；])|\n\s*\n")


def sentences(text: str) -> list[str]:
    """Sentences of a text, with spaces for breaks of lines; very long ones are in pieces."""
    return [piece for part in _END.split(text) for piece in wrap(part, LONGEST_SENTENCE)]


def quoted(sentence: str) -> str:
    """A sentence in quotation marks, shortened."""
    short = sentence if len(sentence) <= LONGEST_QUOTE else sentence[: LONGEST_QUOTE - 3] + "..."
    return f'"{short}"'


class Phrases:
    """Phrases by language, which are searched in lower case and without accents.

    Args:
        by_language: A regular expression by ISO 639-1 code.
    """

    def __init__(self, by_language: dict[str, str]) -> None:
        self._patterns = {
            code: re.compile(
                _plain_pattern(phrases) if code in _JOINED else rf"\b(?:{_plain_pattern(phrases)})"
            )
            for code, phrases in by_language.items()
        }

    def knows(self, language: str) -> bool:
        """True if there are phrases in a language."""
        return base(language) in self._patterns

    def match(self, text: str, language: str) -> re.Match[str] | None:
        """The first phrase in a text of a language; None if there is none."""
        pattern = self._patterns.get(base(language))
        return pattern.search(plain(text)) if pattern else None

    def all_matches(self, text: str, language: str) -> Iterator[re.Match[str]]:
        """All phrases in a text of a language."""
        pattern = self._patterns.get(base(language))
        return pattern.finditer(plain(text)) if pattern else iter(())


_JOINED = ("zh", "ja", "ko", "ar")
# Languages in which words are not separated, or are joined with articles.


def _plain_pattern(pattern: str) -> str:
    # `plain` would make \W into \w, so patterns are written without capitals.
    return plain(pattern)
