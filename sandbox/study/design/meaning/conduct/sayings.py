"""Statements of a design's texts that say several things at once."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from textwrap import wrap

from sandbox.study.design.design import Design
from sandbox.study.design.told.texts import (
    CONSENT,
    INSTRUCTION,
    LONGEST_SENTENCE,
    Phrases,
    Told,
    told_texts,
)
from sandbox.study.design.told.words import DENIES
from sandbox.study.measures.registry import find_measure, is_time

_STOP = re.compile(r"(?<=[.!?])\s+|(?<=[。！？])|\n\s*\n")


def statements(text: str) -> list[str]:
    """Sentences of a text up to full stops: what follows a colon belongs to them."""
    return [piece for part in _STOP.split(text) for piece in wrap(part, LONGEST_SENTENCE)]


def said(
    design: Design,
    all_of: Sequence[Phrases],
    none_of: Sequence[Phrases] = (DENIES,),
    kinds: Sequence[str] = (CONSENT, INSTRUCTION),
) -> Iterator[tuple[Told, str, str]]:
    """Texts with a statement that has a phrase of each kind: text, language and statement.

    Args:
        design: The design.
        all_of: Phrases of which each is in the statement.
        none_of: Phrases of which none is in it; those that deny unless others are given.
        kinds: Kinds of texts.
    """
    for told in told_texts(design):
        for language, text in told.text.items() if told.kind in kinds else ():
            for statement in statements(text):
                has = all(phrases.match(statement, language) for phrases in all_of)
                if has and not any(phrases.match(statement, language) for phrases in none_of):
                    yield told, language, statement


def measures_time(design: Design) -> bool:
    """True if a time or speed is a confirmatory outcome, or all outcomes are tested."""
    return not design.primary or any(is_time(name) for name in design.primary)


def measures_trials(design: Design) -> bool:
    """True if what is measured in trials is a confirmatory outcome, or all outcomes are tested."""
    return not design.primary or any(
        name in ("time_s", "success") or find_measure(name) is not None for name in design.primary
    )
