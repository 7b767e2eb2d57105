"""The draft of the paper has the form that the Journal of Open Source Software asks for."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tools.docs.owner import to_fill_in

ROOT = Path(__file__).parents[1]
PAPER = ROOT / "paper" / "paper.md"
SECTIONS = (
    "Summary",
    "Statement of need",
    "State of the field",
    "Software design",
    "Research impact statement",
    "AI usage disclosure",
    "Acknowledgements",
    "References",
)
NUMBER = re.compile(r"(?<![\w.-])\d+(?:\.\d+)?(?![\w-])")
NUMBERS_OF_TABLES = {"0", "1", "2", "3"}
"""Numbers of a table, a figure or a day, which no page needs to measure."""


@pytest.fixture(scope="module")
def text() -> str:
    return PAPER.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def body(text: str) -> str:
    """The paper without its header."""
    return text.split("\n---\n", 1)[1]


@pytest.fixture(scope="module")
def entries() -> set[str]:
    """Keys of the bibliography."""
    bibliography = (ROOT / "paper" / "paper.bib").read_text(encoding="utf-8")
    return set(re.findall(r"^@\w+\{(\w+),$", bibliography, re.M))


def test_the_header_has_what_the_journal_asks_for(text: str) -> None:
    header = text.split("\n---\n", 1)[0]
    for field in ("title", "tags", "authors", "affiliations", "date", "bibliography"):
        assert re.search(rf"^{field}:", header, re.M), field
    assert "bibliography: paper.bib" in header


def test_the_sections_are_the_required_ones_in_their_order(body: str) -> None:
    assert tuple(re.findall(r"^# (.*)$", body, re.M)) == SECTIONS


def test_the_paper_has_between_750_and_1750_words(body: str) -> None:
    assert 750 <= len(body.split()) <= 1750


def test_every_citation_has_an_entry_and_every_entry_is_cited(body: str, entries: set[str]) -> None:
    assert set(re.findall(r"\[@(\w+)\]", body)) == entries


def test_every_figure_is_there(body: str) -> None:
    figures = re.findall(r"^!\[[^\]]*\]\(([^)]+)\)$", body, re.M | re.S)
    assert figures
    assert all((PAPER.parent / figure).is_file() for figure in figures)


def test_every_number_stands_in_the_documentation(body: str) -> None:
    prose = re.sub(r"\(https?:[^)]*\)|`[^`]*`|<[^>]*>", "", body)
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md")]
    known = set(NUMBER.findall(" ".join(page.read_text(encoding="utf-8") for page in pages)))
    assert set(NUMBER.findall(prose)) - NUMBERS_OF_TABLES - known == set()


def test_what_only_the_owner_knows_is_marked_and_listed(text: str) -> None:
    listed = "\n".join(to_fill_in())
    marked = re.findall(r"<([^>]+)>", text)
    assert marked
    assert all(words.split(",")[0] in listed for words in marked)
