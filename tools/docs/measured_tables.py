"""Tables of a page of results, and what they say of a task.

A task is a column of a table or a cell of its rows; either way its name stands alone in a cell.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

_HEADING = re.compile(r"^(#+) +(.*)$")
_RULE = re.compile(r"^\|(?: *:?-+:? *\|)+$")


@dataclass(frozen=True)
class MeasuredTable:
    """A table of a page.

    Attributes:
        page: File that has it.
        heading: Heading above it; the page's title where there is no other.
        columns: Names of the columns.
        rows: Rows, each as long as `columns`.
    """

    page: Path
    heading: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def of_task(self, task: str) -> MeasuredTable | None:
        """The part about a task, without the column that names it; None if it has none.

        A task that is a column gives its rows with their names; one in cells gives its rows.
        """
        if task in self.columns:
            at = self.columns.index(task)
            named = tuple((row[0], row[at]) for row in self.rows if row[at])
            return MeasuredTable(self.page, self.heading, (self.columns[0], task), named)
        rows = tuple(row for row in self.rows if task in row)
        if not rows:
            return None
        at = rows[0].index(task)

        def without(cells: tuple[str, ...]) -> tuple[str, ...]:
            return cells[:at] + cells[at + 1 :]

        columns, shown = without(self.columns), tuple(map(without, rows))
        return MeasuredTable(self.page, self.heading, columns, shown)


def tables_of(page: Path) -> Iterator[MeasuredTable]:
    """The tables of a Markdown page, in its order."""
    heading, lines = "", page.read_text(encoding="utf-8").splitlines()
    for number, line in enumerate(lines):
        if match := _HEADING.match(line):
            heading = match[2]
        elif _RULE.match(line) and number:
            columns = _cells(lines[number - 1])
            rows = []
            for row in lines[number + 1 :]:
                if not row.startswith("|"):
                    break
                rows.append(_cells(row))
            yield MeasuredTable(page, heading, columns, tuple(rows))


def _cells(line: str) -> tuple[str, ...]:
    return tuple(cell.strip() for cell in line.strip().strip("|").split("|"))
