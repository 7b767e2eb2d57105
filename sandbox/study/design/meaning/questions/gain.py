"""Questions before and after, whose difference is a gain only if they are the same."""

from __future__ import annotations

import re
from collections.abc import Iterator

from sandbox.study.design.design import END, START, Design, Form, Item
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.plain import plain
from sandbox.study.design.told.texts import Phrases, asked_forms

ALIKE = 0.5
"""Share of words that two questions have in common at least, if they ask the same."""

_BEFORE = frozenset(
    ("pre", "before", "vorher", "vor", "avant", "antes", "previo", "t1", "baseline", "prae")
)
_AFTER = frozenset(("post", "after", "nachher", "nach", "apres", "despues", "posterior", "t2"))
"""Parts of names of questionnaires that are asked twice."""
TITLED = Phrases(
    {
        "en": r"before\b.*\bafter\b|pre-?\b.*\bpost\b",
        "de": r"(vorher|vor)\b.*\b(nachher|nach)\b|pra-?\b.*\bpost\b",
        "fr": r"avant\b.*\bapres\b|pre-?\b.*\bpost\b",
        "es": r"antes\b.*\bdespues\b|pre-?\b.*\bpost\b",
    }
)
"""Titles of studies of a change from before to after."""


def gain_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of pairs of questionnaires before and after."""
    forms = list(asked_forms(design))
    before = [some for some in forms if some[1].at == START and _scales(some[1])]
    after = [some for some in forms if some[1].at == END and _scales(some[1])]
    titled = any(TITLED.match(design.title, language) for language in design.languages)
    alone = titled and len(before) == len(after) == 1
    for _, first in before:
        for path, second in after:
            named = _stem(first.name, _BEFORE)
            if alone or (named is not None and named == _stem(second.name, _AFTER)):
                what = _difference(first, second)
                if what:
                    yield Flaw(
                        path,
                        f"its difference to {first.name} is no gain: {what}",
                        "Ask the same questions before and after, with the same low, high and ends",
                    )


def _scales(form: Form) -> list[Item]:
    return [item for item in form.items if item.kind in ("scale", "number")]


def _stem(name: str, marks: frozenset[str]) -> tuple[str, ...] | None:
    """A name without the part that says when it is asked; None if there is no such part."""
    parts = re.split(r"[-_ ]", plain(name))
    rest = tuple(part for part in parts if part not in marks)
    return rest if len(rest) < len(parts) else None


def _difference(first: Form, second: Form) -> str:
    """The first way in which two questionnaires differ; empty if they do not."""
    before, after = _scales(first), _scales(second)
    if len(before) != len(after):
        return f"{len(after)} answers are numbers, and {len(before)} of {first.name}"
    for one, other in zip(before, after, strict=True):
        if (one.low, one.high) != (other.low, other.high):
            return (
                f"{other.name} is from {other.low:g} to {other.high:g}, and {one.name} from "
                f"{one.low:g} to {one.high:g}"
            )
        if not all(_alike(one.ask[code], text) for code, text in other.ask.items()):
            return f"{other.name} asks something else than {one.name}"
        if one.ends is not None and other.ends is not None and one.ends != other.ends:
            return f"the ends of {other.name} have other words than those of {one.name}"
    return ""


def _alike(one: str, other: str) -> bool:
    a, b = (set(re.findall(r"\w+", plain(text))) for text in (one, other))
    return not a or not b or len(a & b) >= ALIKE * len(a | b)
