"""The shortcut to the closest pair finds exactly what looking at every pair finds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

from encoders.labels.nearest_neighbour import Closest, NearestNeighbour
from models.errors import EncoderError

SEEDS = st.integers(0, 2**32 - 1)


def closest_of_all(queries: np.ndarray, points: np.ndarray) -> Closest:
    """Every pair looked at, in double precision."""
    distance = cdist(queries, points)
    query, point = np.unravel_index(np.argmin(distance), distance.shape)
    return Closest(int(query), int(point), float(distance[query, point]))


@given(
    seed=SEEDS,
    points=st.integers(1, 400),
    queries=st.integers(1, 60),
    width=st.integers(1, 48),
    spread=st.sampled_from([1e-3, 1.0, 1e3]),
    far=st.sampled_from([0.0, 1.0, 1e4]),
)
def test_it_finds_what_looking_at_every_pair_finds(
    seed: int, points: int, queries: int, width: int, spread: float, far: float
) -> None:
    rng = np.random.default_rng(seed)
    # Lumpy on purpose: frames of a capture come in bundles.
    lumps = rng.normal(0, spread, (5, width))
    P = lumps[rng.integers(0, 5, points)] + rng.normal(0, 0.1 * spread, (points, width)) + far
    Q = lumps[rng.integers(0, 5, queries)] + rng.normal(0, spread, (queries, width)) + far
    found, expected = NearestNeighbour(P).closest(Q), closest_of_all(Q, P)
    assert (found.query, found.point) == (expected.query, expected.point)
    assert found.distance == pytest.approx(expected.distance, rel=1e-9, abs=1e-9 * spread)


@given(seed=SEEDS, part=st.integers(1, 80))
def test_how_the_points_are_parted_changes_nothing(seed: int, part: int) -> None:
    rng = np.random.default_rng(seed)
    P, Q = rng.normal(size=(80, 6)), rng.normal(size=(20, 6))
    assert NearestNeighbour(P, part).closest(Q)[:2] == closest_of_all(Q, P)[:2]


@given(seed=SEEDS, width=st.integers(1, 12), points=st.integers(1, 300), span=st.integers(1, 4))
def test_of_equal_pairs_the_first_query_and_its_first_point_win(
    seed: int, width: int, points: int, span: int
) -> None:
    """On a grid of few places most pairs have equals, exactly."""
    rng = np.random.default_rng(seed)
    P = rng.integers(0, span + 1, (points, width)).astype(float)
    Q = rng.integers(-span, span + 1, (30, width)).astype(float) + 0.5
    assert NearestNeighbour(P).closest(Q) == closest_of_all(Q, P)


def test_equal_points_beyond_all_room_are_no_obstacle() -> None:
    P = np.tile([[1.0, 2.0, 3.0]], (5000, 1))
    P[:7] += 1.0
    assert NearestNeighbour(P).closest(np.array([[9.0, 9.0, 9.0], [1.0, 2.0, 2.0]])) == Closest(
        1, 7, 1.0
    )


def test_pairs_that_single_precision_cannot_part_are_parted() -> None:
    P = np.array([[0.0, 0.0], [1000.0, 0.0]])
    Q = np.array([[1000.0, 1.0 + 1e-9], [1000.0, 1.0]])
    assert NearestNeighbour(P).closest(Q)[:2] == (1, 1)


@pytest.mark.parametrize(
    "points", [np.empty((0, 3)), np.zeros(3), np.full((2, 3), np.nan), np.full((2, 3), -1e16)]
)
def test_points_that_are_none_are_refused(points: np.ndarray) -> None:
    with pytest.raises(EncoderError, match="finite points"):
        NearestNeighbour(points)


@pytest.mark.parametrize(
    "queries", [np.empty((0, 3)), np.zeros(3), np.zeros((2, 4)), np.full((2, 3), np.inf)]
)
def test_queries_that_are_none_are_refused(queries: np.ndarray) -> None:
    with pytest.raises(EncoderError, match="queries"):
        NearestNeighbour(np.eye(3)).closest(queries)
