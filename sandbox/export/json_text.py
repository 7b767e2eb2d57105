"""A long JSON text, read value by value in little memory."""

from __future__ import annotations

import json
from typing import Any, NoReturn, TextIO

import msgspec
import numpy as np

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

    def values(self) -> list[Any]:
        """Decodes the next elements of a list: as many as are read, or one.

        Many at once are quicker. Where that is not sure to give the same, they come one by one.

        Raises:
            ValueError: As in `value`.
        """
        self.sign()
        end = _whole_elements(self._text[self._at :])
        if end:
            text = self._text[self._at : self._at + end]
            try:
                elements = msgspec.json.decode(f"[{text}]")
            except (msgspec.DecodeError, RecursionError):
                return [self.value()]
            self._at += end
            return list(elements)
        return [self.value()]

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


def _whole_elements(text: str) -> int:
    """Number of characters, from the first on, that are whole elements of a list and the commas
    between them; 0 where that is not sure.

    The last of them is an object. Texts with escapes, signs beyond ASCII or control characters in
    strings are not looked at.
    """
    if "\\" in text or not text.isascii():
        return 0
    signs = np.frombuffer(text.encode("ascii"), np.uint8)
    quoted = np.logical_xor.accumulate(signs == ord('"'))
    if (quoted & (signs < ord(" "))).any():
        return 0
    opens = ((signs == ord("{")) | (signs == ord("["))) & ~quoted
    closes = ((signs == ord("}")) | (signs == ord("]"))) & ~quoted
    depth = np.cumsum(opens.astype(np.int32) - closes)
    beyond = int(np.argmax(depth < 0)) if depth.min(initial=0) < 0 else len(depth)
    ends = np.nonzero((depth[:beyond] == 0) & closes[:beyond] & (signs[:beyond] == ord("}")))[0]
    return int(ends[-1]) + 1 if len(ends) else 0
