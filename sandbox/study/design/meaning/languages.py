"""Flaws of a study's languages: words that a participant would read in another one."""

from __future__ import annotations

from collections.abc import Iterator

from sandbox.study.design.design import Design
from sandbox.study.design.told.flaw import Flaw
from sandbox.study.design.told.texts import asked_items
from sandbox.words.words import LANGUAGES, base, words_of_studies

NAMED = 4
"""Number of missing words that a warning names."""


def language_flaws(design: Design) -> Iterator[Flaw]:
    """Flaws of a design's languages."""
    for code in design.languages:
        own = design.page.words.get(code, {})
        missing = [key for key in words_of_studies() if key not in own]
        if base(code) not in LANGUAGES and missing:
            some = ", ".join(missing[:NAMED]) + (", ..." if len(missing) > NAMED else "")
            yield Flaw(
                ("words", code) if own else ("languages",),
                f"the page has no words in {code}, and {len(missing)} of them would be in English: "
                f"{some}",
                f"Write them in [words.{code}]; sandbox/words/en.json has them all",
            )
    foreign = [code for code in design.languages if base(code) != "en"]
    if foreign and len(design.languages) > 1:
        for path, item in asked_items(design):
            if item.choices and not item.means:
                yield Flaw(
                    path,
                    f"the choices of {item.name!r} are read as they are stored in every language: "
                    f"{', '.join(item.choices)}",
                    "Write means = [...], with a text in each language for every choice",
                )
