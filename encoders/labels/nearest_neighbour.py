"""Exact search for the closest pair of a query and a point, without comparing all pairs.

Labelling needs only the one of 120 queries that has the closest nearest neighbour. The nearest
neighbours of the other 119 do not matter, so one bound, the best distance so far, serves all
queries at once.

Poses vary much in few directions and little in many. So points are first compared by eight numbers:
their first principal components, and the length of the remainder. This reduced distance never
exceeds the true one (remainders differ at least as much as their lengths), and few pairs pass it.
Points are grouped in cells with a centre and a radius; a pair of query and cell whose distance
minus the radius exceeds the bound is skipped. Pairs that pass both tests are compared in full.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.arithmetic.arrays import Array
from models.arithmetic.products import squared_lengths
from models.errors import EncoderError

Single = NDArray[np.float32]
Indices = NDArray[np.intp]

REDUCED = 8
"""Numbers in the reduced comparison; with fewer, more pairs pass; with more, each costs more (16
took about twice as long, at 7,083 and 396,648 poses)."""

_CELLS = 6.0
"""Number of cells per square root of the number of points; neither centres nor opened points
dominate the time."""

_LLOYD_STEPS = 6
"""Rounds of k-means for the cells, which need not be optimal, only small."""

_SAMPLE = 20
"""Points per cell that k-means uses."""

_TRIED = 4
"""Number of queries whose nearest cell gives the first bound."""

_FIRST, _AT_ONCE = 1 << 10, 1 << 16
"""Number of pairs compared before the bound is updated: first value, and maximum."""

_ONES = np.ones(REDUCED, np.float32)

_FAR = 1e-5
"""Share of (|query| + |point|)^2 by which a squared distance from a product in single precision may
be off: several times the worst case of nine terms (9 x 6e-8)."""

NEAR = 2e-6
"""Share of |query| + |point| by which a distance from differences in single precision may be off:
about four times the worst case (3 roundings of coordinates and 4 of the sum, 6e-8 each)."""

LARGEST = 1e15
"""Greatest coordinate: single precision cannot hold squares beyond 1e38."""

TIES = 1e-12
"""Share by which the limit on squared distances is raised, so that equal ones stay in."""


class Closest(NamedTuple):
    """The closest pair of a query and a point."""

    query: int
    """Row of the query; the first of equals."""
    point: int
    """Row of the point; the first of equals."""
    distance: float


class Reduction:
    """Maps points to eight numbers whose distances never exceed those of the points.

    Attributes:
        longest: Greatest length of a reduced point.
    """

    def __init__(self, points: Array) -> None:
        sample = points[:: max(1, len(points) // 20_000)]
        self._mean = sample.mean(axis=0)
        _, axes = np.linalg.eigh(
            (sample - self._mean).T @ (sample - self._mean)
        )  # any order: a bound, wide enough
        # A rotation does not change distances; this one puts the widest directions first.
        self._axes = np.ascontiguousarray(axes[:, ::-1])
        self.longest = 0.0

    def all(self, points: Array) -> Single:
        """Reduced points (T, 8), computed in pieces to avoid a second array of the points' size."""
        reduced = np.empty((len(points), REDUCED), np.float32)
        for start in range(0, len(points), _AT_ONCE):
            piece, lengths = self(points[start : start + _AT_ONCE])
            reduced[start : start + _AT_ONCE] = piece
            self.longest = max(self.longest, float(lengths.max()))
        return reduced

    def __call__(self, points: Array) -> tuple[Single, Array]:
        """Reduced points (T, 8) of points (T, d), and their lengths (T,)."""
        turned = (points - self._mean) @ self._axes  # any order: a bound, wide enough
        kept = min(REDUCED - 1, turned.shape[1])
        reduced = np.zeros((len(points), REDUCED))
        reduced[:, :kept] = turned[:, :kept]
        rest = turned[:, kept:]
        reduced[:, -1] = np.sqrt(np.sum(rest * rest, axis=1))
        return reduced.astype(np.float32), np.sqrt(squared_lengths(reduced))


