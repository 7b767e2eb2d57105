"""Finds the line numbers of keys in a TOML file, which the standard parser does not report."""

from __future__ import annotations

import re

Path = tuple[str | int, ...]

_HEADER = re.compile(r"\s*(\[{1,2})\s*([^\[\]]+?)\s*\]{1,2}\s*(#.*)?$")
_KEY = re.compile(r"""\s*([\w-]+|"[^"]*"|'[^']*')\s*(\.[\w.-]+\s*)?=""")
_TRIPLE = re.compile(r'"""|' + "'''")


class TomlLines:
    """Line numbers of the tables and keys of a TOML text.

    Args:
        text: Text of the file, which must be valid TOML.
    """

    def __init__(self, text: str) -> None:
        self._lines: dict[Path, int] = {(): 1}
        counts: dict[Path, int] = {}
        table: Path = ()
        fence = ""
        for number, line in enumerate(text.split("\n"), start=1):
            if not fence:
                if header := _HEADER.match(line):
                    names = tuple(n.strip().strip("\"'") for n in header[2].split("."))
                    table = self._inner(names[:-1], counts) + names[-1:]
                    if header[1] == "[[":
                        counts[table] = counts.get(table, -1) + 1
                        self._lines.setdefault(table, number)
                        table = (*table, counts[table])
                    self._lines[table] = number
                elif key := _KEY.match(line):
                    # Of `text.en` and `text.de`, the first is the line of `text`.
                    self._lines.setdefault((*table, key[1].strip("\"'")), number)
            for mark in _TRIPLE.findall(line):
                fence = "" if mark == fence else fence or mark

    def of(self, path: Path) -> int:
        """Line number of a value, or of the nearest enclosing table or key."""
        while path not in self._lines:
            path = path[:-1]
        return self._lines[path]

    def has(self, path: Path) -> bool:
        """True if a table or key is written in the file."""
        return path in self._lines

    @staticmethod
    def _inner(names: tuple[str, ...], counts: dict[Path, int]) -> Path:
        """Path of a table; `[a.b]` after `[[a]]` belongs to the last item of `a`."""
        path: Path = ()
        for name in names:
            path = (*path, name)
            if path in counts:
                path = (*path, counts[path])
        return path
