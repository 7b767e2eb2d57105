"""Palms are told from fingers by their size, its growth and their place, before they push."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.reconstruction.contact_tracker import (
    LARGEST,
    ContactTracker,
    Kind,
    PalmJudge,
    SizeCourse,
    place_odds,
)
from encoders.reconstruction.hand_motion import Phase
from encoders.reconstruction.touch_reconstructor import TouchReconstructor
from models.frames import Contact, TouchFrame
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.trial.assembly import load_encoder, make_labeller, reconstructor_settings
from sandbox.trial.settings import Settings

DT = 0.016
FINGERS = ((0.10, 0.14), (0.12, 0.09), (0.14, 0.08), (0.16, 0.09), (0.18, 0.11))
"""Touches of thumb to little finger."""
HEEL = (0.16, 0.22)
PLACES = st.tuples(st.floats(0.0, 0.3), st.floats(0.0, 0.2))


def touch(number: int, size: float | None = 0.01, at: tuple[float, float] | None = None) -> Contact:
    """A round contact of a diameter in m, at a finger's place or elsewhere."""
    x, y = at or FINGERS[number]
    return Contact(number, x, y, extent=None if size is None else (size, size))


def grown(time: float, first: float, last: float, takes: float) -> float:
    """Diameter after some time of a contact that grows."""
    return first + (last - first) * min(time / takes, 1.0)


def reconstructor() -> TouchReconstructor:
    settings = Settings()
    model = load_encoder(settings.pipeline.encoder)
    surface = Surface(16.0, 12.0)
    return TouchReconstructor(
        model, make_labeller(settings, model), ADULT, surface, reconstructor_settings(settings)
    )


def judged(sizes: list[float]) -> list[Kind]:
    """What a lone contact is taken for, frame by frame."""
    judge, kinds = PalmJudge(), []
    for step, size in enumerate(sizes):
        judge.step(DT * step, [touch(0, size)])
        kinds.append(judge.kind(0))
    return kinds


@given(st.floats(0.0, 0.022), st.integers(0, 2**31))
def test_a_fingertip_is_known_within_the_time_that_names_take(size: float, seed: int) -> None:
    noise = np.random.default_rng(seed).normal(1.0, 0.05, 8)
    kinds = judged([max(size, 0.0001) * n for n in noise])
    assert Kind.PALM not in kinds
    if size < 0.009:
        assert kinds[-1] is Kind.FINGER


@given(st.floats(0.040, 0.5), st.integers(0, 2**31))
def test_a_large_contact_is_a_palm_and_never_a_finger(size: float, seed: int) -> None:
    noise = np.random.default_rng(seed).normal(1.0, 0.1, 60)
    kinds = judged([size * max(n, 0.7) for n in noise])
    assert Kind.FINGER not in kinds
    assert kinds[-1] is Kind.PALM


@given(st.floats(0.008, 0.02), st.floats(0.045, 0.09), st.floats(0.1, 0.4))
def test_a_contact_that_grows_into_a_palm_is_one_before_it_has_grown(
    first: float, last: float, takes: float
) -> None:
    kinds = judged([grown(DT * i, first, last, takes) for i in range(40)])
    assert kinds[round(takes / DT) + 3] is Kind.PALM


@given(st.lists(st.floats(0.001, 0.2), min_size=1, max_size=60))
def test_a_palm_stays_one_until_it_leaves_whatever_is_reported(sizes: list[float]) -> None:
    judge = PalmJudge()
    was = False
    for step, size in enumerate(sizes):
        judge.step(DT * step, [touch(0, size)])
        now = judge.kind(0) is Kind.PALM
        assert now or not was
        was = now
    judge.step(DT * len(sizes), [])
    assert judge.kind(0) is Kind.FINGER


@given(st.lists(st.floats(0.001, 0.2), min_size=60, max_size=60))
def test_nobody_is_left_unsure(sizes: list[float]) -> None:
    assert judged(sizes)[-1] is not Kind.UNSURE


@given(st.lists(st.tuples(st.floats(0.001, 0.2), st.floats(0.001, 0.2)), max_size=40))
def test_width_and_height_may_be_exchanged(extents: list[tuple[float, float]]) -> None:
    one, other = SizeCourse(0.0), SizeCourse(0.0)
    for step, (width, height) in enumerate(extents):
        one.report(DT * step, (width, height))
        other.report(DT * step, (height, width))
    assert one.odds == pytest.approx(other.odds, abs=1e-6)


