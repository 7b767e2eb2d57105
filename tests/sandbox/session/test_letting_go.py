"""Fingers keep the width of their grip while they tremble, and let go at once when they spread."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.arithmetic.arrays import Array
from models.scene import CONTROL_PERIOD
from sandbox.session.letting_go import FADING, OPENED, Grip
from tests.support.scripted import box_xy, pinch, run, scripted

HAND = np.array([[-0.03, 0.01], [0.03, -0.01], [0.025, 0.012]])
"""m, touches of thumb, index and middle finger."""
SOLID = frozenset({0, 1, 2})


def held(grip: Grip, places: Array) -> tuple[bool, Array]:
    """Whether fingers let go in a step, and where their tips (3, 2) m are kept."""
    touches = {finger: (float(x), float(y)) for finger, (x, y) in enumerate(places)}
    lets_go = grip.step(touches, SOLID)
    return lets_go, places if grip.offsets is None else places + grip.offsets[:3]


def opened(by: float) -> Array:
    """Touches (3, 2) m, each farther from the middle of all."""
    away = HAND - HAND.mean(axis=0)
    return HAND + by * away / np.linalg.norm(away, axis=1)[:, None]


def widths(places: Array) -> Array:
    """(3, 3) m from each finger to the others."""
    return np.linalg.norm(places[:, None] - places[None], axis=-1)


def test_fingers_that_open_a_little_keep_the_width_of_their_grip() -> None:
    grip = Grip()
    for by in np.linspace(0.0, 0.003, 31):
        lets_go, tips = held(grip, opened(by))
        assert not lets_go
        # Within half a second little of it is forgotten.
        touched, kept = widths(opened(by)) - widths(HAND), widths(tips) - widths(HAND)
        assert np.abs(kept).max() <= 0.2 * np.abs(touched).max()


def test_fingers_that_spread_let_go_once() -> None:
    grip, times = Grip(), []
    for step in range(40):
        lets_go, _ = held(grip, opened(min(0.0005 * step, 0.010)))
        if lets_go:
            times.append(step)
    assert times[0] <= 2 * OPENED / 0.0005 and len(times) <= 2


def test_tips_return_to_their_touches_in_small_steps_once_the_grip_is_gone() -> None:
    grip, steps = Grip(), []
    for by in (0.0, 0.001, 0.002, 0.003):
        _, before = held(grip, opened(by))
    open_now = opened(0.003)
    for _ in range(10):
        grip.step(dict.fromkeys((0, 1, 2), (0.0, 0.0)), frozenset())
        tips = open_now if grip.offsets is None else open_now + grip.offsets[:3]
        steps.append(np.linalg.norm(tips - before, axis=1).max())
        before = tips
    np.testing.assert_array_equal(before, open_now)
    assert max(steps) <= FADING * CONTROL_PERIOD + 1e-9


def test_fingers_that_close_are_followed_at_once() -> None:
    grip = Grip()
    for by in (0.0, -0.002, -0.004, -0.01):
        _, tips = held(grip, opened(by))
        np.testing.assert_array_equal(tips, opened(by))


@given(
    turn=st.floats(-0.02, 0.02),
    right=st.floats(-0.005, 0.005),
    down=st.floats(-0.005, 0.005),
)
def test_fingers_that_drag_and_turn_a_thing_are_followed(
    turn: float, right: float, down: float
) -> None:
    grip, places = Grip(), HAND
    c, s = np.cos(turn), np.sin(turn)
    for _ in range(50):
        lets_go, tips = held(grip, places)
        assert not lets_go
        np.testing.assert_allclose(tips, places, atol=1e-9)
        places = places @ np.array([[c, s], [-s, c]]) + [right, down]


def test_trembling_fingers_hold_on() -> None:
    rng, grip, off = np.random.default_rng(5), Grip(), np.zeros((3, 2))
    # Slow tremor, as of the simulated user, for a minute.
    keep = np.exp(-CONTROL_PERIOD / 0.15)
    for _ in range(round(60 / CONTROL_PERIOD)):
        off = keep * off + np.sqrt(1 - keep**2) * rng.normal(0.0, 0.00095, (3, 2))
        assert not held(grip, HAND + off)[0]


def test_a_single_finger_holds_nothing() -> None:
    grip = Grip()
    for x in (0.0, 0.1, 0.2):
        assert not grip.step({1: (x, 0.0)}, SOLID)
        assert grip.offsets is None


@pytest.mark.parametrize("lift", [True, False])
def test_a_box_stays_where_it_was_let_go_of_by_lifting_or_spreading(lift: bool) -> None:
    empty = scripted(lambda now: (), seed=1)
    at = box_xy(empty)
    empty.close()

    def gap(now: float) -> float:
        if now < 1.0:
            return 0.074
        return 0.056 if now < 2.0 or lift else min(0.056 + 0.3 * (now - 2.0), 0.09)

    touch = pinch(at, gap, yaw=0.7117)
    session = scripted(lambda now: () if now > 2.5 and lift else touch(now), seed=1)
    run(session, 2.0)
    assert len(session.solid(0)) == 2 and session.loads()[0].fingers[0].pressing > 1.0
    held_at, _ = session.scene.object_pose(session.data, "box")
    run(session, 1.0)
    left_at, _ = session.scene.object_pose(session.data, "box")
    assert session.loads()[0].fingers[0].force == 0.0
    assert np.linalg.norm(left_at - held_at) < 0.002
