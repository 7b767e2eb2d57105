"""Reads tables of a TOML file and collects all mistakes, with line and remedy.

`TomlLines` finds the lines, which the standard parser does not report. The heading of a table is
valid TOML by itself, as is a key with its value. So lines are gathered until the standard parser
accepts them; the keys that it then finds begin at the first gathered line. In an array over several
lines, each item gets its own line: closing brackets are appended to the lines so far, so that the
parser accepts them.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from difflib import get_close_matches
from types import MappingProxyType
from typing import Any

from models.errors import StudyError
from sandbox.study.design.fields import WHOLE, Field, field_of

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}")
"""Names of folders and columns, valid in every program and system."""

Text = dict[str, str]
"""A text by language."""
Path = tuple[str | int, ...]
"""Place of a value in a file: keys of tables, and indices of lists."""

_CLOSING = ("", "]", "]]", "]}", "]}]", "]]]")
"""Brackets that complete an array whose end is on a later line."""
_ENDS = ('"""', "'''", "]", "}")
"""One of these is in the last line of a value over several lines, so a line without them need not
be parsed."""


@dataclass(frozen=True)
class Mistake:
    """A mistake in a file: its line, the value, what is wrong, and what to do."""

    line: int
    where: str
    what: str
    remedy: str

    def __str__(self) -> str:
        where = f"{self.where}: " if self.where else ""
        return f"line {self.line}: {where}{self.what}. {self.remedy}"


class DesignError(StudyError):
    """A design with mistakes; the message lists all of them.

    Args:
        file: Name of the file.
        mistakes: The mistakes, at least one.
        complete: True if combinations of levels were checked as well.
    """

    def __init__(self, file: str, mistakes: Sequence[Mistake], complete: bool = True) -> None:
        self.file = file
        self.mistakes = tuple(sorted(mistakes, key=lambda m: m.line))
        count = len(self.mistakes)
        lines = "".join(f"\n  {m}" for m in self.mistakes)
        more = "" if complete else "\n  Correct these first; levels are checked afterwards."
        super().__init__(
            f"{count} mistake{'s' * (count > 1)} in the design{lines}{more}", where=file
        )


class Reader:
    """State shared by all tables of one file.

    Attributes:
        lines: Line numbers of keys.
        mistakes: The mistakes so far.
        languages: Languages of the study.
        sessions: Number of sessions of the study.
        begun: True for the design of a study that has begun, which must stay readable.
    """

    def __init__(self, text: str) -> None:
        self.lines = TomlLines(text)
        self.mistakes: list[Mistake] = []
        self.languages: tuple[str, ...] = ("en",)
        self.sessions = 1
        self.begun = False

    def add_mistake(self, path: Path, what: str, remedy: str) -> None:
        """Adds a mistake."""
        self.mistakes.append(Mistake(self.lines.of(path), place_of(path), what, remedy))


def place_of(path: Path) -> str:
    """A path as text, such as `factors[1].levels`; items of a list are counted from 1."""
    where = ""
    for part in path:
        where += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if where else part
    return where


