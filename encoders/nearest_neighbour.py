"""The query that lies closest to any of many points, found exactly without looking at all pairs.

Labelling asks a lopsided question: of 120 guesses, which one has the closest nearest neighbour? The
other 119 nearest neighbours are of no interest, so one bound, the best distance so far, serves all
guesses at once. Points are kept in cells with a centre and a radius; a pair of guess and cell whose
distance less the radius exceeds the bound is never opened.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.errors import EncoderError

Array = NDArray[np.float64]

_LLOYD_STEPS = 8
"""Rounds of k-means for the cells. Cells need not be optimal, only small."""

_ROUNDING = 1e-5
"""Share of (|query| + |point|)^2 by which a squared distance in single precision may be off: about
four times the worst case of a 48-term sum (48 x 6e-8)."""


class Closest(NamedTuple):
    """The closest pair."""

    query: int
    """Row among the queries; the first of equals."""
    point: int
    """Row among the points; the first of equals."""
    distance: float


class NearestNeighbour:
    """Points to which queries are compared, by Euclidean distance.

    Args:
        points: (T, d).
        cells: Number of cells; by default about 3 sqrt(T), at which neither centres nor
            opened points dominate (measured at T = 7,083).

    Raises:
        EncoderError: There is no point, or one is not finite.
    """

    def __init__(self, points: Array, cells: int | None = None) -> None:
        if points.ndim != 2 or not len(points) or not np.isfinite(points).all():
            raise EncoderError(
                "nearest neighbours need finite points", got=points.shape, expected="(T, d), T >= 1"
            )
        # Centred, so that single precision is spent on differences rather than on the mean.
        self._mean = points.mean(axis=0)
        points = points - self._mean
        count = min(cells or int(3.0 * np.sqrt(len(points))) + 1, len(points))
        member, centres = _cells(points, count)
        self._order = np.argsort(member, kind="stable")
        self._points = points[self._order]
        self._member = member[self._order]
        self._bounds = np.searchsorted(self._member, np.arange(count + 1))
        offset = np.linalg.norm(self._points - centres[self._member], axis=1)
        self._radius = np.zeros(count)
        np.maximum.at(self._radius, self._member, offset)
        self._longest = float(np.linalg.norm(self._points, axis=1).max())
        self._centre_form = _squared_form(centres)
        self._point_form = _squared_form(self._points)

    def closest(self, queries: Array) -> Closest:
        """The query (of (P, d), P >= 1) with the smallest distance to any point, and that point."""
        queries = queries - self._mean
        squares = np.einsum("pd,pd->p", queries, queries)
        slack = _ROUNDING * (np.sqrt(squares) + self._longest) ** 2
        padded = np.ones((len(queries), queries.shape[1] + 1), np.float32)
        padded[:, :-1] = queries

        to_centre = (padded @ self._centre_form.T) + squares[:, None]
        promising = int(np.argmin(to_centre.min(axis=1)))
        best = (self._point_form @ padded[promising]).min() + squares[promising] + slack[promising]
        reach = np.sqrt(max(best, 0.0)) + self._radius
        opened = to_centre <= reach**2 + slack[:, None]
        chosen = np.flatnonzero(opened.any(axis=1))
        cells = opened.any(axis=0)
        rows = slice(None) if cells.all() else np.flatnonzero(cells[self._member])
        near = padded[chosen] @ self._point_form[rows].T
        least = near.min(axis=1) + squares[chosen]
        return self._exact(queries, chosen, rows, near, least, squares[chosen], slack[chosen])

    def _exact(
        self,
        queries: Array,
        chosen: NDArray[np.intp],
        rows: slice | NDArray[np.intp],
        near: NDArray[np.float32],
        least: Array,
        squares: Array,
        slack: Array,
    ) -> Closest:
        """Decides in double precision among the few pairs that single precision cannot part."""
        bound = float(np.min(least + slack))
        doubtful = np.flatnonzero(least - slack <= bound)
        limit = (bound - squares[doubtful] + slack[doubtful]).astype(np.float32)
        i, j = np.nonzero(near[doubtful] <= np.nextafter(limit, np.float32(np.inf))[:, None])
        i = chosen[doubtful[i]]
        j = j if isinstance(rows, slice) else rows[j]
        distance = np.sum((queries[i] - self._points[j]) ** 2, axis=1)
        first = np.lexsort((self._order[j], i, distance))[0]
        return Closest(int(i[first]), int(self._order[j[first]]), float(np.sqrt(distance[first])))


def _squared_form(points: Array) -> NDArray[np.float32]:
    """(T, d + 1) matrix F with F (q, 1) = |p|^2 - 2 q.p, in single precision."""
    form = np.column_stack([-2.0 * points, np.einsum("td,td->t", points, points)])
    return form.astype(np.float32)


def _cells(points: Array, count: int) -> tuple[NDArray[np.intp], Array]:
    """Cell of every point (T,), and the cells' centres (count, d)."""
    # Frames spread evenly over a capture are spread well over its poses.
    spread = np.linspace(0, len(points) - 1, count).astype(int)
    centres: Array = points[spread].copy()
    for _ in range(_LLOYD_STEPS):
        member = np.argmin((points @ (-2.0 * centres.T)) + np.sum(centres**2, axis=1), axis=1)
        number = np.bincount(member, minlength=count)
        sums = np.zeros_like(centres)
        np.add.at(sums, member, points)
        filled = number > 0
        centres[filled] = sums[filled] / number[filled, None]
    member = np.argmin((points @ (-2.0 * centres.T)) + np.sum(centres**2, axis=1), axis=1)
    return member, centres
