"""Pseudonyms of participants, with a check character that detects writing errors."""

from __future__ import annotations

import secrets

from models.errors import StudyError

ALPHABET = "0123456789ABCDEFGHJKMNPQRSTVWXYZ"
"""Crockford's base 32: no I, L, O, U."""
LENGTH = 5
_SLIPS = str.maketrans("ILO", "110")
_MONTHS = ("JAN", "FEB", "MAR", "APR", "MAY", "SEP", "DEC")
"""Months that the alphabet can spell."""


def _check(body: str) -> str:
    """The sign that makes any one wrong sign visible, and swapped neighbours nearly always.

    Weights are odd, so that no single change goes unseen modulo 32. A swap goes unseen only where
    the neighbours are 16 places apart.
    """
    total = sum((2 * i + 1) * ALPHABET.index(c) for i, c in enumerate(body))
    return ALPHABET[total % len(ALPHABET)]


def is_text(name: str) -> bool:
    """True if spreadsheets and `read_csv` do not convert a name.

    12E345 and 000123 would come back as other numbers, and 5MAR12 as a date.
    """
    letters = "".join(c for c in name if c.isalpha())
    return letters not in ("", "E") and not any(month in name for month in _MONTHS)


def new_pseudonym() -> str:
    """Draws a pseudonym that does not look like a number: five random characters and a check
    character."""
    while True:
        body = "".join(secrets.choice(ALPHABET) for _ in range(LENGTH))
        name = body + _check(body)
        if is_text(name):
            return name


def read_pseudonym(text: str) -> str:
    """Checks a typed pseudonym.

    Raises:
        StudyError: A character is wrong.
    """
    name = text.strip().upper().translate(_SLIPS)
    sound = len(name) == LENGTH + 1 and set(name) <= set(ALPHABET)
    if not sound or _check(name[:-1]) != name[-1]:
        raise StudyError(
            "not a participant's id",
            where="--participant",
            got=text,
            expected="new, or six signs such as participants.csv lists",
            remedy="Look for a slip: the last sign checks the others",
        )
    return name
