"""Words of the page in several languages, which the page and the program take from the same files.

A file has the language's name in itself, its status (the original, or whether a native speaker has
read it), and sentences by key in groups. A sentence may have values in braces. Lengths come in
inches and in centimetres, of which a language says one: `{width_in}` or `{width_cm}`. A value that
names a thing is looked up as `VALUE_THING`: for `{box}` with the value `base` it is `box_base`.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

LANGUAGES = ("en", "de", "fr", "es", "zh", "ja", "ar")
"""Languages with a file, by ISO 639-1, in the order of the menu."""
GROUPS = ("page", "headset", "play", "study", "tasks", "missing", "notices")
"""Groups of sentences. `page`: on every page; `headset`: on that of a headset; `play`: outside of
studies; `study`: in studies; `tasks`: names and goals of built-in tasks; `missing`: what a task
lacks; `notices`: what the program has to tell."""
SEEN_IN_STUDIES = ("page", "study", "tasks", "notices")
"""Groups that every participant may get to read."""
RESULT = "result"
"""Item of a design's `shows` with which participants also read what a task lacks."""

LONGEST_HEADER = 500
"""Characters of an `Accept-Language` that are read; browsers send fewer than a hundred."""

_VALUE = re.compile(r"\{(\w+?)(?:_in|_cm)?\}")


@dataclass(frozen=True)
class Language:
    """The words of a language.

    Attributes:
        name: The language's name in itself.
        status: `original`, `read by a native speaker`, or `not read by a native speaker`.
        groups: Sentences by group and key.
    """

    name: str
    status: str
    groups: dict[str, dict[str, str]]

    @property
    def words(self) -> dict[str, str]:
        """All sentences by key."""
        return {key: text for group in self.groups.values() for key, text in group.items()}


@cache
def language(code: str) -> Language:
    """The words of a language among `LANGUAGES`."""
    text = files("sandbox.words").joinpath(f"{code}.json").read_text(encoding="utf-8")
    given = json.loads(text)
    return Language(given["name"], given["status"], {group: given[group] for group in GROUPS})


def base(code: str) -> str:
    """The language of a tag: `de` for `de-AT`."""
    return code.lower().replace("_", "-").split("-")[0]


def preferred(accepted: str) -> str:
    """The first language with a file among those of a browser's `Accept-Language`; else English."""
    weighed = []
    for entry in accepted[:LONGEST_HEADER].split(","):
        tag, _, weight = entry.strip().partition(";q=")
        try:
            weighed.append((-float(weight or 1.0), base(tag)))
        except ValueError:
            continue
    wanted = [code for _, code in sorted(weighed, key=lambda one: one[0])]
    return next((code for code in wanted if code in LANGUAGES), "en")


def words_in(code: str, own: dict[str, str] | None = None) -> dict[str, str]:
    """All sentences in a language, by key.

    Args:
        code: The language; without a file it is English.
        own: Sentences that replace them.
    """
    known = base(code) if base(code) in LANGUAGES else "en"
    return {**language(known).words, **(own or {})}


def words_of_studies(shows: Collection[str] = ()) -> dict[str, str]:
    """English sentences that a participant may get to read, by key.

    Args:
        shows: What a trial shows, as in a design.
    """
    groups = language("en").groups
    seen = (*SEEN_IN_STUDIES, "missing") if RESULT in shows else SEEN_IN_STUDIES
    return {key: text for group in seen for key, text in groups[group].items()}


def values_of(text: str) -> set[str]:
    """Names of the values in a sentence; inches and centimetres count as the same."""
    return set(_VALUE.findall(text))
