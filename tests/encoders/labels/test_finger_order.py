"""Fingers go round their middle in their order, however a right hand is turned or opened."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.labels.belief import builtin_belief
from encoders.labels.finger_order import in_order, order_shares
from encoders.labels.labelling import hypotheses, true_row
from encoders.labels.layout_density import finger_sets
from encoders.regression.trained import builtin_capture

ARC = np.array([[-0.05, 0.03], [-0.02, -0.03], [0.0, -0.04], [0.02, -0.03], [0.04, -0.01]])
"""m, y down: the fingertips of a right hand that lies flat."""


@given(
    fingers=st.sampled_from([s for k in (3, 4, 5) for s in finger_sets(k)]),
    turn=st.floats(-np.pi, np.pi),
    size=st.floats(0.3, 3.0),
    seed=st.integers(0, 2**32 - 1),
)
def test_a_right_hand_is_in_order_however_turned_large_or_listed(
    fingers: tuple[int, ...], turn: float, size: float, seed: int
) -> None:
    listed = np.random.default_rng(seed).permutation(fingers)
    c, s = np.cos(turn), np.sin(turn)
    xy = size * ARC[listed] @ np.array([[c, s], [-s, c]]) + 0.1
    assert in_order(xy)[true_row(listed)]
    assert not in_order(xy * [-1.0, 1.0])[true_row(listed)], "a left hand goes round the other way"


@given(
    xy=st.sampled_from([3, 4, 5]).flatmap(
        lambda k: st.lists(
            st.tuples(st.floats(0, 0.2), st.floats(0, 0.2)), min_size=k, max_size=k, unique=True
        )
    )
)
def test_of_the_orders_of_a_finger_set_as_many_fit_as_it_has_fingers(
    xy: list[tuple[float, float]],
) -> None:
    count = len(xy)
    fitting = hypotheses(count)[in_order(np.array(xy))]
    sets = [tuple(sorted(labels)) for labels in fitting.tolist()]
    assert {s: sets.count(s) for s in finger_sets(count)} == dict.fromkeys(
        finger_sets(count), count
    )


def test_hardly_any_fingers_cross_in_the_capture() -> None:
    shares = order_shares(builtin_capture())
    assert shares.keys() == {3, 4, 5}
    assert all(0.9 < share < 1.0 for share in shares.values())


@pytest.mark.parametrize("size", [0.7, 1.4])
def test_five_fingers_of_a_hand_of_another_size_are_named(size: float) -> None:
    capture = builtin_capture()
    five = np.flatnonzero(capture.down.all(axis=1))[::25]
    right = [named_in_order(capture.xy[frame] * size) for frame in five]
    assert sum(right) >= 0.97 * len(five)


@pytest.mark.parametrize("turn", np.deg2rad([-40.0, -20.0, 0.0, 20.0, 40.0]))
def test_a_thumb_far_off_against_four_fingers_in_a_line_is_named(turn: float) -> None:
    """As on the sides of a wide box. No gesture of the capture is like it; a belief that knew
    nothing but its capture would cross fingers, and be sure of it."""
    xy = np.array([[-0.065, 0.027], [0.009, -0.027], [0.013, -0.012], [0.019, 0.0], [0.024, 0.014]])
    c, s = np.cos(turn), np.sin(turn)
    assert named_in_order(xy @ np.array([[c, s], [-s, c]]))


def named_in_order(xy: np.ndarray) -> bool:
    """Whether contacts (5, 2) are believed to be the thumb, the index and so on."""
    contacts = {f: (float(x), float(y)) for f, (x, y) in enumerate(xy)}
    return builtin_belief().assign(contacts, {}).labels == {f: f for f in range(5)}
