"""Every language says all that English says, everything that is said has words, and no other."""

from __future__ import annotations

import ast
import pickle
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest

from models.message import Message
from sandbox.server.page_frames import localised
from sandbox.study.design.fields import WORDINGS
from sandbox.words import (
    GROUPS,
    LANGUAGES,
    language,
    preferred,
    values_of,
    words_in,
    words_of_studies,
)
from tasks.registry import TASKS, hands_of
from tasks.stack import NAMES

ROOT = Path(__file__).resolve().parents[3]
PACKAGES = ("models", "encoders", "tasks", "sandbox")
SOURCES = {".py", ".ts", ".mjs"}
KEY = re.compile(r"""["'`](\w+)["'`]|\b(?:play|page|p)\.(\w+)""")
"""A key in a source: a string, or a name in a language's file."""
ENGLISH = words_in("en")
MADE_AT_RUN_TIME = {
    *(f"{what}_{task}" for what in ("task", "goal", "how") for task in TASKS),
    *(f"how_{task}_shared" for task, kind in TASKS.items() if hands_of(kind) == 2),
    *(f"{what}_{box}" for what in ("box", "below") for box in NAMES),
    *(f"wording_{wording}" for wording in WORDINGS),
    "side_left",
    "side_right",
}


@cache
def messages() -> tuple[tuple[str, set[str]], ...]:
    """Key and values of every message in the program."""
    return tuple(_messages())


def _messages() -> Iterator[tuple[str, set[str]]]:
    for package in PACKAGES:
        for path in (ROOT / package).rglob("*.py"):
            source = path.read_text(encoding="utf-8")
            if "Message(" not in source:
                continue
            for node in ast.walk(ast.parse(source)):
                if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Message":
                    keys = [n for n in ast.walk(node.args[0]) if isinstance(n, ast.Constant)]
                    given = {values_name(k.arg) for k in node.keywords if k.arg}
                    lengths = (
                        {"width", "height"} if any(not k.arg for k in node.keywords) else set()
                    )
                    for key in keys:
                        if isinstance(key.value, str):
                            yield key.value, given | lengths


def values_name(name: str) -> str:
    (found,) = values_of(f"{{{name}}}")
    return found


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_language_has_the_keys_and_values_of_english(code: str) -> None:
    given, english = language(code), language("en")
    for group in GROUPS:
        assert list(given.groups[group]) == list(english.groups[group]), group
    for key, text in given.words.items():
        assert text == text.strip() and text, key
        assert values_of(text) == values_of(ENGLISH[key]), key
    assert given.status in ("original", "read by a native speaker", "not read by a native speaker")
    assert (given.status == "original") == (code == "en")


def test_everything_that_the_program_tells_has_words_with_no_other_values() -> None:
    found = dict(messages())
    assert {"box_from_goal", "stuck", "too_small", "too_small_beside_lift"} <= set(found)
    for key, given in messages():
        assert key in ENGLISH, key
        assert values_of(ENGLISH[key]) <= given, key


def test_every_key_is_used() -> None:
    used = set(MADE_AT_RUN_TIME)
    for package in PACKAGES:
        for path in (ROOT / package).rglob("*"):
            if path.suffix in SOURCES and not {"node_modules", "static"} & set(path.parts):
                used.update(*map(set, KEY.findall(path.read_text(encoding="utf-8"))))
    assert sorted(set(ENGLISH) - used) == []


def test_a_tag_with_a_country_has_the_words_of_its_language_and_an_unknown_one_english() -> None:
    assert words_in("de-AT") == words_in("de") != words_in("en")
    assert words_in("xx") == words_in("en")
    assert words_in("xx", {"next": "Suyu"})["next"] == "Suyu"
    assert words_of_studies().keys() < ENGLISH.keys()


@pytest.mark.parametrize(
    ("accepted", "code"),
    [
        ("de-AT,de;q=0.9,en;q=0.8", "de"),
        ("nl,en;q=0.4,ja;q=0.7", "ja"),
        ("", "en"),
        ("*", "en"),
        ("fr;q=much, es", "es"),
        ("x" * 100_000 + ",de", "en"),
    ],
)
def test_a_refused_browser_is_told_so_in_a_language_that_it_accepts(
    accepted: str, code: str
) -> None:
    assert preferred(accepted) == code


def test_a_message_is_english_text_that_knows_its_key_also_in_another_process() -> None:
    one = Message("stack_not_on", "the {box} box is not on {below}", box="second", below="base")
    assert one == "the second box is not on base"
    again = pickle.loads(pickle.dumps(one))
    assert (again, again.key, again.values) == (one, one.key, one.values)
    assert localised(one).values == {"box": "second", "below": "base"}
    assert localised("of another task") == type(localised(one))("", {}, "of another task")
    assert str(Message("tasks_that_fit", "{task}.", task=["a", "b"])) == "a, b."
