"""The paper's labels do not depend on where the hand is or how a device counts its contacts.

The shortcut to the closest pair finds exactly what looking at every pair finds.
"""

from __future__ import annotations

from functools import cache
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.distance import cdist

from encoders.input_vector import contact_vector
from encoders.labels.labelling import Labeller, hypotheses
from encoders.labels.paper import (
    INDEX,
    METRICS,
    Closest,
    NearestNeighbour,
    PaperLabels,
    labelled_contact_vectors,
)
from encoders.regression.trained import builtin
from models.errors import EncoderError
from models.pose import JOINTS
from models.surface import METRES_PER_INCH


@cache
def labeller_of(name: str) -> Labeller:
    """A labeller that asks the encoder of the paper."""
    return PaperLabels(builtin("paper"), name)


BY_NAME = pytest.mark.parametrize("name", METRICS)


@st.composite
def touches(draw: st.DrawFn, least: int = 1) -> dict[int, tuple[float, float]]:
    """Contacts anywhere on a tablet, a fingertip or more apart; ids of any size."""
    count = draw(st.integers(least, 5))
    ids = draw(st.lists(st.integers(0, 2**40), min_size=count, max_size=count, unique=True))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    while True:
        xy = rng.uniform(0.0, 0.15, (count, 2))
        gaps = np.linalg.norm(xy[:, None] - xy[None], axis=2)[np.triu_indices(count, 1)]
        if not len(gaps) or gaps.min() > 0.012:
            return {i: (float(x), float(y)) for i, (x, y) in zip(ids, xy, strict=True)}


@given(touches())
def test_contact_vectors_of_labellings_are_those_of_single_labellings(
    contacts: dict[int, tuple[float, float]],
) -> None:
    xy = np.array(list(contacts.values()))
    labels = hypotheses(len(xy))
    U = labelled_contact_vectors(xy, labels)
    for row in range(0, len(labels), 7):
        inches = xy / METRES_PER_INCH
        alone = contact_vector({f: tuple(inches[i]) for i, f in enumerate(labels[row].tolist())})
        assert U[row] == pytest.approx(alone, abs=1e-12)


@BY_NAME
@given(contacts=touches(), data=st.data(), shift=st.tuples(*[st.floats(-1.0, 1.0)] * 2))
def test_the_place_of_all_contacts_their_order_and_their_numbers_do_not_matter(
    name: str,
    contacts: dict[int, tuple[float, float]],
    data: st.DataObject,
    shift: tuple[float, float],
) -> None:
    labeller = labeller_of(name)
    order = data.draw(st.permutations(list(contacts)))
    other = dict(zip(contacts, order, strict=True))
    renamed = {other[i]: (contacts[i][0] + shift[0], contacts[i][1] + shift[1]) for i in order}
    labels = labeller.assign(contacts, {}).labels
    assert labeller.assign(renamed, {}).labels == {other[i]: f for i, f in labels.items()}


@BY_NAME
@given(contacts=touches(), data=st.data())
def test_fixed_labels_stay_and_every_contact_gets_a_finger_of_its_own(
    name: str, contacts: dict[int, tuple[float, float]], data: st.DataObject
) -> None:
    labeller = labeller_of(name)
    some = data.draw(st.lists(st.sampled_from(list(contacts)), unique=True))
    fingers = data.draw(st.permutations(range(5)))
    fixed = dict(zip(some, fingers, strict=False))
    found = labeller.assign(contacts, fixed)
    assert found.labels.keys() == contacts.keys()
    assert fixed.items() <= found.labels.items()
    assert len(set(found.labels.values())) == len(contacts)
    assert 0.0 <= found.probability <= 1.0


@BY_NAME
@pytest.mark.parametrize(
    ("contacts", "fixed"),
    [
        ({}, {}),
        ({i: (0.01 * i, 0.0) for i in range(6)}, {}),
        ({1: (float("nan"), 0.0)}, {}),
        ({1: (0.0, 0.0)}, {2: 0}),
        ({1: (0.0, 0.0)}, {1: 5}),
        ({1: (0.0, 0.0), 2: (0.1, 0.0)}, {1: 3, 2: 3}),
    ],
)
def test_questions_without_an_answer_are_refused(
    name: str, contacts: dict[int, tuple[float, float]], fixed: dict[int, int]
) -> None:
    labeller = labeller_of(name)
    with pytest.raises(EncoderError):
        labeller.assign(contacts, fixed)


