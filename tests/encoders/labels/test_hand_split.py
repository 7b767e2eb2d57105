"""Two hands on one surface: each contact gets a hand once, and keeps it."""

from __future__ import annotations

from itertools import product
from random import Random

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from encoders.labels.hand_split import HandSplitter, all_shares
from models.frames import Contact, TouchFrame
from models.scene import CONTROL_PERIOD
from sandbox.devices.wrappers.shared import SharedDevice, SplitByPlace
from tests.support.scripted import Played

HOMES = np.array([(0.30, 0.10), (0.10, 0.10)])
"""m, of a right and a left hand on 40 by 20 cm."""


def frame(step: int, places: dict[int, tuple[float, float]]) -> TouchFrame:
    return TouchFrame(step * CONTROL_PERIOD, tuple(Contact(i, *p) for i, p in places.items()))


def held(splitter: HandSplitter, places: dict[int, tuple[float, float]], steps: int = 5) -> list:
    """The hands of some contacts that stay for a while, in order of their ids."""
    for step in range(steps):
        splitter.step(frame(step, places))
    return [splitter.hand(i) for i in sorted(places)]


def fan(middle: tuple[float, float], count: int) -> list[tuple[float, float]]:
    """Fingers of a hand about a middle, 25 mm apart."""
    return [(middle[0] + 0.025 * (k - (count - 1) / 2), middle[1]) for k in range(count)]


places = st.tuples(st.floats(0.0, 0.4), st.floats(0.0, 0.2))
histories = st.lists(st.dictionaries(st.integers(0, 14), places, max_size=13), max_size=25)


@given(histories)
@settings(max_examples=60, deadline=None)
def test_a_contact_never_changes_hands_while_it_is_down_and_no_hand_has_six(
    history: list[dict[int, tuple[float, float]]],
) -> None:
    splitter = HandSplitter(HOMES)
    before: dict[int, int] = {}
    for step, down in enumerate(history):
        parts = splitter.step(frame(step, down))
        now = {c.id: hand for hand, part in enumerate(parts) for c in part.contacts}
        # Every contact is in one part at most, where it is on the surface, and nothing is made up.
        assert sum(len(part.contacts) for part in parts) == len(now)
        for part in parts:
            assert len(part.contacts) <= 5
            assert all((c.x, c.y) == down[c.id] for c in part.contacts)
        for i, hand in before.items():
            if i in down:
                assert now[i] == hand
        before = now


@given(
    st.integers(1, 5),
    st.integers(1, 5),
    st.floats(-0.03, 0.03),
    st.floats(-0.03, 0.03),
    st.randoms(use_true_random=False),
)
@settings(max_examples=60, deadline=None)
def test_two_hands_that_come_down_at_their_homes_are_told_apart_whatever_the_ids(
    n: int, m: int, x: float, y: float, mix: Random
) -> None:
    right = [(px + x, py + y) for px, py in fan((0.30, 0.10), n)]
    left = [(px + x, py - y) for px, py in fan((0.10, 0.10), m)]
    ids = list(range(n + m))
    mix.shuffle(ids)
    down = dict(zip(ids, right + left, strict=True))
    splitter = HandSplitter(HOMES)
    for step in range(5):
        splitter.step(frame(step, down))
    assert [splitter.hand(i) for i in ids] == [0] * n + [1] * m


@given(st.integers(1, 5), st.integers(1, 5))
@settings(max_examples=25, deadline=None)
def test_in_a_mirror_the_hands_change_and_nothing_else(n: int, m: int) -> None:
    down = dict(enumerate([*fan((0.27, 0.12), n), *fan((0.09, 0.09), m)]))
    mirrored = {i: (0.4 - x, y) for i, (x, y) in down.items()}
    found, other = held(HandSplitter(HOMES), down), held(HandSplitter(HOMES), mirrored)
    assert [1 - hand for hand in found] == other


def test_a_finger_that_comes_back_beside_its_hand_belongs_to_it_far_from_its_home() -> None:
    splitter = HandSplitter(HOMES)
    away = dict(enumerate([(0.12, 0.05), (0.15, 0.05)]))
    assert held(splitter, {i: (x + 0.15, y) for i, (x, y) in away.items()}) == [0, 0]
    for step in range(5, 15):
        splitter.step(frame(step, away))
    for step in range(15, 25):
        splitter.step(frame(step, {**away, 7: (0.10, 0.06)}))
    assert splitter.hand(7) == 0


def test_six_fingers_of_one_place_are_two_hands_and_an_eleventh_is_nobodys() -> None:
    crowd = dict(enumerate((0.30 + 0.005 * k, 0.1) for k in range(11)))
    hands = held(HandSplitter(HOMES), crowd)
    assert hands.count(0) == hands.count(1) == 5 and hands.count(None) == 1


@pytest.mark.parametrize("room", [[5, 5], [2, 3], [0, 1], [5, 0], [0, 0]])
@pytest.mark.parametrize("n", [1, 4, 6])
def test_shares_are_all_those_that_leave_only_contacts_beyond_the_room_without_a_hand(
    n: int, room: list[int]
) -> None:
    every = [
        shares
        for shares in product((0, 1, -1), repeat=n)
        if shares.count(0) <= room[0] and shares.count(1) <= room[1]
        if shares.count(-1) == max(n - sum(room), 0)
    ]
    assert list(all_shares(n, room)) == every


def test_what_is_cancelled_is_told_to_its_hand_alone() -> None:
    splitter = HandSplitter(HOMES)
    held(splitter, {1: (0.3, 0.1), 2: (0.1, 0.1)})
    gone = TouchFrame(0.2, (Contact(2, 0.1, 0.1),), 0.5, frozenset({1}))
    right, left = splitter.step(gone)
    assert right.cancelled == {1} and not left.cancelled
    assert right.lift == left.lift == 0.5


class Once(Played):
    """A surface that reports each change once, and nothing while fingers rest."""

    @property
    def finished(self) -> bool:
        return False


def test_a_finger_that_rests_gets_its_hand_though_the_device_is_silent() -> None:
    shared = SharedDevice(Once([frame(0, {1: (0.3, 0.1), 2: (0.1, 0.1)})]), SplitByPlace(HOMES))
    found: list[set[int]] = [set(), set()]
    for step in range(6):
        for hand, part in enumerate(shared.parts):
            for each in part.poll(step * CONTROL_PERIOD):
                found[hand] |= {c.id for c in each.contacts}
    assert found == [{1}, {2}]
