"""Tables of a page of results, and their parts about a task.

A table has a task as a column, or as a cell of its rows. In both cases a cell contains only the
task's name.
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
        page: File that contains the table.
        heading: Heading above the table; the page's title if there is no other heading.
        columns: Names of the columns.
        rows: Rows, each as long as `columns`.
    """

    page: Path
    heading: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]

    def of_task(self, task: str) -> MeasuredTable | None:
        """The part of the table about a task, without the column of task names.

        If the task is a column, the part consists of this column and the names of the rows.
        Otherwise it consists of the task's rows. None if the table is not about the task.
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
