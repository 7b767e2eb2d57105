"""The side of a hand does not depend on its size, its place or its proportions."""

from __future__ import annotations

import numpy as np
import pytest

from models.robot.mapping_fit import person_volume, volume
from models.rotations import exp
from models.skeleton import ADULT


def hands() -> np.ndarray:
    """(3, 4, 3): knuckles, and tips of straight and of bent fingers of a right hand."""
    across = np.array([-0.03, -0.01, 0.01, 0.03])[:, None] * np.array([1.0, 0.0, 0.0])
    ends = np.array([[0.0, 0.0, 0.0], [0.0, 0.09, 0.0], [0.0, 0.03, -0.06]])
    return ends[:, None] + across


def test_a_mirrored_hand_has_the_opposite_volume() -> None:
    right = hands()
    assert volume(*(right * [-1.0, 1.0, 1.0])) == pytest.approx(-volume(*right))
    assert person_volume(ADULT) == pytest.approx(-person_volume(ADULT.mirrored()))
    assert volume(*right) > 0 and person_volume(ADULT) > 0


def test_size_place_and_turn_do_not_matter() -> None:
    right = hands()
    moved = 1.7 * right @ exp(np.array([0.4, -1.2, 2.0])).T + [0.3, 0.1, -0.2]
    assert volume(*moved) == pytest.approx(volume(*right))


def test_longer_fingers_do_not_change_the_side() -> None:
    right = hands()
    longer = right.copy()
    longer[1:, 1] = right[0, 1] + 1.4 * (right[1:, 1] - right[0, 1])
    assert volume(*longer) == pytest.approx(volume(*right), rel=0.05)
