"""Sentences for people: the English text, with a key and values for other languages."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

Values = Mapping[str, str | list[str]]


class Message(str):
    """An English sentence with its key and its values.

    It is a string of English text, and is printed and stored as such. A view in another language
    looks the key up among its own sentences (sandbox/words) and never compares the text.

    Args:
        key: Name of the sentence, the same in all languages.
        text: The English sentence, with its values as {name}.
        values: Values by name: numbers as they are printed, or names that another language
            translates; a list for several names.
    """

    key: str
    values: Values
    _text: str

    def __new__(cls, key: str, text: str, /, **values: str | list[str]) -> Message:
        shown = {name: ", ".join(v) if isinstance(v, list) else v for name, v in values.items()}
        self = super().__new__(cls, text.format(**shown))
        self.key, self.values = key, values
        self._text = text
        return self

    def __getnewargs_ex__(self) -> tuple[tuple[str, str], dict[str, Any]]:
        return (self.key, self._text), dict(self.values)


def counted(number: int, one: str, several: str | None = None) -> str:
    """A number with its noun: `1 trial`, `12 trials`, `1,204 people`.

    Args:
        number: The count.
        one: The noun in the singular.
        several: The noun in the plural; by default `one` with an s.
    """
    return f"{number:,} {one if number == 1 else several or one + 's'}"
