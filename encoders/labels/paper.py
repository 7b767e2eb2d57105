"""The paper's labelling rule, with the exact search that it needs.

`PaperLabels` follows section 2 of Chung, Kim, Han and Pollard (2015). It reconstructs the hand for
every labelling, and takes the labelling whose reconstruction is closest to a pose of the training
data.

`NearestNeighbour` finds the closest pair of a query and a point without comparing all pairs.
Labelling needs only the one query of 120 that has the closest nearest neighbour. One bound, the
best distance so far, therefore serves all queries at once.

Poses vary much in few directions and little in many. Points are therefore compared first by eight
numbers: their first principal components, and the length of the remainder. This reduced distance
never exceeds the true distance, because remainders differ at least as much as their lengths. Few
pairs have a reduced distance within the bound. Points are also grouped in cells with a centre and a
radius, and a pair of query and cell is skipped if its distance minus the radius exceeds the bound.
Pairs that pass both tests are compared in full.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from encoders.input_vector import CONTACT_VECTOR_SIZE, LIFTED, leftmost
from encoders.labels.labelling import Labelling, Labels, allowed, arranged, hypotheses
from encoders.regression.trained import TrainedModel
from models.arithmetic import Array, matrix_product, squared_lengths
from models.errors import EncoderError
from models.frames import FINGERS
from models.pose import JOINTS
from models.surface import METRES_PER_INCH

INDEX = 1
"""The index finger's label."""

METRICS = ("joints", "pose", "mahalanobis", "touches")
"""Metrics of `PaperLabels` for the distance between a reconstruction and a training frame."""

_FLAG_SCALE = 20.0
"""Weight (inches) of a contact flag in the metric `touches`. It exceeds the length of a hand, so
that layouts of the same fingers are always closer than layouts of other fingers."""

_Single = NDArray[np.float32]
_Indices = NDArray[np.intp]

_REDUCED = 8
"""Count of numbers in the reduced comparison. With fewer numbers, more pairs pass. With more
numbers, each comparison costs more (16 took about twice as long, at 7,083 and 396,648 poses)."""

_CELLS = 6.0
"""Number of cells, divided by the square root of the number of points. With this number, neither
the comparison of centres nor that of points in cells dominates the time."""

_LLOYD_STEPS = 6
"""Number of k-means rounds for the cells. Cells should be small, but need not be optimal."""

_SAMPLE = 20
"""Number of points per cell that k-means uses."""

_TRIED = 4
"""Number of queries whose nearest cell gives the first bound."""

_FIRST, _AT_ONCE = 1 << 10, 1 << 16
"""Number of pairs compared before the bound is updated: initial value and maximum."""

_ONES = np.ones(_REDUCED, np.float32)

_FAR = 1e-5
"""Share of (|query| + |point|)^2 by which a squared distance from a product in single precision may
be off: several times the worst case of nine terms (9 x 6e-8)."""

_NEAR = 2e-6
"""Share of |query| + |point| by which a distance from differences in single precision may be off:
about four times the worst case (3 roundings of coordinates and 4 of the sum, 6e-8 each)."""

_LARGEST = 1e15
"""Greatest coordinate: single precision cannot hold squares beyond 1e38."""

_TIES = 1e-12
"""Share by which the limit on squared distances is raised, so that rounding excludes no pair at the
limit."""


class PaperLabels:
    """The paper's rule: the labelling whose reconstruction has the closest training pose.

    The search is exact and has no history. The reported probability is always 1. The paper has no
    rule for a single contact, which has no layout and does not occur in the paper's data. This
    class labels it as the index finger.

    Args:
        model: Trained encoder and its training frames.
        metric: Distance between poses, which the paper does not specify. `joints`: Euclidean
            distance of the 42 ball joint components in degrees. `pose`: Euclidean distance of all
            48 components in centimetres and degrees. `mahalanobis`: distance of all 48 components
            by the covariance of the training poses. `touches`: distance of contact vectors in
            inches from training frames of the same fingers, the paper's rule for inverse kinematics
            (its section 3).

    Raises:
        EncoderError: The metric is unknown.
    """

    remembers = False

    def __init__(self, model: TrainedModel, metric: str = "joints") -> None:
        if metric not in METRICS:
            raise EncoderError("no such metric", got=metric, expected=", ".join(METRICS))
        self.metric = metric
        self._poses = model.encoder.for_contacts()
        if metric == "touches":
            self._map = np.diag(np.repeat([1.0, _FLAG_SCALE], [2 * len(FINGERS), len(FINGERS)]))
            frames = np.asarray(model.training_u, float)
        else:
            frames = np.asarray(model.training_pose, float)
            self._map = _pose_map(metric, frames)
        self._search = NearestNeighbour(matrix_product(frames, self._map))

    def assign(
        self, contacts: Mapping[int, tuple[float, float]], fixed: Mapping[int, int]
    ) -> Labelling:
        """See `Labeller.assign`."""
        ids, xy = arranged(contacts, fixed)
        if len(ids) == 1:
            return Labelling({ids[0]: fixed.get(ids[0], INDEX)}, 1.0)
        labels = hypotheses(len(ids))
        if fixed:
            labels = labels[allowed(ids, fixed)]
        chosen = labels[self._closest(xy, labels)]
        return Labelling(dict(zip(ids, chosen.tolist(), strict=True)), 1.0)

    def reset(self) -> None:
        """Does nothing: the rule has no history."""

    def restart(self) -> None:
        """Does nothing: the rule has no history."""

    def _closest(self, xy: Array, labels: Labels) -> int:
        U = labelled_contact_vectors(xy, labels)
        guesses = U if self.metric == "touches" else self._poses.predict(U)
        return self._search.closest(matrix_product(guesses, self._map)).query