class NearestNeighbour:
    """Searches the closest pair of queries and stored points, by Euclidean distance.

    Args:
        points: (T, d); kept, not copied.
        cells: Number of cells; by default some 6 sqrt(T).

    Raises:
        EncoderError: No point is given, or one is not finite.
    """

    def __init__(self, points: Array, cells: int | None = None) -> None:
        self._points = checked_points(points)
        self._reduction = Reduction(self._points)
        reduced = self._reduction.all(self._points)
        count = min(cells or int(_CELLS * np.sqrt(len(points))) + 1, len(points))
        member, centres = _cells(reduced, count)
        self._order = np.argsort(member, kind="stable")
        self._reduced = reduced[self._order]
        member = member[self._order]
        self._first = np.searchsorted(member, np.arange(count))
        self._size = np.bincount(member, minlength=count)
        offset = np.sqrt(squared_lengths(self._reduced.astype(float) - centres[member]))
        self._radius = np.zeros(count)
        np.maximum.at(self._radius, member, offset)
        self._radius = self._radius.astype(np.float32)
        squares = np.sum(centres**2, axis=1)
        self._centres = np.vstack([-2.0 * centres.T, np.ones(count), squares]).astype(np.float32)

    def closest(self, queries: Array) -> Closest:
        """Finds the query (of (P, d), P >= 1) with the smallest distance to any point, and that
        point.

        Raises:
            EncoderError: A query is not finite.
        """
        reduced, lengths = self._reduction(checked_queries(queries, self._points))
        length = lengths + self._reduction.longest
        # Squared distances to centres, minus the largest possible rounding error.
        own = np.column_stack([lengths**2 - _FAR * length**2, np.ones(len(queries))])
        to_centre = (
            np.hstack([reduced, own.astype(np.float32)]) @ self._centres
        )  # any order: a bound, wide enough
        nearest = to_centre.argmin(axis=1)
        tried = to_centre[np.arange(len(queries)), nearest].argsort()[:_TRIED]
        query, row = self._pairs(tried, nearest[tried])
        best = float(squared_distances(queries, self._points, query, self._order.take(row)).min())

        reach = (np.float32(np.sqrt(best)) + self._radius) ** 2
        opened = np.flatnonzero((to_centre <= reach).ravel())
        query, cell = np.divmod(opened, len(self._radius))
        least = np.sqrt(np.maximum(to_centre.ravel().take(opened), 0.0)) - self._radius.take(cell)
        order = np.argsort(least)
        query, cell, least = query.take(order), cell.take(order), least.take(order)
        ends = np.cumsum(self._size.take(cell))
        candidates: list[tuple[Indices, Indices, Array]] = []
        start, at_once = 0, _FIRST
        while start < len(query) and least[start] <= np.sqrt(best):
            done = ends[start - 1] if start else 0
            stop = max(start + 1, int(np.searchsorted(ends, done + at_once)))
            at_once = min(2 * at_once, _AT_ONCE)
            pair_query, row = self._pairs(query[start:stop], cell[start:stop])
            near = self._near(reduced, pair_query, row, np.sqrt(best) + NEAR * length)
            pair_query, point = pair_query.take(near), self._order.take(row.take(near))
            squares = squared_distances(queries, self._points, pair_query, point)
            best = min(best, float(squares.min(initial=np.inf)))
            candidates.append((pair_query, point, squares))
            start = stop
        return first_of_closest(
            *(np.concatenate(column) for column in zip(*candidates, strict=True))
        )

    def _pairs(self, query: Indices, cell: Indices) -> tuple[Indices, Indices]:
        """Expands pairs (query, cell) to pairs of the query with every row of the cell."""
        size = self._size.take(cell)
        before = np.cumsum(size) - size
        row = np.arange(size.sum())
        row += np.repeat(self._first.take(cell) - before, size)
        return np.repeat(query, size), row

    def _near(self, reduced: Single, query: Indices, row: Indices, limit: Array) -> Indices:
        """Booleans: the pairs of query and row whose reduced distance is within the query's
        limit."""
        # `take` copies whole rows, ten times as fast as indexing.
        apart = self._reduced.take(row, axis=0)
        apart -= reduced.take(query, axis=0)
        apart *= apart
        limits = (limit**2 * (1.0 + TIES)).astype(np.float32)
        return np.flatnonzero(
            apart @ _ONES <= np.nextafter(limits, np.float32(np.inf)).take(query)
        )  # any order: a bound, wide enough


def checked_points(points: Array) -> Array:
    """Checks points (T, d).

    Raises:
        EncoderError: No point is given, or one is not finite.
    """
    if points.ndim != 2 or not len(points) or not _moderate(points):
        raise EncoderError(
            "nearest neighbours need finite points", got=points.shape, expected="(T, d), T >= 1"
        )
    return points


def checked_queries(queries: Array, points: Array) -> Array:
    """Checks queries (P, d).

    Raises:
        EncoderError: No query is given, they have another width than the points, or one is not
            finite.
    """
    shape = queries.shape
    if len(shape) != 2 or not shape[0] or shape[1] != points.shape[1]:
        raise EncoderError(
            "queries do not fit the points", got=shape, expected=f"(P, {points.shape[1]}), P >= 1"
        )
    if not _moderate(queries):
        raise EncoderError("queries must be finite", expected=f"coordinates within {LARGEST:g}")
    return queries


def _moderate(array: Array) -> bool:
    return bool(array.min(initial=0.0) > -LARGEST and array.max(initial=0.0) < LARGEST)


def first_of_closest(query: Indices, point: Indices, squares: Array) -> Closest:
    """Selects the closest of some pairs; of equal ones the first query and its first point."""
    first = np.lexsort((point, query, squares))[0]
    return Closest(int(query[first]), int(point[first]), float(np.sqrt(squares[first])))


def squared_distances(queries: Array, points: Array, query: Indices, point: Indices) -> Array:
    """Squared distances of pairs."""
    apart = queries.take(query, axis=0) - points.take(point, axis=0)
    return squared_lengths(apart)


def _cells(points: Single, count: int) -> tuple[Indices, Array]:
    """Cell of every point (T,), and the cells' centres (count, d)."""
    # Frames spread evenly over a capture cover its poses well.
    sample = points[np.linspace(0, len(points) - 1, min(len(points), _SAMPLE * count)).astype(int)]
    centres = sample[np.linspace(0, len(sample) - 1, count).astype(int)].astype(float)
    for _ in range(_LLOYD_STEPS):
        member = _nearest_centre(sample, centres)
        number = np.bincount(member, minlength=count)
        filled = number > 0
        for axis, values in enumerate(sample.T):
            sums = np.bincount(member, values, minlength=count)
            centres[filled, axis] = sums[filled] / number[filled]
    return _nearest_centre(points, centres), centres


def _nearest_centre(points: Single, centres: Array) -> Indices:
    """Index (T,) of the nearest centre, up to rounding."""
    across = (-2.0 * centres.T).astype(np.float32)
    squares = np.sum(centres**2, axis=1).astype(np.float32)
    step = max(1, (1 << 22) // len(centres))
    pieces = [
        np.argmin(
            points[start : start + step] @ across + squares, axis=1
        )  # any order: a bound, wide enough
        for start in range(0, len(points), step)
    ]
    return np.concatenate(pieces)
