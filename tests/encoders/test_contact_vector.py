"""The contact vector says where fingers are relative to each other, and nothing else."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.input_vector import contact_vector, contact_vectors, leftmost
from models.errors import EncoderError
from models.surface import METRES_PER_INCH

DOT = 1 / 128
"""inches. Whole numbers of it and their differences are exact in binary: equality can be meant."""

places = st.tuples(st.integers(0, 1024), st.integers(0, 768)).map(
    lambda p: (p[0] * DOT, p[1] * DOT)
)
hands = st.dictionaries(st.integers(0, 4), places, min_size=1, max_size=5)
moves = st.tuples(st.integers(-2000, 2000), st.integers(-2000, 2000))


def in_frame(contacts: dict[int, tuple[float, float]]) -> np.ndarray:
    """(1, 5, 2) m, the same contacts as a frame of a capture."""
    xy = np.full((1, 5, 2), np.nan)
    for label, place in contacts.items():
        xy[0, label] = np.array(place) * METRES_PER_INCH
    return xy


@given(contacts=hands, move=moves)
def test_moving_all_contacts_together_changes_nothing(
    contacts: dict[int, tuple[float, float]], move: tuple[int, int]
) -> None:
    moved = {i: (x + move[0] * DOT, y + move[1] * DOT) for i, (x, y) in contacts.items()}
    np.testing.assert_array_equal(contact_vector(moved), contact_vector(contacts))


@given(contacts=hands)
def test_layout_and_flags_can_be_read_back(contacts: dict[int, tuple[float, float]]) -> None:
    u = contact_vector(contacts)
    assert set(np.flatnonzero(u[10:])) == set(contacts)
    xy = u[:10].reshape(5, 2)
    first = min(contacts.values())
    for label in range(5):
        if label in contacts:
            np.testing.assert_array_equal(xy[label], np.subtract(contacts[label], first))
        else:
            np.testing.assert_array_equal(xy[label], [-1, -1])


@given(contacts=hands)
def test_many_frames_and_one_take_the_same_path(contacts: dict[int, tuple[float, float]]) -> None:
    U, origin = contact_vectors(in_frame(contacts))
    np.testing.assert_allclose(U[0], contact_vector(contacts), atol=1e-12)
    np.testing.assert_allclose(origin[0], np.array(min(contacts.values())) * METRES_PER_INCH)


def test_of_contacts_equally_far_left_the_upper_one_is_the_origin() -> None:
    u = contact_vector({1: (2.0, 3.0), 4: (2.0, 1.0), 0: (5.0, 0.0)})
    np.testing.assert_array_equal(u[[2, 3, 8, 9, 0, 1]], [0, 2, 0, 0, 3, -1])


def test_of_contacts_at_one_place_the_smaller_id_is_the_origin() -> None:
    assert leftmost([[1, 1], [1, 1], [1, 1]], [7, 3, 5]) == 1
    assert leftmost([[1, 1], [1, 1]]) == 0


def test_inches_and_the_place_of_every_number_are_the_papers() -> None:
    u = contact_vector({0: (1.0, 2.0), 2: (3.5, 1.0)})
    wanted = [0, 0, -1, -1, 2.5, -1, -1, -1, -1, -1, 1, 0, 1, 0, 0]
    np.testing.assert_array_equal(u, wanted)


@pytest.mark.parametrize(
    "contacts",
    (
        {},
        {5: (0.0, 0.0)},
        {-1: (0.0, 0.0)},
        {0: (np.nan, 0.0)},
        {0: (0.0, np.inf)},
        {0: (0.0, 0.0), 1: (1.0, -np.inf)},
    ),
)
def test_contacts_that_are_no_hand_are_refused(contacts: dict[int, tuple[float, float]]) -> None:
    with pytest.raises(EncoderError):
        contact_vector(contacts)