def _pose_map(metric: str, frames: Array) -> Array:
    """Matrix (48, d) that maps poses so that the metric becomes the Euclidean distance."""
    width = frames.shape[1]
    if metric == "mahalanobis":
        covariance = np.cov(frames, rowvar=False)
        # A tiny share of the mean variance limits the weight of components that never vary.
        covariance[np.diag_indices(width)] += 1e-9 * np.trace(covariance) / width
        lower: Array = np.linalg.cholesky(
            np.linalg.inv(covariance)
        )  # any order: an option of evaluations
        return lower
    scale = np.full(width, np.rad2deg(1.0))
    scale[:3] = 100.0
    identity = np.diag(scale)
    return identity[:, JOINTS] if metric == "joints" else identity


def labelled_contact_vectors(xy: Array, labels: Labels) -> Array:
    """Contact vectors (P, 15) of the same contacts under many labellings.

    Args:
        xy: (k, 2) m on the surface.
        labels: (P, k) finger of every contact in every labelling.
    """
    relative = (xy - xy[leftmost(xy)]) / METRES_PER_INCH
    U = np.full((len(labels), CONTACT_VECTOR_SIZE), LIFTED)
    U[:, 2 * len(FINGERS) :] = 0.0
    rows = np.arange(len(labels))[:, None]
    U[rows, 2 * labels] = relative[:, 0]
    U[rows, 2 * labels + 1] = relative[:, 1]
    U[rows, 2 * len(FINGERS) + labels] = 1.0
    return U


class Closest(NamedTuple):
    """The closest pair of a query and a point."""

    query: int
    """Row of the query; the first row among equally close pairs."""
    point: int
    """Row of the point; the first row among equally close pairs."""
    distance: float


