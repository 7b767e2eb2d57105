"""How far touches are from where they were a moment ago."""

from __future__ import annotations

from math import hypot, inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.reconstruction.arrival import ArrivalSettings
from encoders.reconstruction.recent_places import RecentPlaces

DT = 0.016
SPAN = 0.1
BACK = 7
"""Control steps in the moment, rounded up."""

coordinates = st.floats(-0.3, 0.3)
ways = st.lists(st.tuples(coordinates, coordinates), min_size=1, max_size=40)


@given(way=ways)
def test_a_contact_is_as_far_as_it_has_gone_since_then(way: list[tuple[float, float]]) -> None:
    recent = RecentPlaces(SPAN)
    for step, (x, y) in enumerate(way):
        far = recent.step(step * DT, {3: (x, y)})
        if step < BACK:
            assert far == inf
        else:
            then = way[step - BACK]
            assert far == pytest.approx(hypot(x - then[0], y - then[1]))


def test_the_farthest_of_the_contacts_counts_and_new_ones_do_not() -> None:
    recent = RecentPlaces(SPAN)
    for step in range(BACK + 1):
        places = {1: (0.001 * step, 0.0), 2: (0.0, 0.002 * step)}
        if step == BACK:
            places[9] = (0.2, 0.2)
        far = recent.step(step * DT, places)
    assert far == pytest.approx(0.002 * BACK)


def test_contacts_that_all_are_new_are_not_known() -> None:
    recent = RecentPlaces(SPAN)
    for step in range(2 * BACK):
        far = recent.step(step * DT, {step: (0.0, 0.0)})
    assert far == inf


def test_steps_of_no_time_and_a_reset_leave_nothing_wrong() -> None:
    recent = RecentPlaces(SPAN)
    for step in range(3 * BACK):
        recent.step(step * DT, {1: (0.0, 0.0)})
        far = recent.step(step * DT, {1: (0.0, 0.001)})
    assert far == 0.0
    recent.reset()
    assert recent.step(1.0, {1: (0.0, 0.0)}) == inf


def test_noise_of_most_of_a_millimetre_rests_and_a_drag_does_not() -> None:
    rng, arrival = np.random.default_rng(0), ArrivalSettings()
    limit = arrival.rest * arrival.dwell
    still, dragged = RecentPlaces(SPAN), RecentPlaces(SPAN)
    for step in range(200):
        x, y = rng.normal(0.0, 0.0007, 2).tolist()
        rests = still.step(step * DT, {1: (x, y)})
        goes = dragged.step(step * DT, {1: (x + 0.12 * step * DT, y)})
        if step >= BACK:
            assert rests < limit < goes
