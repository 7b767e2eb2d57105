"""Orders of levels for participants: balanced Latin squares, all permutations, random orders."""

from __future__ import annotations

from functools import cache
from itertools import permutations

import numpy as np

MOST_FACTORIAL = 5
"""Largest number of levels with order `factorial`: 5 levels have 120 orders."""

Row = tuple[int, ...]


@cache
def balanced_latin_square(n: int) -> tuple[Row, ...]:
    """Rows of a balanced Latin square of n conditions: n rows if n is even, else 2 n.

    Every condition is equally often at every place. Every condition follows every other one equally
    often: once for even n, twice for odd n (Williams 1949).
    """
    first = [0]
    low, high = 1, n - 1
    while len(first) < n:
        first.append(low)
        low += 1
        if len(first) < n:
            first.append(high)
            high -= 1
    rows = [tuple((c + r) % n for c in first) for r in range(n)]
    if n % 2 and n > 1:
        rows += [tuple(reversed(row)) for row in rows]
    return tuple(rows)


@cache
def every_order(n: int) -> tuple[Row, ...]:
    """Returns all n! orders."""
    return tuple(permutations(range(n)))


def order_of(rule: str, n: int, row: int, seed: tuple[int, ...]) -> Row:
    """Returns the order of n levels for one participant.

    Args:
        rule: One of `design.ORDERS`.
        n: Number of levels.
        row: Row of the square, taken modulo its size; counts participants and places in outer
            factors.
        seed: Seed of a random order.
    """
    if rule == "latin":
        rows = balanced_latin_square(n)
        return rows[row % len(rows)]
    if rule == "factorial":
        rows = every_order(n)
        return rows[row % len(rows)]
    if rule == "random":
        return tuple(int(i) for i in np.random.default_rng(seed).permutation(n))
    if rule == "between":
        return (row % n,)
    return tuple(range(n))


def cycle(rule: str, n: int) -> int:
    """Number of participants after which an order rule has used every row once."""
    if rule == "latin":
        return len(balanced_latin_square(n))
    if rule == "factorial":
        return len(every_order(n))
    return n if rule == "between" else 1