class _Reduction:
    """Maps points to eight numbers whose distances never exceed the distances of the points.

    Attributes:
        longest: Greatest length of a reduced point.
    """

    def __init__(self, points: Array) -> None:
        sample = points[:: max(1, len(points) // 20_000)]
        self._mean = sample.mean(axis=0)
        _, axes = np.linalg.eigh(
            (sample - self._mean).T @ (sample - self._mean)
        )  # any order: a bound, wide enough
        # These axes are a rotation, which does not change distances. The widest come first.
        self._axes = np.ascontiguousarray(axes[:, ::-1])
        self.longest = 0.0

    def all(self, points: Array) -> _Single:
        """Reduced points (T, 8), computed in pieces to avoid a second array of the points' size."""
        reduced = np.empty((len(points), _REDUCED), np.float32)
        for start in range(0, len(points), _AT_ONCE):
            piece, lengths = self(points[start : start + _AT_ONCE])
            reduced[start : start + _AT_ONCE] = piece
            self.longest = max(self.longest, float(lengths.max()))
        return reduced

    def __call__(self, points: Array) -> tuple[_Single, Array]:
        """Reduced points (T, 8) of points (T, d), and their lengths (T,)."""
        turned = (points - self._mean) @ self._axes  # any order: a bound, wide enough
        kept = min(_REDUCED - 1, turned.shape[1])
        reduced = np.zeros((len(points), _REDUCED))
        reduced[:, :kept] = turned[:, :kept]
        rest = turned[:, kept:]
        reduced[:, -1] = np.sqrt(np.sum(rest * rest, axis=1))
        return reduced.astype(np.float32), np.sqrt(squared_lengths(reduced))


class NearestNeighbour:
    """Searches the closest pair of queries and stored points, by Euclidean distance.

    Args:
        points: (T, d) points; the array is stored without a copy.
        cells: Number of cells; None takes about 6 sqrt(T).

    Raises:
        EncoderError: No point is given, or a point is not finite.
    """

    def __init__(self, points: Array, cells: int | None = None) -> None:
        self._points = _checked_points(points)
        self._reduction = _Reduction(self._points)
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
        """Finds the query with the smallest distance to any point, and this point.

        Args:
            queries: (P, d), P at least 1.

        Raises:
            EncoderError: A query is not finite.
        """
        reduced, lengths = self._reduction(_checked_queries(queries, self._points))
        length = lengths + self._reduction.longest
        # Squared distances to centres, minus the largest possible rounding error.
        own = np.column_stack([lengths**2 - _FAR * length**2, np.ones(len(queries))])
        to_centre = (
            np.hstack([reduced, own.astype(np.float32)]) @ self._centres
        )  # any order: a bound, wide enough
        nearest = to_centre.argmin(axis=1)
        tried = to_centre[np.arange(len(queries)), nearest].argsort()[:_TRIED]
        query, row = self._pairs(tried, nearest[tried])
        best = float(_squared_distances(queries, self._points, query, self._order.take(row)).min())

        reach = (np.float32(np.sqrt(best)) + self._radius) ** 2
        opened = np.flatnonzero((to_centre <= reach).ravel())
        query, cell = np.divmod(opened, len(self._radius))
        least = np.sqrt(np.maximum(to_centre.ravel().take(opened), 0.0)) - self._radius.take(cell)
        order = np.argsort(least)
        query, cell, least = query.take(order), cell.take(order), least.take(order)
        ends = np.cumsum(self._size.take(cell))
        candidates: list[tuple[_Indices, _Indices, Array]] = []
        start, at_once = 0, _FIRST
        while start < len(query) and least[start] <= np.sqrt(best):
            done = ends[start - 1] if start else 0
            stop = max(start + 1, int(np.searchsorted(ends, done + at_once)))
            at_once = min(2 * at_once, _AT_ONCE)
            pair_query, row = self._pairs(query[start:stop], cell[start:stop])
            near = self._near(reduced, pair_query, row, np.sqrt(best) + _NEAR * length)
            pair_query, point = pair_query.take(near), self._order.take(row.take(near))
            squares = _squared_distances(queries, self._points, pair_query, point)
            best = min(best, float(squares.min(initial=np.inf)))
            candidates.append((pair_query, point, squares))
            start = stop
        return _first_of_closest(
            *(np.concatenate(column) for column in zip(*candidates, strict=True))
        )

    def _pairs(self, query: _Indices, cell: _Indices) -> tuple[_Indices, _Indices]:
        """Expands pairs (query, cell) to pairs of the query with every row of the cell."""
        size = self._size.take(cell)
        before = np.cumsum(size) - size
        row = np.arange(size.sum())
        row += np.repeat(self._first.take(cell) - before, size)
        return np.repeat(query, size), row

    def _near(self, reduced: _Single, query: _Indices, row: _Indices, limit: Array) -> _Indices:
        """Indices of the pairs of query and row whose reduced distance is within the query's
        limit."""
        # `take` copies whole rows, ten times as fast as indexing.
        apart = self._reduced.take(row, axis=0)
        apart -= reduced.take(query, axis=0)
        apart *= apart
        limits = (limit**2 * (1.0 + _TIES)).astype(np.float32)
        return np.flatnonzero(
            apart @ _ONES <= np.nextafter(limits, np.float32(np.inf)).take(query)
        )  # any order: a bound, wide enough


def _checked_points(points: Array) -> Array:
    """Checks points (T, d).

    Raises:
        EncoderError: No point is given, or a point is not finite.
    """
    if points.ndim != 2 or not len(points) or not _moderate(points):
        raise EncoderError(
            "nearest neighbours need finite points", got=points.shape, expected="(T, d), T >= 1"
        )
    return points


def _checked_queries(queries: Array, points: Array) -> Array:
    """Checks queries (P, d).

    Raises:
        EncoderError: No query is given, the width of the queries differs from that of the points,
            or a query is not finite.
    """
    shape = queries.shape
    if len(shape) != 2 or not shape[0] or shape[1] != points.shape[1]:
        raise EncoderError(
            "queries do not fit the points", got=shape, expected=f"(P, {points.shape[1]}), P >= 1"
        )
    if not _moderate(queries):
        raise EncoderError("queries must be finite", expected=f"coordinates within {_LARGEST:g}")
    return queries


def _moderate(array: Array) -> bool:
    return bool(array.min(initial=0.0) > -_LARGEST and array.max(initial=0.0) < _LARGEST)


def _first_of_closest(query: _Indices, point: _Indices, squares: Array) -> Closest:
    """Selects the closest pair; among equal pairs, the first query and its first point."""
    first = np.lexsort((point, query, squares))[0]
    return Closest(int(query[first]), int(point[first]), float(np.sqrt(squares[first])))


def _squared_distances(queries: Array, points: Array, query: _Indices, point: _Indices) -> Array:
    """Squared distances of pairs."""
    apart = queries.take(query, axis=0) - points.take(point, axis=0)
    return squared_lengths(apart)


def _cells(points: _Single, count: int) -> tuple[_Indices, Array]:
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


def _nearest_centre(points: _Single, centres: Array) -> _Indices:
    """Index (T,) of the nearest centre of each point, up to rounding."""
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
