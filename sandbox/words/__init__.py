"""Texts of the page in several languages. The page and the program read the same files.

A file has the language's own name, its status (the original, or whether a native speaker has read
it), and texts by key, in groups. A text may have values in braces. Lengths are available in inches
and in centimetres; a language uses one of them: `{width_in}` or `{width_cm}`. The name of an object
is itself a text: for `{box}` with the value `base`, the key of the name is `box_base`.
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
"""Groups of texts. `page`: on every page; `headset`: on the page of a headset; `play`: outside of
studies; `study`: in studies; `tasks`: names and goals of built-in tasks; `missing`: reasons why a
goal is not reached; `notices`: notices of the program."""
SEEN_IN_STUDIES = ("page", "study", "tasks", "notices")
"""Groups that every participant may read."""
RESULT = "result"
"""Item of a design's `shows`. With it, participants also read the group `missing`."""

LONGEST_HEADER = 500
"""Number of characters of an `Accept-Language` that are read; browsers send less than a hundred."""

_VALUE = re.compile(r"\{(\w+?)(?:_in|_cm)?\}")


@dataclass(frozen=True)
class Language:
    """The texts of a language.

    Attributes:
        name: The language's name in this language.
        status: `original`, `read by a native speaker`, or `not read by a native speaker`.
        groups: Texts by group and key.
    """

    name: str
    status: str
    groups: dict[str, dict[str, str]]

    @property
    def words(self) -> dict[str, str]:
        """All texts by key."""
        return {key: text for group in self.groups.values() for key, text in group.items()}


@cache
def language(code: str) -> Language:
    """The texts of a language in `LANGUAGES`."""
    text = files(__name__).joinpath(f"{code}.json").read_text(encoding="utf-8")
    given = json.loads(text)
    return Language(given["name"], given["status"], {group: given[group] for group in GROUPS})


def base(code: str) -> str:
    """The language of a language tag: `de` for `de-AT`."""
    return code.lower().replace("_", "-").split("-")[0]


def preferred(accepted: str) -> str:
    """The preferred language of a browser's `Accept-Language` that has a file; else English."""
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
    """All texts in a language, by key.

    Args:
        code: The language; English is used for a language without a file.
        own: Texts by key that replace texts of the language.
    """
    known = base(code) if base(code) in LANGUAGES else "en"
    return {**language(known).words, **(own or {})}


def words_of_studies(shows: Collection[str] = ()) -> dict[str, str]:
    """English texts that a participant may read, by key.

    Args:
        shows: Items that a trial shows, as in a design.
    """
    groups = language("en").groups
    seen = (*SEEN_IN_STUDIES, "missing") if RESULT in shows else SEEN_IN_STUDIES
    return {key: text for group in seen for key, text in groups[group].items()}


def values_of(text: str) -> set[str]:
    """Names of the values in a text; a length in inches and in centimetres has the same name."""
    return set(_VALUE.findall(text))
