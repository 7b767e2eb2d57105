"""Declaration of table columns (name, unit, meaning), and rows written as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from sandbox.study.design.design import LISTED, Design

Row = dict[str, Any]
FACTOR = "factor_"
"""Prefix of the names of columns with levels."""


@dataclass(frozen=True)
class Earlier:
    """What rows have from an earlier design and their design has not, as after `--force-upgrade`.

    Attributes:
        factors: Levels of factors in order of appearance, by name of the column.
        questions: Questions about the person.
    """

    factors: Mapping[str, tuple[str, ...]] = field(default_factory=lambda: MappingProxyType({}))
    questions: tuple[str, ...] = ()


NO_EARLIER = Earlier()
"""What the rows of one design have."""


@dataclass(frozen=True)
class Column:
    """A column of a study's table.

    Attributes:
        name: Name in the header line of the table.
        unit: Unit of the numbers; `0/1` for yes or no; empty for words and counts.
        meaning: Definition in one line, for the codebook.
    """

    name: str
    unit: str
    meaning: str


def factor_columns(design: Design, earlier: Earlier = NO_EARLIER) -> list[Column]:
    """Columns of the factors of a design, and then those of earlier designs."""
    return [
        *(
            Column(FACTOR + f.name, "", "level: " + LISTED.join(x.name for x in f.levels))
            for f in design.factors
        ),
        *(
            Column(name, "", "level in an earlier design, empty since then: " + LISTED.join(levels))
            for name, levels in earlier.factors.items()
        ),
    ]


def earlier_factors(design: Design, rows: Iterable[Row]) -> Earlier:
    """Factors that rows have and a design has not."""
    own = {FACTOR + factor.name for factor in design.factors}
    return united(
        Earlier({name: (level,)})
        for row in rows
        for name, level in row.items()
        if name.startswith(FACTOR) and name not in own
    )


def united(some: Iterable[Earlier]) -> Earlier:
    """What any of several have."""
    levels: dict[str, dict[str, None]] = {}
    questions: dict[str, None] = {}
    for one in some:
        for name, names in one.factors.items():
            levels.setdefault(name, {}).update(dict.fromkeys(names))
        questions.update(dict.fromkeys(one.questions))
    return Earlier({name: tuple(names) for name, names in levels.items()}, tuple(questions))


def names_of(columns: Iterable[Column]) -> list[str]:
    """Names of columns."""
    return [column.name for column in columns]


def csv_bytes(rows: Iterable[Row], columns: Sequence[str]) -> bytes:
    """A table as CSV: UTF-8, separated by commas, with decimal points, 1 and 0 for yes and no, and
    empty cells for missing values."""
    return _lines([columns]) + csv_rows(rows, columns)


def csv_rows(rows: Iterable[Row], columns: Sequence[str]) -> bytes:
    """Rows as CSV, without the header line."""
    return _lines([_cell(row.get(name)) for name in columns] for row in rows)


def _lines(rows: Iterable[Sequence[Any]]) -> bytes:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue().encode()


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, float):
        return repr(round(value, 6))
    if isinstance(value, str):
        # The csv module does not quote a lone carriage return, but many readers end a row at it.
        return value.replace("\r\n", "\n").replace("\r", "\n")
    return value
