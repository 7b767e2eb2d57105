"""What tests of the report share: planted studies, changed tables, and what is in a page."""

from __future__ import annotations

from html.parser import HTMLParser
from pathlib import Path
from typing import Any

from sandbox.study.report.make import make_report
from sandbox.study.tables.column import csv_bytes
from tests.support.planted_study import COLUMNS, Truth, write_study
from tests.support.study_files import rows_of

SMALL = Truth(people=6, repetitions=2)
FILES = {"report.html", "analysis.R", "results.csv", "people.csv", "codebook.csv"}

Rows = list[dict[str, Any]]


def planted(folder: Path, truth: Truth = SMALL, seed: int = 1) -> Rows:
    """A study's rows, as text, after it was written."""
    write_study(folder, truth, seed)
    return rows_of(folder / "tables/trials.csv")


LEAN = tuple(c for c in COLUMNS if c not in ("instant", "held", "final", "progress"))
"""Every further measure is a picture more."""


def put(folder: Path, rows: Rows, columns: tuple[str, ...] = LEAN) -> None:
    (folder / "tables").mkdir(parents=True, exist_ok=True)
    (folder / "tables/trials.csv").write_bytes(csv_bytes(rows, columns))


def write(folder: Path, name: str, rows: Rows) -> None:
    """Writes another table of a study, with the columns of its first row."""
    (folder / "tables" / name).write_bytes(csv_bytes(rows, tuple(rows[0])))


class Page(HTMLParser):
    """What is in a page: its words, ids, and everything that would fetch something."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.words: list[str] = []
        self.ids: list[str] = []
        self.fetches: list[str] = []
        self.open: list[str] = []
        self.tables = self.pictures = 0
        self._in: str = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self._in = tag
        self.tables += tag == "table"
        self.pictures += tag == "svg"
        for name, value in attrs:
            if name == "id":
                self.ids.append(value or "")
            if name in ("src", "href", "data", "action") and not (value or "").startswith("#"):
                self.fetches.append(f"{tag} {value}")
        if tag in ("script", "link", "iframe", "object", "embed", "img"):
            self.fetches.append(tag)

    def handle_data(self, data: str) -> None:
        if self._in != "style":
            self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())


def report(folder: Path) -> Page:
    text = make_report(folder, folder / "report").read_text(encoding="utf-8")
    assert "nan" not in Page(text).text.lower().split(), "what is not known is not called nan"
    return Page(text)


def hostile_names(rows: Rows) -> Rows:
    names = {"a": '<script>alert("1")</script>', "b": "_$x^, 'ü' \"q\"", "c": "=1"}
    people = {"P001": "12E345", "P002": "000123", "P003": "1"}
    return [
        {
            **r,
            "factor_encoder": names[r["factor_encoder"]],
            "ppid": people.get(r["ppid"], r["ppid"]),
            "experiment": "<b>&amp;",
        }
        for r in rows
    ]
