"""The shortcut to the closest pair finds exactly what looking at every pair finds."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

from encoders.nearest_neighbour import Closest, NearestNeighbour
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


@given(seed=SEEDS, cells=st.integers(1, 80))
def test_the_number_of_cells_changes_nothing(seed: int, cells: int) -> None:
    rng = np.random.default_rng(seed)
    P, Q = rng.normal(size=(80, 6)), rng.normal(size=(20, 6))
    assert NearestNeighbour(P, cells).closest(Q)[:2] == closest_of_all(Q, P)[:2]


def test_of_equal_pairs_the_first_query_and_its_first_point_win() -> None:
    P = np.array([[5.0, 0.0], [1.0, 0.0], [1.0, 0.0]])
    Q = np.array([[9.0, 0.0], [1.0, 3.0], [1.0, -3.0]])
    assert NearestNeighbour(P).closest(Q) == Closest(1, 1, 3.0)


def test_pairs_that_single_precision_cannot_part_are_parted() -> None:
    P = np.array([[0.0, 0.0], [1000.0, 0.0]])
    Q = np.array([[1000.0, 1.0 + 1e-9], [1000.0, 1.0]])
    assert NearestNeighbour(P).closest(Q)[:2] == (1, 1)


@pytest.mark.parametrize("points", [np.empty((0, 3)), np.zeros(3), np.full((2, 3), np.nan)])
def test_points_that_are_none_are_refused(points: np.ndarray) -> None:
    with pytest.raises(EncoderError, match="finite points"):
        NearestNeighbour(points)
