"""k-anonymity (Sweeney 2002): number of people with the same demographic values.

A person with a unique combination of age, handedness and other values can be recognised despite the
pseudonym.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import floor
from typing import Any

SMALLEST = 5
"""Number of people who should share each combination of values. This is a usual choice, and no
guarantee."""
DIGITS = 9
"""Decimals of rounded numbers."""
NARROWEST, WIDEST = 1e-6, 1e6
"""Smallest and largest width of a bin."""


@dataclass(frozen=True)
class Groups:
    """Groups of people with equal values.

    Attributes:
        columns: The compared columns.
        smallest: k, the size of the smallest group; 0 without people.
        few: Combinations that fewer than `SMALLEST` people share, with the number of people.
    """

    columns: tuple[str, ...]
    smallest: int
    few: tuple[tuple[tuple[Any, ...], int], ...]

    @property
    def exposed(self) -> int:
        """Number of people in groups that are too small."""
        return sum(count for _, count in self.few)


def groups(people: Sequence[Mapping[str, Any]], columns: Sequence[str]) -> Groups:
    """Groups people who have equal values in all given columns. Without columns, all people are one
    group."""
    counted = Counter(tuple(person.get(name) for name in columns) for person in people)
    few = tuple((what, n) for what, n in counted.items() if n < SMALLEST)
    return Groups(tuple(columns), min(counted.values(), default=0), few)


def binned(value: Any, width: float) -> Any:
    """A number rounded down to a multiple of a width; other values are returned unchanged."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return value
    # Rounded before and after, since 0.7 / 0.1 is a little less than 7.
    low = round(floor(round(value / width, DIGITS)) * width, DIGITS)
    return int(low) if low == int(low) else low
