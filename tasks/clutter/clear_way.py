"""Ways of a box with the fingers at it between other things: shortest, and clear of them.

A search on a grid, as a person looks for a way with the eyes before they move.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from heapq import heappop, heappush
from math import sqrt

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length, squared_lengths
from models.surface import Surface
from tasks.simulated_user.screen import EDGE
from tasks.user import SeenObject

GRID = 0.004
"""m between two places of the search."""
EASY = 0.010
"""m from other things, from which on a way is easy."""
_HARD = 0.002
"""m less than that, at which a way counts twice as long."""
_BESIDE = 0.045
"""m beyond start and end, to which a way may lead."""
_LOSES = 0.001
"""m of clearance that a straight leg may lose against the way it replaces."""
_NEAR_TABLE = 0.020
"""m above the table, where distances are measured: at half the height of the things."""


@dataclass(frozen=True)
class Footprint:
    """What moves, as seen from above.

    Attributes:
        points: (n, 2) m relative to the middle of the box.
        radii: (n,) m, of discs around them.
        tips: (k, 2) m, the fingers, which must stay on the screen.
    """

    points: Array
    radii: Array
    tips: Array


def clear_leg(
    start: Array,
    end: Array,
    footprint: Footprint,
    things: Sequence[SeenObject],
    surface: Surface,
) -> Array:
    """First straight leg (2,) m of a way from start to end, as long as it stays clear.

    Args:
        start: (2,) m, where the box is.
        end: (2,) m, where it has to go.
        footprint: The box and the fingers at it.
        things: Other things.
        surface: The screen, which fingers do not leave.
    """
    way = _way(start, end, footprint, things, surface)
    room = [_room(place[None], footprint, things)[0] for place in way]
    for last in range(len(way) - 1, 0, -1):
        least = min(*room[1 : last + 1], EASY) - _LOSES
        many = max(int(length(way[last] - start) / GRID) * 2, 2)
        line = start + np.linspace(0.0, 1.0, many)[1:, None] * (way[last] - start)
        if last == 1 or float(_room(line, footprint, things).min()) >= least:
            return np.asarray(way[last] - start)
    return end - start


def lacking_room(
    start: Array,
    end: Array,
    footprint: Footprint,
    turned: Footprint,
    things: Sequence[SeenObject],
    surface: Surface,
) -> float:
    """Room in m that the narrowest place of the best way, or its end, lacks to be easy.

    Args:
        start, end, footprint, things, surface: See `clear_leg`.
        turned: What moves, as it is turned at the end.
    """
    way = _way(start, end, footprint, things, surface)
    room = min(
        float(_room(np.array(way[1:]), footprint, things).min()),
        float(_room(end[None], turned, things)[0]),
    )
    return max(EASY - room, 0.0)


def _way(
    start: Array,
    end: Array,
    footprint: Footprint,
    things: Sequence[SeenObject],
    surface: Surface,
) -> list[Array]:
    """Places (2,) m from start to end on a grid, both included."""
    low = np.minimum(start, end) - _BESIDE
    counts = [int(n) for n in (np.abs(end - start) + 2 * _BESIDE) / GRID]
    columns, rows = counts[0] + 1, counts[1] + 1
    x, y = (a.ravel() for a in np.meshgrid(np.arange(columns), np.arange(rows)))
    places = low + GRID * np.column_stack([x, y])
    short = np.maximum(EASY - _room(places, footprint, things), 0.0) / _HARD
    price = (
        1.0 + short * short + 1e3 * (short > EASY / _HARD) + 1e3 * _off(places, footprint, surface)
    )
    first, goal = (int(np.argmin(squared_lengths(places - place))) for place in (start, end))
    costs = np.full(len(places), np.inf)
    before = np.full(len(places), -1)
    costs[first] = 0.0
    prices = price.tolist()
    edge = [(0.0, first)]
    while edge:
        cost, at = heappop(edge)
        if at == goal:
            break
        if cost > costs[at]:
            continue
        row, column = divmod(at, columns)
        for down, right, step in _NEIGHBOURS:
            if not (0 <= row + down < rows and 0 <= column + right < columns):
                continue
            to = at + down * columns + right
            new = cost + step * 0.5 * (prices[at] + prices[to])
            if new < costs[to]:
                costs[to], before[to] = new, at
                heappush(edge, (new, to))
    way = [end]
    at = int(before[goal])
    while at >= 0 and at != first:
        way.append(places[at])
        at = int(before[at])
    return [start, *reversed(way)]


_NEIGHBOURS = [(a, b, sqrt(a * a + b * b)) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b]
"""Rows and columns to the next places of the grid, and the distance."""


def _room(places: Array, footprint: Footprint, things: Sequence[SeenObject]) -> Array:
    """Distance (n,) m between what moves, its middle at places (n, 2) m, and the nearest thing."""
    if not things:
        return np.full(len(places), np.inf)
    at = (places[:, None] + footprint.points).reshape(-1, 2)
    points = np.column_stack([at, np.full(len(at), _NEAR_TABLE)])
    clear = np.min([o.shape.clearance(points, o.position, o.rotation) for o in things], axis=0)
    return np.asarray((clear.reshape(len(places), -1) - footprint.radii).min(axis=1))


def _off(places: Array, footprint: Footprint, surface: Surface) -> Array:
    """(n,) m by which fingers of a hand at places (n, 2) m would be beyond the screen's border."""
    at = (places[:, None] + footprint.tips).reshape(-1, 2)
    on = surface.to_surface(np.column_stack([at, np.zeros(len(at))]))
    over = np.maximum(EDGE - np.minimum(on, surface.size - on), 0.0).max(axis=1)
    return np.asarray(over.reshape(len(places), -1).max(axis=1))
