"""Fingers are followed through whatever a touch screen says of them."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.reconstruction.contact_tracker import ContactTracker, TrackerSettings
from models.frames import Contact, TouchFrame

DT = 0.016
SETTINGS = TrackerSettings()
SHARP = replace(SETTINGS, low_pass=0.0)
"""Positions as the device gives them."""

HAND = ((0.02, 0.10), (0.04, 0.05), (0.06, 0.04), (0.08, 0.05), (0.1, 0.07))
THUMB, INDEX, MIDDLE = HAND[:3]

# Few ids and few places, so that ids come back, fingers come near one another, and far contacts
# and palms are among them.
contacts = st.builds(
    Contact,
    st.integers(0, 8),
    st.sampled_from([0.01, 0.02, 0.05, 0.10, 0.15, 0.33]),
    st.sampled_from([0.01, 0.03, 0.06, 0.12]),
    st.sampled_from([None, None, 0.01, 0.05]),
)
touches = st.lists(contacts, max_size=8, unique_by=lambda c: c.id).map(tuple)
moments = st.tuples(st.sampled_from([0.0, 0.004, DT, 0.1, 0.4]), touches, st.booleans())


@st.composite
def sequences(draw: st.DrawFn) -> list[TouchFrame]:
    """Frames of a device that does what it likes: some ids leave lifted, others cancelled."""
    frames, time, before = [], 0.0, frozenset[int]()
    for dt, down, cancel in draw(st.lists(moments, max_size=15)):
        time += dt
        now = frozenset(c.id for c in down)
        frames.append(TouchFrame(time, down, cancelled=before - now if cancel else frozenset()))
        before = now
    return frames


def frame(
    time: float, *places: tuple[float, float] | None, cancelled: Iterable[int] = (), **more: Any
) -> TouchFrame:
    """Contacts by place; the id is the place in the row, None is no contact."""
    down = [Contact(i, *xy) for i, xy in enumerate(places) if xy is not None]
    return TouchFrame(time, tuple(down), cancelled=frozenset(cancelled), **more)


def moved(places: Iterable[tuple[float, float]], x: float, y: float) -> list[tuple[float, float]]:
    return [(px + x, py + y) for px, py in places]


def after(*frames: TouchFrame, settings: TrackerSettings = SHARP) -> ContactTracker:
    tracker = ContactTracker(settings)
    for each in frames:
        tracker.step(each)
    return tracker


@given(frames=sequences())
def test_there_are_never_more_than_five_fingers_and_no_two_share_an_id(
    frames: list[TouchFrame],
) -> None:
    tracker = ContactTracker()
    seen: set[int] = set()
    for each in frames:
        before = set(tracker.tracks)
        tracker.step(each)
        assert len(tracker.tracks) <= 5
        assert all(np.isfinite(t.place).all() for t in tracker.tracks.values())
        assert all(track.id == key for key, track in tracker.tracks.items())
        device_ids = [track.device_id for track in tracker.tracks.values()]
        assert len(set(device_ids)) == len(device_ids)
        new = set(tracker.tracks) - before
        assert not new & seen, "an id that was a finger's is never another's"
        seen |= new


@given(frames=sequences())
def test_every_contact_is_one_finger_or_ignored_and_every_finger_touches_or_is_lost(
    frames: list[TouchFrame],
) -> None:
    tracker = ContactTracker()
    for each in frames:
        tracker.step(each)
        down = {c.id for c in each.contacts}
        touching = {t.device_id for t in tracker.tracks.values() if t.active}
        lost = {t.device_id for t in tracker.tracks.values() if not t.active}
        ignored = {c.id for c in tracker.ignored}
        assert touching | ignored == down
        assert not touching & ignored
        assert not lost & down


@given(frames=sequences())
def test_a_lost_finger_lives_no_longer_than_its_grace(frames: list[TouchFrame]) -> None:
    tracker = ContactTracker()
    for each in frames:
        tracker.step(each)
        lost = [t for t in tracker.tracks.values() if t.lost_at is not None]
        assert all(each.time - t.lost_at < t.grace for t in lost)
        assert {t.grace for t in lost} <= {SETTINGS.grace, SETTINGS.cancelled_grace}


@given(frames=sequences(), later=sequences())
def test_after_a_reset_the_past_is_forgotten(
    frames: list[TouchFrame], later: list[TouchFrame]
) -> None:
    used, fresh = after(*frames, settings=SETTINGS), ContactTracker()
    used.reset()
    for each in later:
        used.step(each)
        fresh.step(each)
        assert used.ignored == fresh.ignored
        for a, b in zip(used.tracks.values(), fresh.tracks.values(), strict=True):
            assert (a.device_id, a.lost_at, a.born) == (b.device_id, b.lost_at, b.born)
            np.testing.assert_array_equal(a.place, b.place)


@given(lost=st.integers(0, 4), x=st.floats(-0.05, 0.05), y=st.floats(-0.05, 0.05))
def test_a_lost_finger_is_carried_by_the_others(lost: int, x: float, y: float) -> None:
    there = moved(HAND, x, y)
    there[lost] = None
    tracker = after(frame(0.0, *HAND), frame(DT, *there))
    np.testing.assert_allclose(tracker.tracks[lost].place, moved(HAND, x, y)[lost], atol=1e-12)
    assert not tracker.tracks[lost].active


@given(
    away=st.floats(0.0, 0.02),
    angle=st.floats(0.0, 6.3),
    pause=st.floats(0.0, SETTINGS.grace - 0.01),
)
def test_a_new_id_close_to_a_lost_finger_inherits_it(
    away: float, angle: float, pause: float
) -> None:
    near = (INDEX[0] + away * np.cos(angle), INDEX[1] + away * np.sin(angle))
    tracker = after(
        frame(0.0, THUMB, INDEX),
        frame(DT, THUMB, None),
        frame(DT + pause, THUMB, None, None, near),
    )
    assert list(tracker.tracks) == [0, 1]
    heir = tracker.tracks[1]
    assert (heir.active, heir.device_id, heir.born) == (True, 3, 0.0)
    np.testing.assert_array_equal(heir.place, near)
    assert tracker.counts["found again"] == 1


def test_a_new_id_elsewhere_is_another_finger() -> None:
    far = (INDEX[0] + SETTINGS.inherit + 0.001, INDEX[1])
    tracker = after(
        frame(0.0, THUMB, INDEX), frame(DT, THUMB, None), frame(2 * DT, THUMB, None, far)
    )
    assert [t.active for t in tracker.tracks.values()] == [True, False, True]
    assert "found again" not in tracker.counts


def test_a_new_id_between_two_lost_fingers_inherits_the_nearer_one() -> None:
    tracker = after(
        frame(0.0, THUMB, INDEX, MIDDLE),
        frame(DT, THUMB, None, None),
        frame(2 * DT, THUMB, None, None, (0.054, 0.043)),
    )
    assert {i: t.active for i, t in tracker.tracks.items()} == {0: True, 1: False, 2: True}


@pytest.mark.parametrize(
    ("cancelled", "grace"), [((), SETTINGS.grace), ((1,), SETTINGS.cancelled_grace)]
)
def test_a_cancelled_finger_lives_longer_than_a_lifted_one(
    cancelled: tuple[int, ...], grace: float
) -> None:
    tracker = after(frame(0.0, THUMB, INDEX), frame(DT, THUMB, None, cancelled=cancelled))
    tracker.step(frame(DT + grace - 0.001, THUMB, None))
    assert 1 in tracker.tracks
    tracker.step(frame(DT + grace + 0.001, THUMB, None))
    assert 1 not in tracker.tracks
    assert SETTINGS.cancelled_grace > SETTINGS.grace + 0.1


def test_with_no_finger_left_all_are_let_go_together_when_the_first_ones_time_is_over() -> None:
    tracker = after(
        frame(0.0, THUMB, INDEX, MIDDLE),
        frame(DT, None, INDEX, MIDDLE),
        frame(2 * DT, None, None, MIDDLE),
        frame(4 * DT, None, None, None),
    )
    tracker.step(frame(DT + SETTINGS.grace - 0.001, None))
    assert len(tracker.tracks) == 3
    tracker.step(frame(DT + SETTINGS.grace + 0.001, None))
    assert len(tracker.tracks) == 0


def test_while_a_finger_touches_the_others_go_one_by_one() -> None:
    tracker = after(frame(0.0, THUMB, INDEX, MIDDLE), frame(DT, THUMB, None, MIDDLE))
    tracker.step(frame(DT + 0.1, THUMB, None, None))
    tracker.step(frame(DT + SETTINGS.grace, THUMB, None, None))
    assert list(tracker.tracks) == [0, 2]
    tracker.step(frame(DT + 0.1 + SETTINGS.grace, THUMB, None, None))
    assert list(tracker.tracks) == [0]


PALM = Contact(9, 0.06, 0.12, SETTINGS.blob + 0.001)
FAR = Contact(9, THUMB[0] + SETTINGS.span + 0.001, THUMB[1])
SIXTH = Contact(9, 0.06, 0.08)


@pytest.mark.parametrize(
    ("contact", "why"),
    [(PALM, "palm"), (FAR, "farther away than a hand reaches"), (SIXTH, "more than five")],
)
def test_contacts_that_are_not_fingers_of_the_hand_are_ignored_and_counted_once(
    contact: Contact, why: str
) -> None:
    hand = HAND if why == "more than five" else HAND[:2]
    down = frame(0.0, *hand).contacts
    tracker = after(*[TouchFrame(i * DT, (*down, contact)) for i in range(3)])
    assert tracker.ignored == (contact,)
    assert tracker.counts == {why: 1}
    assert len(tracker.tracks) == len(hand)
    # It stays what it is while it is down, though there would be room for it now ...
    tracker.step(TouchFrame(1.0, (*down[:1], contact)))
    tracker.step(TouchFrame(2.0, (*down[:1], contact)))
    assert tracker.ignored == (contact,)
    assert len(tracker.tracks) == 1
    # ... and is forgotten once it is lifted.
    tracker.step(TouchFrame(2.1, down[:1]))
    tracker.step(TouchFrame(2.2, (*down[:1], replace(contact, x=0.05, y=0.06, size=None))))
    assert len(tracker.tracks) == 2
    assert tracker.ignored == ()


def test_a_palm_does_not_replace_a_lost_finger() -> None:
    palm = Contact(9, *INDEX, SETTINGS.blob + 0.001)
    thumb = frame(0.0, THUMB).contacts
    tracker = after(
        frame(0.0, THUMB, INDEX), frame(DT, THUMB, None), TouchFrame(2 * DT, (*thumb, palm))
    )
    assert tracker.ignored == (palm,)


def test_a_sixth_contact_takes_the_place_of_the_finger_lost_longest() -> None:
    tracker = after(
        frame(0.0, *HAND),
        frame(DT, None, *HAND[1:]),
        frame(2 * DT, None, None, *HAND[2:]),
        frame(3 * DT, None, None, *HAND[2:], (0.06, 0.12)),
    )
    assert list(tracker.tracks) == [1, 2, 3, 4, 5]


@given(dt=st.floats(0.001, 0.1), x=st.floats(-0.1, 0.1), y=st.floats(-0.1, 0.1))
def test_smoothing_is_the_same_in_one_step_and_in_two_halves(dt: float, x: float, y: float) -> None:
    there = moved([THUMB, INDEX], x, y)
    start = frame(0.0, THUMB, INDEX)
    once = after(start, frame(dt, *there), settings=SETTINGS)
    twice = after(start, frame(dt / 2, *there), frame(dt, *there), settings=SETTINGS)
    for a, b in zip(once.tracks.values(), twice.tracks.values(), strict=True):
        np.testing.assert_allclose(a.place, b.place, atol=1e-12)


def test_labels_of_a_device_that_knows_its_fingers_are_used() -> None:
    tracker = after(
        TouchFrame(0.0, (Contact(0, *THUMB, label=0), Contact(1, *INDEX))),
        TouchFrame(DT, (Contact(0, *THUMB), Contact(1, *INDEX, label=1))),
    )
    assert [t.device_label for t in tracker.tracks.values()] == [0, 1]


def test_an_id_that_a_device_uses_again_elsewhere_is_another_finger() -> None:
    tracker = after(frame(0.0, THUMB, INDEX), frame(DT, THUMB, None))
    before = set(tracker.tracks)
    far = (INDEX[0] + SETTINGS.inherit + 0.01, INDEX[1])
    tracker.step(frame(2 * DT, THUMB, far))
    assert len(tracker.tracks) == 2
    assert len(before & set(tracker.tracks)) == 1


@given(frames=sequences())
def test_positions_stay_finite_and_counts_only_grow(frames: list[TouchFrame]) -> None:
    tracker = ContactTracker()
    counts: dict[str, int] = {}
    for each in frames:
        tracker.step(each)
        assert all(np.isfinite(t.place).all() for t in tracker.tracks.values())
        assert all(tracker.counts[reason] >= n for reason, n in counts.items())
        counts = dict(tracker.counts)
