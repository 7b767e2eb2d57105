"""Declaration of table columns (name, unit, meaning), and rows written as CSV."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from sandbox.study.design.fields import LISTED

if TYPE_CHECKING:
    # A report imports this module for the names of columns, and must not load designs.
    from sandbox.study.design.design import Design

Row = dict[str, Any]
TABLES = "tables"
"""Name of the folder with the tables of a study."""
FACTOR = "factor_"
"""Prefix of the names of columns with levels."""
UXF_NAMES = {
    "study": "experiment",
    "participant": "ppid",
    "session": "session_num",
    "trial": "trial_num",
    "block": "block_num",
    "trial_in_block": "trial_num_in_block",
    "started_s": "start_time",
    "ended_s": "end_time",
}
"""Names of columns in UXF (Unity Experiment Framework), by the names in our tables."""
ORDERS = "orders of the design"
"""Row of the codebook with the number of participants in a full cycle of orders."""
WORDING = "wording of "
"""Prefix of the codebook's rows about questionnaires whose wording is not the published wording."""
PRIMARY = "primary"
"""Role of a confirmatory outcome in the codebook."""
STUDY = "study"
"""Value of the column `table` in rows of the codebook that are facts about the study."""
EXPERIMENT, TITLE, MODE, CONDITIONS = "experiment", "title", "mode", "conditions"
WITHDRAWALS, CHANGE = "withdrawals", "change "
"""Names of such rows: name, title and kind of data of the study, all combinations of levels, and
number of people who withdrew. `CHANGE` is the prefix of the rows on changes of the study after the
first participation."""
CLOCK_STEPS = "clock_steps"
"""Column of `participants.csv` with the steps of the wall clock."""


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


def factor_columns(design: Design, rows: Iterable[Row] = ()) -> list[Column]:
    """Columns of the factors of a design, and then of factors that only an earlier design had.

    Rows have factors of an earlier design after `--force-upgrade`.
    """
    columns = [
        Column(FACTOR + f.name, "", "level: " + LISTED.join(x.name for x in f.levels))
        for f in design.factors
    ]
    now = names_of(columns)
    earlier: dict[str, dict[str, None]] = {}
    for row in rows:
        for name, level in row.items():
            if name.startswith(FACTOR) and name not in now:
                earlier.setdefault(name, {})[level] = None
    return [
        *columns,
        *(
            Column(name, "", "level in an earlier design, empty since then: " + LISTED.join(levels))
            for name, levels in earlier.items()
        ),
    ]


def names_of(columns: Iterable[Column]) -> list[str]:
    """Names of columns."""
    return [column.name for column in columns]


def csv_bytes(
    rows: Iterable[Row], columns: Sequence[str], names: Mapping[str, str] = MappingProxyType({})
) -> bytes:
    """A table as CSV in UTF-8, with commas and decimal points.

    Yes and no are 1 and 0, and missing values are empty cells.

    Args:
        rows: The rows.
        columns: Names of the columns in the rows.
        names: Names of columns in the header line, by the names in the rows, if they differ.
    """
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(names.get(name, name) for name in columns)
    writer.writerows([_cell(row.get(name)) for name in columns] for row in rows)
    return text.getvalue().encode()


def is_empty(value: Any) -> bool:
    """True if a value gives an empty cell."""
    return value is None or value == ""


def _cell(value: Any) -> Any:
    if value is None:
        return ""
    if isinstance(value, bool):
        return int(value)
    if isinstance(value, float):
        return repr(round(value, 6))
    if isinstance(value, str):
        # Many readers end a row at a lone carriage return, which the csv module does not quote.
        return value.replace("\r\n", "\n").replace("\r", "\n")
    return value
