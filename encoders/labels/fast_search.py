"""Compiled nearest-neighbour search (extra `fast`: numba); equals
`encoders.labels.nearest_neighbour`.

Reduced points lie in a binary tree of boxes: every box is cut in two equal halves across its
longest side, until some sixteen points are left. Compiled code can afford to descend such a tree
query by query, lowering the bound with every point, which NumPy cannot. Everything is compiled when
the module is imported, and cached on disk.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from encoders.labels.nearest_neighbour import (
    NEAR,
    REDUCED,
    TIES,
    Closest,
    Reduction,
    checked_points,
    checked_queries,
    first_of_closest,
    squared_distances,
)
from encoders.numba_extra import ANY_ORDER, njit
from models.arithmetic.arrays import Array

Single = NDArray[np.float32]
Indices = NDArray[np.int64]

_LEAF = 16
"""Points in the smallest boxes; 8 and 32 were not faster (measured at 7,083 and 396,648 poses)."""

_KEPT = 1024
"""Maximum number of pairs that are candidates for the closest."""


@njit(
    "float32(float32[:, ::1], float32[:, ::1], int64, float32[::1])",
    fastmath=ANY_ORDER,
    cache=True,
    inline="always",
)
def _to_box(lower, upper, box, query):  # type: ignore[no-untyped-def]
    """Squared distance from a query to a box."""
    squares = np.float32(0)
    for d in range(REDUCED):
        apart = max(lower[box, d] - query[d], query[d] - upper[box, d])
        apart = max(apart, np.float32(0))
        squares += apart * apart
    return squares


@njit(
    "float32(float32[:, ::1], int64, float32[::1])", fastmath=ANY_ORDER, cache=True, inline="always"
)
def _to_point(reduced, row, query):  # type: ignore[no-untyped-def]
    squares = np.float32(0)
    for d in range(REDUCED):
        apart = reduced[row, d] - query[d]
        squares += apart * apart
    return squares


@njit("float64(float64[:, ::1], int64, float64[::1])", fastmath=ANY_ORDER, cache=True)
def _in_full(points, point, query):  # type: ignore[no-untyped-def]
    squares = 0.0
    for d in range(points.shape[1]):
        apart = points[point, d] - query[d]
        squares += apart * apart
    return squares


@njit("float32(float64, float64)", cache=True)
def _limit(best, slack):  # type: ignore[no-untyped-def]
    """Largest squared reduced distance of a pair that may be the closest."""
    reach = np.sqrt(best) + slack
    # Single precision may round it down by half of 1.2e-7.
    return np.float32(reach * reach * (1.0 + 1e-6))


@njit(
    "int64(float64[:, ::1], int64[::1], float32[:, ::1], float32[:, ::1], float32[:, ::1],"
    "int64, float64[:, ::1], float32[:, ::1], float64[::1], int64[::1], int64[::1],"
    "float64[::1])",
    cache=True,
)
def _search(  # type: ignore[no-untyped-def]
    points, order, reduced, lower, upper, depth, queries, short, slack, query_of, point_of, squares
):
    """Lists the candidates for the closest pair; returns their number, or -1 if the buffers are too
    small."""
    n, leaves, count = len(order), 1 << depth, 0
    best = np.inf
    promise = np.empty(len(queries))
    for k in range(len(queries)):
        box = 1
        while box < leaves:
            left = _to_box(lower, upper, 2 * box, short[k])
            right = _to_box(lower, upper, 2 * box + 1, short[k])
            box = 2 * box if left <= right else 2 * box + 1
        first, stop = n * (box - leaves) >> depth, n * (box - leaves + 1) >> depth
        nearest, least = first, np.float32(np.inf)
        for row in range(first, stop):
            square = _to_point(reduced, row, short[k])
            if square < least:
                nearest, least = row, square
        promise[k] = _in_full(points, order[nearest], queries[k])
        best = min(best, promise[k])

    waiting, distance = np.empty(depth + 1, np.int64), np.empty(depth + 1, np.float32)
    for k in np.argsort(promise):
        limit = _limit(best, slack[k])
        waiting[0], distance[0], left_over = 1, np.float32(0), 1
        while left_over > 0:
            left_over -= 1
            box, near = waiting[left_over], distance[left_over]
            while near <= limit and box < leaves:
                near = _to_box(lower, upper, 2 * box, short[k])
                far = _to_box(lower, upper, 2 * box + 1, short[k])
                box = 2 * box
                other = box + 1
                if far < near:
                    near, far, box, other = far, near, other, box
                if far <= limit:
                    waiting[left_over], distance[left_over] = other, far
                    left_over += 1
            if near > limit:
                continue
            for row in range(n * (box - leaves) >> depth, n * (box - leaves + 1) >> depth):
                if _to_point(reduced, row, short[k]) > limit:
                    continue
                square = _in_full(points, order[row], queries[k])
                if square > best * (1.0 + TIES):
                    continue
                if square < best:
                    best = square
                    limit = _limit(best, slack[k])
                if count == len(squares):
                    count = 0
                    for i in range(len(squares)):
                        if squares[i] <= best * (1.0 + TIES):
                            query_of[count], point_of[count] = query_of[i], point_of[i]
                            squares[count] = squares[i]
                            count += 1
                    if count == len(squares):
                        return -1
                query_of[count], point_of[count], squares[count] = k, order[row], square
                count += 1
    return count


class FastNearestNeighbour:
    """Compiled `NearestNeighbour` with equal results, ties included.

    Buffers are reused, so an object serves one thread at a time.

    Args:
        points: (T, d); kept, not copied if they are C-ordered doubles.
        leaf: Points in the smallest boxes.

    Raises:
        EncoderError: No point is given, or one is not finite.
    """

    def __init__(self, points: Array, leaf: int = _LEAF) -> None:
        self._points = np.ascontiguousarray(checked_points(points), float)
        self._reduction = Reduction(self._points)
        reduced = self._reduction.all(self._points)
        self._depth = max(0, int(np.ceil(np.log2(len(points) / leaf))))
        self._order, self._lower, self._upper = _boxes(reduced, self._depth)
        self._reduced = reduced[self._order]
        self._room(_KEPT)

    def closest(self, queries: Array) -> Closest:
        """See `NearestNeighbour.closest`."""
        queries = np.ascontiguousarray(checked_queries(queries, self._points), float)
        short, lengths = self._reduction(queries)
        slack = NEAR * (lengths + self._reduction.longest)
        while True:
            count = _search(
                self._points,
                self._order,
                self._reduced,
                self._lower,
                self._upper,
                self._depth,
                queries,
                short,
                slack,
                self._query_of,
                self._point_of,
                self._squares,
            )
            if count >= 0:
                break
            # So many points are equal that they exceed the buffers.
            self._room(4 * len(self._squares))
        query, point = self._query_of[:count], self._point_of[:count]
        # Computed again in the order of sums of the version without numba, so that ties are equal.
        return first_of_closest(
            query, point, squared_distances(queries, self._points, query, point)
        )

    def _room(self, pairs: int) -> None:
        self._query_of, self._point_of = np.empty(pairs, np.int64), np.empty(pairs, np.int64)
        self._squares = np.empty(pairs)


def _boxes(points: Single, depth: int) -> tuple[Indices, Single, Single]:
    """Order of the points in the tree, and lower and upper corners (2 << depth, 8) of its boxes.

    Box 1 contains all points; the halves of box b are boxes 2 b and 2 b + 1. Leaf i holds points
    i n / 2^depth to (i + 1) n / 2^depth of the order, rounded down.
    """
    n = len(points)
    order = np.arange(n)
    lower = np.zeros((2 << depth, points.shape[1]), np.float32)
    upper = np.zeros_like(lower)
    for level in range(depth + 1):
        edges = n * np.arange((1 << level) + 1) >> level
        ordered = points[order]
        least = np.minimum.reduceat(ordered, edges[:-1])
        greatest = np.maximum.reduceat(ordered, edges[:-1])
        lower[1 << level : 2 << level], upper[1 << level : 2 << level] = least, greatest
        if level < depth:
            box = np.repeat(np.arange(1 << level), np.diff(edges))
            longest = np.argmax(greatest - least, axis=1)[box]
            order = order[np.lexsort((ordered[np.arange(n), longest], box))]
    return order, lower, upper
