"""Labels do not depend on where the hand is or how a device counts its contacts."""

from __future__ import annotations

from functools import cache
from itertools import permutations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.input_vector import contact_vector
from encoders.labels.labelling import (
    INDEX,
    METRICS,
    Labeller,
    PaperLabels,
    hypotheses,
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


@pytest.mark.parametrize(("count", "number"), [(1, 5), (2, 20), (3, 60), (4, 120), (5, 120)])
def test_there_are_as_many_labellings_as_ways_to_pick_fingers(count: int, number: int) -> None:
    assert sorted(map(tuple, hypotheses(count).tolist())) == list(permutations(range(5), count))
    assert len(hypotheses(count)) == number


@pytest.mark.parametrize("count", [0, 6, -1])
def test_no_hand_has_other_numbers_of_fingers(count: int) -> None:
    with pytest.raises(EncoderError, match="so many fingers"):
        hypotheses(count)


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
@given(contacts=touches(), shift=st.tuples(*[st.floats(-1.0, 1.0)] * 2))
def test_moving_all_touches_moves_no_label(
    name: str, contacts: dict[int, tuple[float, float]], shift: tuple[float, float]
) -> None:
    labeller = labeller_of(name)
    moved = {i: (x + shift[0], y + shift[1]) for i, (x, y) in contacts.items()}
    assert labeller.assign(moved, {}).labels == labeller.assign(contacts, {}).labels


@BY_NAME
@given(contacts=touches(), data=st.data())
def test_the_order_of_contacts_and_their_numbers_do_not_matter(
    name: str, contacts: dict[int, tuple[float, float]], data: st.DataObject
) -> None:
    labeller = labeller_of(name)
    order = data.draw(st.permutations(list(contacts)))
    other = dict(zip(contacts, order, strict=True))
    renamed = {other[i]: contacts[i] for i in order}
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


@pytest.mark.parametrize("name", METRICS)
@given(contacts=touches(least=2))
def test_fixing_what_would_be_chosen_anyway_changes_nothing(
    name: str, contacts: dict[int, tuple[float, float]]
) -> None:
    labeller = labeller_of(name)
    labels = labeller.assign(contacts, {}).labels
    first = next(iter(labels))
    assert labeller.assign(contacts, {first: labels[first]}).labels == labels


@BY_NAME
@pytest.mark.parametrize(
    ("contacts", "fixed"),
    [
        ({}, {}),
        ({i: (0.01 * i, 0.0) for i in range(6)}, {}),
        ({1: (float("nan"), 0.0)}, {}),
        ({1: (0.0, float("inf")), 2: (0.0, 0.1)}, {}),
        ({1: (0.0, 0.0)}, {2: 0}),
        ({1: (0.0, 0.0)}, {1: 5}),
        ({1: (0.0, 0.0)}, {1: -1}),
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


def test_a_training_frame_s_own_touches_are_the_closest_to_it() -> None:
    labeller = labeller_of("touches")
    for u in builtin("paper").training_u[:: len(builtin("paper").training_u) // 40]:
        down = np.flatnonzero(u[10:])
        touched = {
            int(f): (u[2 * f] * METRES_PER_INCH + 0.05, u[2 * f + 1] * METRES_PER_INCH + 0.05)
            for f in down
        }
        assert labeller.assign(touched, {}).labels == {int(f): int(f) for f in down}


def test_there_is_no_other_metric() -> None:
    with pytest.raises(EncoderError, match="no such metric"):
        PaperLabels(builtin("paper"), "taxicab")