@given(PLACES, st.lists(PLACES, min_size=1, max_size=6), PLACES, st.randoms())
def test_odds_of_a_place_depend_on_where_it_is_beside_the_others_alone(
    place: tuple[float, float],
    others: list[tuple[float, float]],
    by: tuple[float, float],
    random: Random,
) -> None:
    odds = place_odds(place, others)
    assert abs(odds) <= LARGEST
    shuffled = random.sample(others, len(others))
    # The others' order decides only between places that are equally far.
    assert place_odds(place, sorted(shuffled)) == place_odds(place, sorted(others))
    lone = [others[0]]
    moved = [(x + by[0], y + by[1]) for x, y in lone]
    here = place[0] + by[0], place[1] + by[1]
    assert place_odds(here, moved) == pytest.approx(place_odds(place, lone), abs=1e-6)


def frames(*contacts: tuple[Contact, float], until: float) -> list[TouchFrame]:
    """Resting contacts that begin at their times."""
    return [
        TouchFrame(DT * i, tuple(c for c, begin in contacts if DT * i >= begin))
        for i in range(round(until / DT))
    ]


@pytest.mark.parametrize("begins", [0.0, 0.3, 1.2])
@pytest.mark.parametrize("takes", [0.1, 0.4])
def test_a_palm_that_grows_beside_a_grip_never_gets_a_name_nor_moves_the_hand(
    begins: float, takes: float
) -> None:
    grip = [(touch(i), 0.2) for i in range(3)]
    with_palm, alone = reconstructor(), reconstructor()
    told = set()
    for frame in frames(*grip, until=2.2):
        palm: tuple[Contact, ...] = ()
        if frame.time >= begins:
            size = grown(frame.time - begins, 0.012, 0.05, takes)
            palm = (touch(9, size, HEEL),)
        hand = with_palm.step(replace(frame, contacts=frame.contacts + palm))
        still = alone.step(frame)
        told |= {(c.label, c.state) for c in hand.contacts if c.id == 9}
        if begins > 1.0:
            assert np.array_equal(hand.q, still.q)
            assert hand.phase is still.phase
    assert all(label is None for label, _ in told)
    assert (None, "palm") in told
    assert hand.phase is Phase.DOWN
    assert hand.fingers == still.fingers


def test_a_finger_that_becomes_a_palm_is_dropped_and_the_others_go_on() -> None:
    hand = reconstructor()
    for frame in frames(*((touch(i), 0.0) for i in range(4)), until=1.5):
        size = grown(max(frame.time - 1.0, 0.0), 0.01, 0.06, 0.2)
        found = hand.step(replace(frame, contacts=(*frame.contacts[:3], touch(3, size))))
        if frame.time < 1.0:
            before = {c.id: c.label for c in found.contacts}
    after = {c.id: (c.label, c.state) for c in found.contacts}
    assert after == {i: (before[i], "active") for i in range(3)} | {3: (None, "palm")}
    assert found.phase is Phase.DOWN


def test_a_finger_that_had_no_room_beside_a_palm_comes_once_the_palm_is_known() -> None:
    tracker = ContactTracker()
    for step in range(30):
        size = grown(DT * step, 0.012, 0.06, 0.2)
        palm = Contact(0, *HEEL, extent=(size, size))
        fingers = tuple(replace(touch(i), id=1 + i) for i in range(5))
        tracker.step(TouchFrame(DT * step, (palm, *fingers)))
        if step == 1:
            assert [c.id for c in tracker.ignored] == [5]
    assert tracker.palms == {0}
    assert {t.device_id for t in tracker.tracks.values()} == {1, 2, 3, 4, 5}
    assert tracker.counts["palm"] == 1


@given(st.floats(0.004, 0.09), PLACES)
def test_while_five_fingers_are_down_nothing_else_becomes_one(
    size: float, place: tuple[float, float]
) -> None:
    tracker = ContactTracker()
    five = tuple(touch(i) for i in range(5))
    for step in range(80):
        more = (touch(9, size, place),) if step >= 20 else ()
        tracker.step(TouchFrame(DT * step, five + more))
    assert {t.device_id for t in tracker.tracks.values()} == {0, 1, 2, 3, 4}


@given(st.lists(st.sampled_from([None, 0.01, 0.034, 0.05]), min_size=5, max_size=5))
def test_contacts_without_width_and_height_are_judged_by_their_diameter_as_they_come(
    sizes: list[float],
) -> None:
    tracker = ContactTracker()
    contacts = tuple(replace(touch(i, None), size=s) for i, s in enumerate(sizes))
    tracker.step(TouchFrame(0.0, contacts))
    assert tracker.palms == {i for i, s in enumerate(sizes) if s == 0.05}
    assert not any(t.unsure for t in tracker.tracks.values())
