"""Reads tables of a file and remembers every mistake with line and remedy, not only the first."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from models.errors import StudyError
from sandbox.study.design.toml_lines import Path, TomlLines

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9_-]{0,63}$")
"""Names of folders and columns: readable by every program on every system."""

Text = dict[str, str]
"""A text by language."""


@dataclass(frozen=True)
class Mistake:
    """Something wrong in a file: its line, what it is about, what is wrong, and what to do."""

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
        tried: True if levels were tried, too.
    """

    def __init__(self, file: str, mistakes: Sequence[Mistake], tried: bool = True) -> None:
        self.file = file
        self.mistakes = tuple(sorted(mistakes, key=lambda m: m.line))
        count = len(self.mistakes)
        lines = "".join(f"\n  {m}" for m in self.mistakes)
        more = "" if tried else "\n  Levels are tried once this is put right."
        super().__init__(
            f"{count} mistake{'s' * (count > 1)} in the design{lines}{more}", where=file
        )


class Reader:
    """State shared by all tables of one file: its lines, languages, sessions and mistakes so
    far."""

    def __init__(self, text: str) -> None:
        self.lines = TomlLines(text)
        self.mistakes: list[Mistake] = []
        self.languages: tuple[str, ...] = ("en",)
        self.sessions = 1

    def wrong(self, path: Path, what: str, remedy: str) -> None:
        """Remembers a mistake."""
        where = ""
        for part in path:
            where += f"[{part + 1}]" if isinstance(part, int) else f".{part}" if where else part
        self.mistakes.append(Mistake(self.lines.of(path), where, what, remedy))


class TomlTable:
    """Reader of one table: values are taken out one by one, and remaining ones are mistakes.

    Args:
        reader: Reader of the file.
        values: The parsed values.
        path: Path of the table in the file.
    """

    def __init__(self, reader: Reader, values: dict[str, Any], path: Path = ()) -> None:
        self.reader, self.path = reader, path
        self._values = dict(values)
        self._known: list[str] = []

    def has(self, key: str) -> bool:
        """True if a value is given and not yet taken."""
        return key in self._values

    def wrong(self, key: str, what: str, remedy: str) -> None:
        """Remembers a mistake in one of the values."""
        self.reader.wrong((*self.path, *([key] if key else [])), what, remedy)

    def raw(self, key: str, default: Any = None) -> Any:
        """A value of any kind."""
        self._known.append(key)
        return self._values.pop(key, default)

    def number(
        self, key: str, default: float, least: float, most: float, whole: bool = False
    ) -> Any:
        """A number within bounds."""
        value = self.raw(key, default)
        kind = int if whole else (int, float)
        if isinstance(value, bool) or not isinstance(value, kind) or not least <= value <= most:
            noun = "a whole number" if whole else "a number"
            self.wrong(key, f"got {value!r}", f"Write {noun} from {least:g} to {most:g}")
            return default
        return value

    def string(self, key: str, default: str | None = None) -> str:
        """A string; required if it has no default."""
        if default is None and not self.has(key):
            self._known.append(key)
            self.wrong("", f"`{key}` is missing", f'Add a line such as {key} = "..."')
            return ""
        value = self.raw(key, default)
        if not isinstance(value, str) or (default is None and not value.strip()):
            self.wrong(key, f"got {value!r}", "Write a text in quotation marks")
            return default or ""
        return value

    def name(self, key: str) -> str:
        """A name of a file, a column or a row."""
        name = self.string(key)
        if name and not NAME.match(name):
            self.wrong(
                key, f"got {name!r}", "Use up to 64 letters, digits, - and _; it names files"
            )
        return name

    def flag(self, key: str) -> bool:
        """True or false; false where it is not given."""
        value = self.raw(key, False)
        if not isinstance(value, bool):
            self.wrong(key, f"got {value!r}", "Write true or false")
        return value is True

    def choice(self, key: str, options: Sequence[str], default: str) -> str:
        """One of some words."""
        value = self.string(key, default)
        if value not in options:
            near = get_close_matches(value, options, 1)
            hint = f"Did you mean {near[0]}? " if near else ""
            self.wrong(key, f"got {value!r}", f"{hint}Write one of {', '.join(options)}")
            return default
        return value

    def strings(self, key: str, default: Sequence[str] = ()) -> tuple[str, ...]:
        """A list of strings."""
        value = self.raw(key, list(default))
        if not isinstance(value, list) or not all(isinstance(v, str) and v for v in value):
            self.wrong(key, f"got {value!r}", 'Write a list such as ["one", "two"]')
            return tuple(default)
        if len(set(value)) < len(value):
            self.wrong(key, "something is in the list twice", "Leave it out once")
        return tuple(value)

    def session_numbers(self, key: str) -> tuple[int, ...]:
        """Numbers of sessions; none where it is not given, which means all of them."""
        if not self.has(key):
            self._known.append(key)
            return ()
        value, most = self.raw(key), self.reader.sessions
        numbers = isinstance(value, list) and all(type(v) is int for v in value)
        if not numbers or not value or not all(1 <= v <= most for v in value):
            self.wrong(
                key,
                f"got {value!r}",
                f"Write numbers of sessions such as [1]; there are so many: {most} (`sessions`)",
            )
            return ()
        return tuple(value)

    def text(self, key: str) -> Text:
        """A text for the participant, in every language of the study."""
        value = self.raw(key)
        languages = self.reader.languages
        if isinstance(value, str) and len(languages) == 1:
            return {languages[0]: value}
        if isinstance(value, dict) and all(isinstance(v, str) for v in value.values()):
            missing = [lang for lang in languages if not value.get(lang)]
            if missing:
                self.wrong(
                    key,
                    f"no text in {', '.join(missing)}",
                    f'Add {missing[0]} = "..." or remove the language',
                )
            return {lang: value.get(lang, "") for lang in languages}
        example = ", ".join(f'{lang} = "..."' for lang in languages)
        wanted = '"..."' if len(languages) == 1 else f"{{{example}}}"
        if value is None:
            what = f"`{key}` is missing"
        elif isinstance(value, str):
            what = f"one text, and the study has {len(languages)} languages"
        else:
            what = f"got {value!r}"
        self.wrong(key if value is not None else "", what, f"Write {key} = {wanted}")
        return dict.fromkeys(languages, "")

    def table(self, key: str) -> TomlTable:
        """A table; an empty one where there is none."""
        value = self.raw(key, {})
        if not isinstance(value, dict):
            self.wrong(key, f"got {value!r}", f"Write a table: [{key}]")
            value = {}
        return TomlTable(self.reader, value, (*self.path, key))

    def tables(self, key: str) -> list[TomlTable]:
        """A list of tables."""
        value = self.raw(key, [])
        if not isinstance(value, list) or not all(isinstance(v, dict) for v in value):
            self.wrong(key, "not a list of tables", f"Begin each with [[{key}]]")
            return []
        return [TomlTable(self.reader, v, (*self.path, key, i)) for i, v in enumerate(value)]

    def done(self) -> None:
        """Whatever was not taken is unknown."""
        for key in self._values:
            near = get_close_matches(key, self._known, 1)
            remedy = (
                f"Did you mean {near[0]}?"
                if near
                else "Known here: " + ", ".join(sorted(set(self._known)))
            )
            self.wrong(key, "no such key", remedy)
