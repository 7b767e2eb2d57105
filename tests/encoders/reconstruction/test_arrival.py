"""A hand comes down from above, over its place and at rest, and never jumps.

Rest is seen from how far touches are from where they were a moment ago.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import hypot, inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.reconstruction.hand_motion import Arrival, ArrivalSettings, Phase, RecentPlaces

DT = 0.016
S = ArrivalSettings()
LOW = (Phase.COMING_DOWN, Phase.DOWN)
SPAN = 0.1
BACK = 7
"""Control steps in the moment, rounded up."""

coordinates = st.floats(-0.3, 0.3)
ways = st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=40)


@dataclass(frozen=True)
class Moment:
    """What a hand is told in one step; by default all is well for coming down."""

    touched: bool = True
    named: bool = True
    speed: float = 0.0
    off: float = 0.0
    moved: float = inf


READY = Moment()
NOTHING = Moment(touched=False, named=False)

moments = st.builds(
    Moment,
    st.booleans(),
    st.booleans(),
    st.sampled_from([0.0, 0.04, 0.06, 0.5]),
    st.sampled_from([0.0, 0.005, 0.007, 0.2]),
    st.sampled_from([0.0, 0.003, 0.008, inf]),
)
stretches = st.lists(st.tuples(moments, st.integers(1, 30)), max_size=10).map(
    lambda parts: [moment for moment, n in parts for _ in range(n)]
)


def told(arrival: Arrival, moment: Moment, seconds: float = DT, dt: float = DT) -> Arrival:
    """The same for a while."""
    for _ in range(round(seconds / dt)):
        arrival.step(
            dt,
            touched=moment.touched,
            named=moment.named,
            speed=moment.speed,
            off=moment.off,
            moved=moment.moved,
        )
    return arrival


@given(history=stretches, dt=st.sampled_from([0.001, 0.008, DT]))
def test_the_height_never_jumps_and_stays_between_the_place_and_the_hover(
    history: list[Moment], dt: float
) -> None:
    arrival = Arrival(S)
    for moment in history:
        before = arrival.height
        told(arrival, moment, dt, dt)
        assert 0.0 <= arrival.height <= S.hover
        assert -S.down * dt - 1e-12 <= arrival.height - before <= S.up * dt + 1e-12


@given(history=stretches)
def test_a_hand_is_down_only_at_its_place_and_comes_down_only_over_it(
    history: list[Moment],
) -> None:
    arrival = Arrival(S)
    for moment in history:
        before = arrival.phase
        told(arrival, moment)
        if arrival.phase is Phase.DOWN:
            assert arrival.height == 0.0
        if arrival.phase in LOW:
            assert moment.touched
        if arrival.phase in LOW and before not in LOW:
            assert moment.off <= S.place
            assert moment.named
            assert before is Phase.ABOVE or S.dwell <= DT


@given(history=stretches)
def test_a_hand_that_nothing_touches_rises_to_its_hover_and_is_as_new_after_a_reset(
    history: list[Moment],
) -> None:
    arrival, used, fresh = (Arrival(S) for _ in range(3))
    for moment in history:
        told(arrival, moment)
        told(used, moment)
    told(arrival, NOTHING, S.hover / S.up + 2 * DT)
    assert (arrival.phase, arrival.height) == (Phase.AWAY, S.hover)
    used.reset()
    for _ in range(60):
        told(used, READY)
        told(fresh, READY)
        assert (used.phase, used.height) == (fresh.phase, fresh.height)


def test_a_hand_over_resting_touches_dwells_and_then_comes_down_at_its_speed() -> None:
    arrival = Arrival(S)
    heights, phases = [], []
    for _ in range(40):
        told(arrival, READY)
        heights.append(arrival.height)
        phases.append(arrival.phase)
    begun = phases.index(Phase.COMING_DOWN)
    down = phases.index(Phase.DOWN)
    assert begun * DT == pytest.approx(S.dwell, abs=DT)
    assert (down - begun + 1) * DT == pytest.approx(S.hover / S.down, abs=DT)
    falling = np.diff([S.hover, *heights[begun:down]])
    np.testing.assert_allclose(falling, -S.down * DT)


def test_moving_touches_keep_a_hand_up_until_its_patience_is_over() -> None:
    moving = Moment(speed=S.rest + 0.01)
    arrival = told(Arrival(S), moving, S.patience - 2 * DT)
    assert (arrival.phase, arrival.height) == (Phase.ABOVE, S.hover)
    assert told(arrival, moving, 3 * DT).phase is Phase.COMING_DOWN


TREMBLING = Moment(speed=0.3, moved=0.002)


def test_touches_that_tremble_and_stay_rest_and_those_that_go_somewhere_do_not() -> None:
    assert told(Arrival(S), TREMBLING, S.dwell - DT).phase is Phase.ABOVE
    assert told(Arrival(S), TREMBLING, S.dwell + 2 * DT).phase is Phase.COMING_DOWN
    going = Moment(speed=S.rest + 0.01, moved=(S.rest + 0.01) * S.dwell)
    assert told(Arrival(S), going, S.patience - 2 * DT).phase is Phase.ABOVE


@given(history=stretches)
def test_a_hand_whose_touches_stay_never_comes_down_later(history: list[Moment]) -> None:
    staying, without = Arrival(S), Arrival(S)
    for moment in history:
        told(staying, moment)
        told(without, replace(moment, moved=inf))
        assert staying.phase in LOW or without.phase not in LOW


def test_a_rest_that_is_broken_begins_anew() -> None:
    arrival = Arrival(S)
    for _ in range(4):
        told(arrival, READY, S.dwell - 2 * DT)
        told(arrival, Moment(speed=1.0))
        assert arrival.phase is Phase.ABOVE
    assert told(arrival, READY, S.dwell + DT).phase in LOW


@pytest.mark.parametrize("moment", [Moment(speed=2.0, off=0.3), Moment(named=False)])
def test_a_hand_that_is_down_stays_down_however_its_touches_move(moment: Moment) -> None:
    arrival = told(told(Arrival(S), READY, 1.0), moment, 5.0)
    assert (arrival.phase, arrival.height) == (Phase.DOWN, 0.0)


def test_hands_that_do_not_hover_are_down_as_soon_as_their_fingers_have_names() -> None:
    arrival = Arrival(replace(S, hover=0.0))
    assert arrival.height == 0.0
    assert told(arrival, Moment(speed=5.0, off=1.0)).phase is Phase.DOWN
    assert told(arrival, Moment(named=False)).phase is Phase.AWAY
    assert told(arrival, NOTHING).phase is Phase.AWAY
    assert arrival.height == 0.0


@given(way=ways)
def test_a_contact_is_as_far_as_it_has_gone_since_then(way: list[tuple[float, float]]) -> None:
    recent = RecentPlaces(SPAN)
    for step, (x, y) in enumerate(way):
        recent.step(step * DT, {3: (x, y)})
        if step < BACK:
            assert recent.moved == inf
        else:
            then = way[step - BACK]
            assert recent.moved == pytest.approx(hypot(x - then[0], y - then[1]))


def test_the_farthest_of_the_contacts_counts_and_new_ones_do_not() -> None:
    recent = RecentPlaces(SPAN)
    for step in range(BACK + 1):
        places = {1: (0.001 * step, 0.0), 2: (0.0, 0.002 * step)}
        if step == BACK:
            places[9] = (0.2, 0.2)
        recent.step(step * DT, places)
    assert recent.moved == pytest.approx(0.002 * BACK)


def test_steps_of_no_time_and_a_reset_leave_nothing_wrong() -> None:
    recent = RecentPlaces(SPAN)
    for step in range(3 * BACK):
        recent.step(step * DT, {1: (0.0, 0.0)})
        recent.step(step * DT, {1: (0.0, 0.001)})
    assert recent.moved == 0.0
    recent.reset()
    recent.step(1.0, {1: (0.0, 0.0)})
    assert recent.moved == inf
