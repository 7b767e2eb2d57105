"""Orders of levels, and their balance over participants.

This module decides which participant gets which order of which factor, how many participants a full
cycle of orders takes, and what an incomplete cycle confounds.

The order of every factor is a row of a table: of a balanced Latin square, of all permutations, or
of the groups of a factor between participants. Each participant gets one row of every factor. The
rows are assigned so that

- over a full cycle every combination of rows occurs exactly once, and
- among the first n participants, for every n, the numbers of uses of any two rows of a factor
  differ by at most one; the same holds for any two combinations of rows of all factors.

With three or more factors, the rows of two factors may be confounded until a cycle is full;
`confounded` names such pairs.

An inner factor has the same order at all places of an outer factor. So both statements also hold
for its orders at each place of the outer factor, in each level of it, and for each pair of place
and level.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from functools import cache
from itertools import combinations, permutations
from math import lcm, prod
from typing import Any

import numpy as np

from sandbox.study.design.design import Design, Factor

MOST_FACTORIAL = 5
"""Largest number of levels with order `factorial`: 5 levels have 120 orders."""

Row = tuple[int, ...]


def balanced_latin_square(n: int) -> tuple[Row, ...]:
    """Rows of a balanced Latin square of n conditions: n rows if n is even, else 2 n.

    Every condition is equally often at every place. Every condition follows every other condition
    equally often: once for even n, twice for odd n (Williams 1949).
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
def table_of(rule: str, n: int) -> tuple[Row, ...]:
    """Table of the orders of n levels by one of `fields.ORDERS`.

    The table of a random order, which is drawn for each participant, has one row.
    """
    if rule == "latin":
        return balanced_latin_square(n)
    if rule == "factorial":
        return tuple(permutations(range(n)))
    if rule == "between":
        return tuple((level,) for level in range(n))
    return (tuple(range(n)),)


def order_of(rule: str, n: int, row: int, seed: tuple[int, ...]) -> Row:
    """Returns the order of n levels for one participant.

    Args:
        rule: One of `fields.ORDERS`.
        n: Number of levels.
        row: Row of the table of orders, taken modulo its length. It depends on the participant,
            the session and, with `repeat_inside`, the round.
        seed: Seed of a random order.
    """
    if rule == "random":
        return tuple(int(i) for i in np.random.default_rng(seed).permutation(n))
    rows = table_of(rule, n)
    return rows[row % len(rows)]


def cycle_of(factor: Factor) -> int:
    """Number of rows in a factor's table of orders; 1 for orders `random` and `blocked`."""
    return lcm(*(len(table_of(factor.order, len(levels))) for levels in factor.lists))


def whole_cycle(design: Design) -> int:
    """Number of participants of a full cycle, in which every combination of orders comes once."""
    return prod(cycle_of(factor) for factor in design.factors)


def rows_of(design: Design, participant: int) -> tuple[int, ...]:
    """Row of every factor for a participant, from 0.

    Args:
        design: The design.
        participant: Place in the order of arrival, from 0: one less than the number.
    """
    rows, combined = [], 1
    for factor in design.factors:
        count = cycle_of(factor)
        number = participant % (combined * count)
        # Each participant gets the next row of every factor. After the common multiple of the
        # numbers of rows, the same combinations would recur. So after each common multiple, this
        # factor skips one row.
        rows.append((number + number // lcm(combined, count)) % count)
        combined *= count
    return tuple(rows)


def cycle_line(design: Design) -> str:
    """A line with the number of participants in a full cycle, and the orders of each factor."""
    parts = [
        f"{cycle_of(f)} {'groups' if f.order == 'between' else 'orders'} of {f.name}"
        for f in design.factors
        if cycle_of(f) > 1
    ]
    if not parts:
        return "no order has a cycle: all are drawn by chance or the same for everybody"
    return f"a full cycle of orders takes {whole_cycle(design)} participants: " + " x ".join(parts)


def nearest_cycles(design: Design, people: int) -> str:
    """The numbers of full cycles just below and above this number of people, such as `24 or 36`."""
    whole = whole_cycle(design)
    less = people // whole * whole
    return f"{less} or {less + whole}" if less else str(whole)


def confounded(design: Design, people: int) -> list[str]:
    """Factors that are confounded at this number of participants, a line each; empty for full
    cycles.

    A combination of factors is named only if no smaller combination in it is confounded.
    """
    rest = people % whole_cycle(design)
    if not rest:
        return []
    fixed = [i for i, factor in enumerate(design.factors) if cycle_of(factor) > 1]
    rows = [row for number in range(rest) for row in _rounds(design, rows_of(design, number))]
    lines: dict[tuple[int, ...], str] = {}
    for size in range(1, len(fixed) + 1):
        for some in combinations(fixed, size):
            if any(set(part) <= set(some) for part in lines):
                continue
            line = _confounded(design, rows, some)
            if line:
                lines[some] = line
    return list(lines.values())


def _rounds(design: Design, first: tuple[int, ...]) -> Iterator[tuple[int, ...]]:
    """Rows of a participant's orders by round; with `repeat_inside`, each round takes the next."""
    if not design.repeat_inside:
        yield first
        return
    inside = [factor.name for factor in design.factors].index(design.repeat_inside) + 1
    for again in range(design.repetitions):
        yield tuple(
            (row + again) % cycle_of(factor) if i >= inside and factor.order != "between" else row
            for i, (factor, row) in enumerate(zip(design.factors, first, strict=True))
        )


def _confounded(design: Design, rows: list[tuple[int, ...]], some: tuple[int, ...]) -> str:
    """What is confounded with these factors in the rows of some people; empty if nothing is."""
    factors = [design.factors[i] for i in some]
    names = " x ".join(factor.name for factor in factors)
    if len(factors) == 1 and factors[0].order == "between":
        sizes = Counter(row[some[0]] for row in rows)
        if _even(sizes, cycle_of(factors[0])):
            return ""
        return f"{names}: its groups differ in size"
    orders = [
        [_places(factor, row[i]) for i, factor in zip(some, factors, strict=True)] for row in rows
    ]
    what = names if len(factors) == 1 else f"the interaction of {names}"
    if not _even(Counter(_joint(orders)), prod(map(_cells, factors))):
        return f"{what} with practice: levels are not at every place equally often"
    used = Counter(tuple(row[i] for i in some) for row in rows)
    if not _even(used, prod(map(cycle_of, factors))):
        return f"{what} with what came before (carry-over): not all orders are used equally often"
    return ""


def _places(factor: Factor, row: int) -> list[tuple[int, int, int]]:
    """The (list, place, level) of each level in one order.

    A nested factor has a list of levels for each outer level; any other factor has one list.
    """
    return [
        (number, place, level)
        for number, levels in enumerate(factor.lists)
        for place, level in enumerate(order_of(factor.order, len(levels), row, ()))
    ]


def _cells(factor: Factor) -> int:
    """Number of different (list, place, level) of a factor."""
    return sum(len(x) if factor.order == "between" else len(x) ** 2 for x in factor.lists)


def _joint(orders: list[list[list[tuple[int, int, int]]]]) -> Iterator[tuple[object, ...]]:
    """Combinations of (list, place, level) of several factors, for every participant."""
    for order in orders:
        joint: list[tuple[object, ...]] = [()]
        for places in order:
            joint = [(*so_far, place) for so_far in joint for place in places]
        yield from joint


def _even(counts: Mapping[Any, int], cells: int) -> bool:
    """True if `cells` different cells were used, and all of them equally often."""
    return len(counts) == cells and len(set(counts.values())) == 1
