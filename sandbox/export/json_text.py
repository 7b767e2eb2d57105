"""A long JSON text, read value by value in little memory."""

from __future__ import annotations

import json
from typing import Any, NoReturn, TextIO

CHUNK = 1 << 17
"""Characters read at a time."""
LARGEST = 1 << 21
"""Characters of the largest value."""


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not JSON")


class JsonText:
    """A position in a JSON text, whose values are decoded one by one.

    Args:
        file: The text, from its beginning.
    """

    def __init__(self, file: TextIO) -> None:
        self._file = file
        self._decoder = json.JSONDecoder(parse_constant=_refuse)
        self._text, self._at = "", 0

    def sign(self) -> str:
        """The next character that is not white space; empty at the end of the text."""
        while True:
            while self._at < len(self._text):
                if not self._text[self._at].isspace():
                    return self._text[self._at]
                self._at += 1
            if not self._more():
                return ""

    def skip(self) -> None:
        """Goes over the character that `sign` returned."""
        self._at += 1

    def value(self) -> Any:
        """Decodes the next value.

        Raises:
            ValueError: There is none, it is damaged, cut short or larger than `LARGEST`.
        """
        self.sign()
        while True:
            try:
                value, end = self._decoder.raw_decode(self._text, self._at)
            except ValueError:
                if len(self._text) - self._at > LARGEST or not self._more():
                    raise
                continue
            # A number at the end of what was read may go on.
            if end < len(self._text) or not self._more():
                self._at = end
                return value

    def rest(self) -> str:
        """The rest of the text, at most `LARGEST` characters of it."""
        while len(self._text) - self._at < LARGEST and self._more():
            pass
        return self._text[self._at :]

    def close(self) -> None:
        """Closes the file."""
        self._file.close()

    def _more(self) -> bool:
        """Reads on, and forgets what lies behind; False at the end of the file."""
        more = self._file.read(CHUNK)
        self._text, self._at = self._text[self._at :] + more, 0
        return bool(more)
