"""People to judge on stay the same, whatever models ship."""

from __future__ import annotations

import numpy as np

from training.population.pinned import JUDGED, NEXT, SALT, pinned_people
from training.population.population import PEOPLE, simulate_population

FEW = {"first": 1, "second": 2}


def test_judged_people_are_the_first_that_the_pinned_digest_draws() -> None:
    drawn = simulate_population(SALT, {"judge": FEW}).people
    assert len(pinned_people(JUDGED, FEW)) == len(drawn) > 0
    for one, same in zip(pinned_people(JUDGED, FEW), drawn, strict=True):
        assert np.array_equal(one.xy, same.xy, equal_nan=True)


def test_the_next_people_come_after_all_judged_ones() -> None:
    pinned = PEOPLE["judge"]
    for person in pinned_people(NEXT, FEW):
        source = person.meta["source"]
        assert pinned[source] <= person.meta["number"] < pinned[source] + FEW[source]