@given(touches(least=2))
def test_the_paper_rule_is_the_closest_training_pose_of_all(
    contacts: dict[int, tuple[float, float]],
) -> None:
    degrees = np.rad2deg(builtin("paper").training_pose[:, JOINTS])
    best: tuple[float, dict[int, int]] = (np.inf, {})
    for fingers in permutations(range(5), len(contacts)):
        u = contact_vector(
            {
                f: (x / METRES_PER_INCH, y / METRES_PER_INCH)
                for f, (x, y) in zip(fingers, contacts.values(), strict=True)
            }
        )
        guess = np.rad2deg(builtin("paper").encoder.predict(u)[JOINTS])
        distance = np.sqrt(np.sum((degrees - guess) ** 2, axis=1).min())
        best = min(best, (distance, dict(zip(contacts, fingers, strict=True))), key=lambda b: b[0])
    assert labeller_of("joints").assign(contacts, {}).labels == best[1]


def test_a_lone_contact_is_the_index_finger_unless_its_name_is_fixed() -> None:
    labeller = PaperLabels(builtin("paper"))
    assert labeller.assign({7: (0.1, 0.1)}, {}).labels == {7: INDEX}
    assert labeller.assign({7: (0.1, 0.1)}, {7: 4}).labels == {7: 4}


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
    part=st.integers(1, 400),
)
def test_it_finds_what_looking_at_every_pair_finds_however_the_points_are_parted(
    seed: int, points: int, queries: int, width: int, spread: float, far: float, part: int
) -> None:
    rng = np.random.default_rng(seed)
    # Lumpy on purpose: frames of a capture come in bundles.
    lumps = rng.normal(0, spread, (5, width))
    P = lumps[rng.integers(0, 5, points)] + rng.normal(0, 0.1 * spread, (points, width)) + far
    Q = lumps[rng.integers(0, 5, queries)] + rng.normal(0, spread, (queries, width)) + far
    found, expected = NearestNeighbour(P, part).closest(Q), closest_of_all(Q, P)
    assert (found.query, found.point) == (expected.query, expected.point)
    assert found.distance == pytest.approx(expected.distance, rel=1e-9, abs=1e-9 * spread)


@given(seed=SEEDS, width=st.integers(1, 12), points=st.integers(1, 300), span=st.integers(1, 4))
def test_of_equal_pairs_the_first_query_and_its_first_point_win(
    seed: int, width: int, points: int, span: int
) -> None:
    """On a grid of few places most pairs have equals, exactly."""
    rng = np.random.default_rng(seed)
    P = rng.integers(0, span + 1, (points, width)).astype(float)
    Q = rng.integers(-span, span + 1, (30, width)).astype(float) + 0.5
    assert NearestNeighbour(P).closest(Q) == closest_of_all(Q, P)


def test_more_equal_points_than_are_compared_at_once_are_no_obstacle() -> None:
    P = np.tile([[1.0, 2.0, 3.0]], (70_000, 1))
    P[:7] += 1.0
    Q = np.array([[9.0, 9.0, 9.0], [1.0, 2.0, 2.0]])
    assert NearestNeighbour(P, cells=1).closest(Q) == Closest(1, 7, 1.0)


def test_pairs_that_single_precision_cannot_part_are_parted() -> None:
    P = np.array([[0.0, 0.0], [1000.0, 0.0]])
    Q = np.array([[1000.0, 1.0 + 1e-9], [1000.0, 1.0]])
    assert NearestNeighbour(P).closest(Q)[:2] == (1, 1)


@pytest.mark.parametrize(
    ("points", "queries"),
    [
        *((wrong, np.eye(3)) for wrong in (np.empty((0, 3)), np.zeros(3), np.full((2, 3), np.nan))),
        *((np.eye(3), wrong) for wrong in (np.empty((0, 3)), np.zeros((2, 4)))),
        (np.full((2, 3), -1e16), np.eye(3)),
        (np.eye(3), np.full((2, 3), np.inf)),
    ],
)
def test_points_and_queries_that_are_none_are_refused(
    points: np.ndarray, queries: np.ndarray
) -> None:
    with pytest.raises(EncoderError):
        NearestNeighbour(points).closest(queries)