class TomlTable:
    """Reader of one table. Values are taken out one by one; `done` reports the remaining values.

    Args:
        reader: Reader of the file.
        values: The parsed values.
        path: Path of the table in the file.
        whose: Path under which `fields` declares the keys of the table, if it is not `path`. For a
            questionnaire's own file, it is `("questionnaires",)`.
    """

    def __init__(
        self, reader: Reader, values: dict[str, Any], path: Path = (), whose: Path | None = None
    ) -> None:
        self.reader, self.path = reader, path
        self._whose = path if whose is None else whose
        self._values = dict(values)
        self._known: list[str] = []

    def has(self, key: str) -> bool:
        """Returns True if a value is given and has not been taken out."""
        self._known.append(key)
        return key in self._values

    def add_mistake(self, key: str, what: str, remedy: str) -> None:
        """Adds a mistake in one of the values, or in the table if the key is empty."""
        self.reader.add_mistake((*self.path, *([key] if key else [])), what, remedy)

    def check_names(self, key: str, names: Sequence[str]) -> None:
        """Adds a mistake for each table of a list that has the name of an earlier table."""
        for i, name in enumerate(names):
            if name and name in names[:i]:
                path = (*self.path, key, i, "name")
                self.reader.add_mistake(path, f"{name!r} is used twice", "Rename one of them")

    def raw(self, key: str, default: Any = None) -> Any:
        """Takes a value of any kind."""
        self._known.append(key)
        return self._values.pop(key, default)

    def field(self, key: str) -> Field:
        """The declaration of a key in `fields`."""
        return field_of(self._whose, key)

    def number(self, key: str) -> Any:
        """Takes a number within its bounds."""
        known = self.field(key)
        value = self.raw(key, known.default)
        kind = int if known.kind == WHOLE else (int, float)
        within = isinstance(value, kind) and known.low <= value <= known.high
        if isinstance(value, bool) or not within:
            noun = "a whole number" if known.kind == WHOLE else "a number"
            plain = ", without quotation marks" if isinstance(value, str) else ""
            remedy = f"Write {noun} from {known.range}{plain}"
            self.add_mistake(key, f"got {value!r}", remedy)
            return known.low if known.default is None else known.default
        return value

    def string(self, key: str, default: str | None = None) -> str:
        """Takes a string. It is required if neither its declaration nor `default` has a default."""
        if default is None:
            default = self.field(key).default
        if default is None and not self.has(key):
            self.add_mistake("", f"`{key}` is missing", f'Add a line such as {key} = "..."')
            return ""
        value = self.raw(key, default)
        if not isinstance(value, str) or (default is None and not value.strip()):
            self.add_mistake(key, f"got {value!r}", "Write a text in quotation marks")
            return default or ""
        return value

    def name(self, key: str) -> str:
        """Takes a name that is used for files, columns or rows."""
        name = self.string(key)
        if name and not NAME.fullmatch(name):
            self.add_mistake(
                key,
                f"got {name!r}",
                "Use up to 64 letters from a to z, digits, - and _; it names files",
            )
        return name

    def flag(self, key: str) -> bool:
        """Takes a boolean."""
        value = self.raw(key, self.field(key).default)
        if not isinstance(value, bool):
            self.add_mistake(key, f"got {value!r}", "Write true or false")
        return value is True

    def choice(self, key: str, options: Sequence[str] = ()) -> str:
        """Takes one of several words.

        Args:
            key: Key of the table.
            options: The words, if `fields` does not declare them.
        """
        known = self.field(key)
        options, value = options or tuple(known.options), self.string(key)
        if value not in options and (value or known.default is not None):
            near = get_close_matches(value, options, 1)
            hint = f"Did you mean {near[0]}? " if near else ""
            self.add_mistake(key, f"got {value!r}", f"{hint}Write one of {', '.join(options)}")
            return str(known.default or "")
        return value

    def strings(self, key: str) -> tuple[str, ...]:
        """Takes a list of different strings."""
        default = self.field(key).default or ()
        value = self.raw(key, list(default))
        if not isinstance(value, list) or not all(isinstance(v, str) and v for v in value):
            self.add_mistake(key, f"got {value!r}", 'Write a list such as ["one", "two"]')
            return tuple(default)
        if len(set(value)) < len(value):
            self.add_mistake(key, "the list has a value twice", "Remove one of them")
        return tuple(value)

    def session_numbers(self, key: str) -> tuple[int, ...]:
        """Takes a list of session numbers; empty by default, which means all sessions."""
        if not self.has(key):
            return ()
        value, most = self.raw(key), self.reader.sessions
        numbers = isinstance(value, list) and all(type(v) is int for v in value)
        if not numbers or not value or not all(1 <= v <= most for v in value):
            self.add_mistake(
                key,
                f"got {value!r}",
                f"Write a list of session numbers from 1 to {most} (`sessions`), such as [1]",
            )
            return ()
        return tuple(value)

    def text(self, key: str) -> Text:
        """Takes a text for the participant, in every language of the study."""
        value = self.raw(key)
        languages = self.reader.languages
        if isinstance(value, str) and len(languages) == 1:
            if not value.strip():
                self.add_mistake(key, "the text is empty", "Write it, or remove the line")
            return {languages[0]: value}
        if isinstance(value, dict) and all(isinstance(v, str) for v in value.values()):
            missing = [lang for lang in languages if not value.get(lang, "").strip()]
            if missing:
                self.add_mistake(
                    key,
                    f"the text is missing in {', '.join(missing)}",
                    f'Add {missing[0]} = "..." or remove the language',
                )
            return {lang: value.get(lang, "") for lang in languages}
        example = ", ".join(f'{lang} = "..."' for lang in languages)
        wanted = '"..."' if len(languages) == 1 else f"{{{example}}}"
        if value is None:
            what = f"`{key}` is missing"
        elif isinstance(value, str):
            what = f"there is only one text for {len(languages)} languages"
        else:
            what = f"got {value!r}"
        self.add_mistake(key if value is not None else "", what, f"Write {key} = {wanted}")
        return dict.fromkeys(languages, "")

    def table(self, key: str) -> TomlTable:
        """Takes a table; empty by default."""
        value = self.raw(key, {})
        if not isinstance(value, dict):
            self.add_mistake(key, f"got {value!r}", f"Write it as a table: [{key}]")
            value = {}
        return TomlTable(self.reader, value, (*self.path, key), (*self._whose, key))

    def values(self, key: str) -> dict[str, Any]:
        """Takes the values of a table, unchecked; empty by default."""
        return self.table(key)._values

    def tables(self, key: str, common: Mapping[str, Any] = MappingProxyType({})) -> list[TomlTable]:
        """Takes a list of tables; empty by default.

        Args:
            key: Key of the list.
            common: Values of each table that does not have its own.
        """
        value = self.raw(key, [])
        if not isinstance(value, list) or not all(isinstance(v, dict) for v in value):
            self.add_mistake(key, "not a list of tables", f"Begin each table with [[{key}]]")
            return []
        return [
            TomlTable(self.reader, {**common, **v}, (*self.path, key, i), (*self._whose, key))
            for i, v in enumerate(value)
        ]

    def done(self) -> None:
        """Adds a mistake for each value that was not taken out."""
        from sandbox.study.design.conditions import setting_types

        for key in self._values:
            near = get_close_matches(key, self._known, 1)
            remedy = "Keys here are: " + ", ".join(sorted(set(self._known)))
            if near:
                remedy = f"Did you mean {near[0]}?"
            elif key in setting_types():
                remedy = "It stands under [settings], or in a level of a factor"
            self.add_mistake(key, "unknown key", remedy)


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
