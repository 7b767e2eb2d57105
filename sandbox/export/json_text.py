"""A long JSON text, read value by value in little memory."""

from __future__ import annotations

import json
import re
from typing import Any, NamedTuple, NoReturn, TextIO

import msgspec
import numpy as np

CHUNK = 1 << 18
"""Characters read at a time."""
LARGEST = 1 << 21
"""Characters of the largest value."""
_CLOSING = 3
"""Last characters of an element by which its end is known."""
_NEXT = re.compile(r'\s*,\s*\{\s*"[^"\\]*"')
"""A comma and the first name in the next element."""


EVERYTHING = msgspec.json.Decoder(list[Any])
"""Decodes elements as plain values."""


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not JSON")


class Joint(NamedTuple):
    """The signs at which one element of a list follows another.

    Attributes:
        signs: The last ones of an element, a comma, and the first name in the next element; empty
            where they are not known.
        closing: Number of those that belong to the first element.
    """

    signs: str
    closing: int

    @classmethod
    def behind(cls, text: str, end: int) -> Joint:
        """The joint at the end of an element in a text."""
        after, begin = _NEXT.match(text, end), max(end - _CLOSING, 0)
        return cls(text[begin : after.end()], end - begin) if after else cls("", 0)

    def last(self, text: str) -> int:
        """Number of characters before the last place with these signs.

        That they are whole elements shows when they are decoded. 0 where there is no such place,
        or where it is not sure that a decoder gives for many elements what it gives one by one.
        """
        at = text.rfind(self.signs) if self.signs else -1
        if at < 0 or "\\" in text or not text.isascii():
            return 0
        if np.frombuffer(text.encode("ascii"), np.uint8).min() < ord(" "):
            return 0
        return at + self.closing


class JsonText:
    """A position in a JSON text, whose values are decoded one by one.

    Args:
        file: The text, from its beginning.
    """

    def __init__(self, file: TextIO) -> None:
        self._file = file
        self._decoder = json.JSONDecoder(parse_constant=_refuse)
        self._text, self._at = "", 0
        self._joint: Joint | None = None

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

    def values(self, decoder: msgspec.json.Decoder[list[Any]] = EVERYTHING) -> list[Any]:
        """Decodes the next elements of a list: as many as are read, or one.

        Many at once are quicker. Where that is not sure to give the same, they come one by one.

        Args:
            decoder: Decodes a list of them. Elements of another type than its own, and those that
                come one by one, are plain values.

        Raises:
            ValueError: As in `value`.
        """
        self.sign()
        text = self._text[self._at :]
        if self._joint is None:
            value = self.value()
            self._joint = Joint.behind(self._text, self._at)
            return [value]
        end = self._joint.last(text)
        if end:
            elements = self._decoded(text, end, decoder)
            if elements is not None:
                return elements
            self._joint = Joint("", 0)
        elements = self._decoded(text, _whole_elements(text), decoder)
        return [self.value()] if elements is None else elements

    def _decoded(
        self, text: str, end: int, decoder: msgspec.json.Decoder[list[Any]]
    ) -> list[Any] | None:
        """Decodes elements in the next characters, up to an end, and goes on behind them.

        None if they are not whole elements.
        """
        if not end:
            return None
        try:
            try:
                elements = decoder.decode(f"[{text[:end]}]")
            except msgspec.ValidationError:
                elements = EVERYTHING.decode(f"[{text[:end]}]")
        except (msgspec.DecodeError, RecursionError):
            return None
        self._at += end
        return elements

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
