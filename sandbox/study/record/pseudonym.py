"""Pseudonyms of participants, with a check character that detects writing errors."""

from __future__ import annotations

import secrets

from models.errors import StudyError

ALPHABET = "0123456789ABCDEFGHJKMNPQRSTVWXYZ"
"""Crockford's base 32: no I, L, O, U."""
LENGTH = 5
_SLIPS = str.maketrans("ILO", "110")
"""Letters that are often written instead of digits, and the digits."""
_MONTHS = ("JAN", "FEB", "MAR", "APR", "MAY", "SEP", "DEC")
"""Abbreviations of months that consist of letters of `ALPHABET`."""


def _check(body: str) -> str:
    """Check character, which detects every wrong single character and nearly every swap.

    The weights are odd, so every change of one character alters the sum modulo 32. A swap of two
    neighbours is missed only if they are 16 places apart in the alphabet.
    """
    total = sum((2 * i + 1) * ALPHABET.index(c) for i, c in enumerate(body))
    return ALPHABET[total % len(ALPHABET)]


def is_text(name: str) -> bool:
    """Returns True if spreadsheets and `read_csv` leave a name unchanged.

    They would convert 12E345, 0X12AB and 000123 to numbers, and 5MAR12 to a date. A text that
    begins with a letter is not converted to a number.
    """
    return name[0].isalpha() and not any(month in name for month in _MONTHS)


def new_pseudonym() -> str:
    """Draws a pseudonym that is not readable as a number or date: a letter, four random characters
    and a check character."""
    while True:
        body = "".join(secrets.choice(ALPHABET) for _ in range(LENGTH))
        name = body + _check(body)
        if is_text(name):
            return name


def read_pseudonym(text: str) -> str:
    """Normalises and checks a typed pseudonym.

    Raises:
        StudyError: It is not a valid pseudonym.
    """
    name = text.strip().upper().translate(_SLIPS)
    sound = len(name) == LENGTH + 1 and set(name) <= set(ALPHABET)
    if not sound or _check(name[:-1]) != name[-1]:
        raise StudyError(
            "this is not the id of a participant",
            where="--participant",
            got=text,
            expected="new, or six characters as in the column participant of participants.csv",
            remedy="Check the id for mistyped characters: the last one is a checksum of the first "
            "five",
        )
    return name
