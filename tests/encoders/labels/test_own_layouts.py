"""Layouts of a person's five fingers: what is kept, and what it tells about fewer fingers."""

import numpy as np
import pytest

from encoders.labels.labelling import hypotheses, true_row
from encoders.labels.own_layouts import MOST, OwnLayouts
from models.arithmetic.arrays import Array
from models.errors import EncoderError

HAND = 1e-3 * np.array([[0, 0], [35, -42], [60, -55], [83, -48], [104, -26]])


@pytest.mark.parametrize("fingers", [(0, 1), (1, 2), (0, 1, 2), (1, 2, 3), (0, 2, 3, 4)])
def test_a_part_of_a_known_layout_is_named_by_it(fingers: tuple[int, ...]) -> None:
    own = OwnLayouts(HAND[None])
    evidence = own.log_evidence(HAND[list(fingers)])
    assert evidence.argmax() == true_row(np.array(fingers))
    assert evidence.shape == (len(hypotheses(len(fingers))),)


def test_a_layout_far_from_all_known_ones_says_nothing() -> None:
    own = OwnLayouts(HAND[None])
    far = 1e-3 * np.array([[0, 0], [10, 200]])
    assert np.abs(own.log_evidence(far)).max() < 1e-6


def test_the_same_posture_is_kept_once_and_the_oldest_makes_room() -> None:
    own = OwnLayouts().with_new(HAND)
    assert own.with_new(HAND + 0.05) is own
    for angle in np.linspace(0.1, 6.2, 2 * MOST):
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        turned = HAND @ turn
        own = own.with_new(turned)
    assert len(own) == MOST
    assert np.allclose(own.layouts[-1], OwnLayouts(turned[None]).layouts[0])


@pytest.mark.parametrize(
    "layouts",
    [
        np.zeros((1, 5, 2)),
        HAND[None] * 9,
        np.full((1, 5, 2), np.nan),
        np.zeros((4, 2)),
        HAND[None] * [-1, 1],
    ],
    ids=["one spot", "too far apart", "not finite", "four fingers", "the other hand"],
)
def test_layouts_that_no_hand_has_are_refused(layouts: Array) -> None:
    with pytest.raises(EncoderError):
        OwnLayouts(layouts)


def test_a_layout_of_the_other_hand_is_not_kept() -> None:
    own = OwnLayouts(HAND[None])
    assert own.with_new(HAND * [-1.2, 1.2]) is own
    assert len(own.with_new(HAND * 1.2)) == 2
