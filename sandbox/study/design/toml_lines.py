"""Finds the line numbers of keys in a TOML file, which the standard parser does not report.

The heading of a table is valid TOML by itself, as is a key with its value. So lines are gathered
until the standard parser accepts them; the keys that it then finds begin at the first gathered
line. In an array over several lines, each item gets its own line: closing brackets are appended to
the lines so far, so that the parser accepts them.
"""

from __future__ import annotations

import tomllib
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

Path = tuple[str | int, ...]

_CLOSING = ("", "]", "]]", "]}", "]}]", "]]]")
"""Brackets that complete an array whose end is on a later line."""
_ENDS = ('"""', "'''", "]", "}")
"""One of these is in the last line of a value over several lines, so a line without them need not
be parsed."""


class TomlLines:
    """Line numbers of the tables, keys and list items of a TOML text.

    For a text with a syntax error, the keys before the error have their lines.

    Args:
        text: Text of the file.

    Attributes:
        last: Line at which the last, unfinished value begins; 1 if there is none.
    """

    def __init__(self, text: str) -> None:
        self._lines: dict[Path, int] = {(): 1}
        self._counts: dict[Path, int] = {}
        self._table: Path = ()
        self.last = 1
        gathered, begin, closed, reads = "", 1, "", True
        for number, line in enumerate(text.split("\n"), 1):
            gathered += f"{line}\n"
            if not (reads or any(end in line for end in _ENDS)):
                continue
            reads = False
            for closing in (closed, *_CLOSING):
                with suppress(tomllib.TOMLDecodeError, RecursionError):
                    self._take(gathered, tomllib.loads(gathered + closing), begin)
                    gathered, begin, reads = gathered if closing else "", number + 1, True
                    closed = closing
                    break
        if gathered.strip():
            self.last = begin

    def of(self, path: Path) -> int:
        """Line number of a value, or of the nearest enclosing table or key."""
        while path not in self._lines:
            path = path[:-1]
        return self._lines[path]

    def has(self, path: Path) -> bool:
        """True if a table or key is written in the file."""
        return path in self._lines

    def _take(self, gathered: str, values: dict[str, Any], line: int) -> None:
        """Records the line of each key in the gathered lines.

        A table that several lines write (`text.en`, `text.de`) has the first of these lines.
        """
        if gathered.lstrip().startswith("["):
            self._heading(values, line)
            return
        for path in _paths(values):
            self._lines.setdefault((*self._table, *path), line)

    def _heading(self, values: Any, line: int) -> None:
        """Begins a table; `[a.b]` after `[[a]]` belongs to the last item of `a`."""
        path: Path = ()
        while values:
            if path in self._counts:
                path = (*path, self._counts[path])
            ((name, values),) = values.items()
            path = (*path, name)
            if isinstance(values, list):
                self._counts[path] = self._counts.get(path, -1) + 1
                self._lines.setdefault(path, line)
                path = (*path, self._counts[path])
                values = None
        self._table = path
        self._lines[path] = line


def _paths(value: Any, path: Path = ()) -> Iterator[Path]:
    """Paths of a value and of all values in it."""
    if path:
        yield path
    inner = value.items() if isinstance(value, dict) else ()
    for key, one in enumerate(value) if isinstance(value, list) else inner:
        yield from _paths(one, (*path, key))
