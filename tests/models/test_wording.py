"""Numbers with their nouns."""

from __future__ import annotations

import pytest

from models.message import counted


@pytest.mark.parametrize(
    ("number", "words"), [(0, "0 trials"), (1, "1 trial"), (2, "2 trials"), (1204, "1,204 trials")]
)
def test_a_noun_agrees_with_its_number(number: int, words: str) -> None:
    assert counted(number, "trial") == words


def test_a_noun_may_have_a_plural_of_its_own() -> None:
    assert counted(1, "person", "people") == "1 person"
    assert counted(12, "person", "people") == "12 people"
