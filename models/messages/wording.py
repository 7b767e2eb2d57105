"""Words that every message shares."""

from __future__ import annotations


def counted(number: int, one: str, several: str | None = None) -> str:
    """A number with its noun: `1 trial`, `12 trials`, `1,204 people`.

    Args:
        number: How many there are.
        one: The noun for one of them.
        several: The noun for any other number; by default `one` with an s.
    """
    return f"{number:,} {one if number == 1 else several or one + 's'}"
