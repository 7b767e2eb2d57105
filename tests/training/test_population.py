"""The population of simulated people: who is in it, its file, and the people to judge on."""

from pathlib import Path

import numpy as np
import pytest

from training.judged import JUDGED, NEXT, SALT, pinned_people
from training.population import (
    Population,
    load_population,
    save_population,
    simulate_population,
)
from training.population.population import PEOPLE

FEW = {"train": {"first": 2, "second": 2, "posed": 4}, "judge": {"second": 1}}
"""People of the first generator may be left out; with this salt neither is."""


@pytest.fixture(scope="module")
def people() -> Population:
    return simulate_population("a", FEW)


def test_nobody_is_twice_in_a_population_and_all_say_that_they_are_simulated(
    people: Population,
) -> None:
    seeds = [tuple(person.meta["seed"]) for person in people.people]
    assert len(set(seeds)) == len(seeds)
    assert all(person.meta["simulated"] for person in people.people)
    assert {person.meta["source"] for person in people.people} == {"first", "second", "posed"}
    assert {p.meta["source"] for p in people.of(without="second").people} == {"first", "posed"}
    assert all(p.meta["group"] == "judge" for p in people.of(group="judge").people)


def test_people_have_hands_of_their_own_size_within_the_published_range(people: Population) -> None:
    sizes = [person.meta["size"] for person in people.people]
    assert len(set(sizes)) == len(sizes)
    assert all(0.82 <= size <= 1.18 for size in sizes)


def test_people_to_train_on_show_every_set_of_fingers(people: Population) -> None:
    for source in ("first", "second"):
        person = next(p for p in people.people if p.meta["source"] == source)
        sets = {tuple(row) for row in person.down.tolist()}
        # A hand whose four or five touches cross now and then may lose one of 26 sets.
        assert len(sets) >= 24


def test_equal_salts_draw_equal_people_and_other_salts_others(people: Population) -> None:
    few = {"train": {"second": 2}}
    same, other = simulate_population("a", few), simulate_population("another", few)
    known = next(p for p in people.people if p.meta["source"] == "second")
    assert np.array_equal(same.people[0].xy, known.xy, equal_nan=True)
    assert same.digest != other.digest


def test_a_stored_population_is_the_same_population(people: Population, tmp_path: Path) -> None:
    save_population(people, tmp_path / "people.npz")
    back = load_population(tmp_path / "people.npz")
    assert back.digest == people.digest
    assert [p.meta for p in back.people] == [p.meta for p in people.people]


def test_people_put_down_neighbouring_fingers_about_as_far_apart_as_real_ones(
    people: Population,
) -> None:
    for person in people.people:
        five = person.xy[person.down.all(axis=1)] / person.meta["size"]
        middle = np.median(np.linalg.norm(np.diff(five, axis=1), axis=-1), axis=0)
        # Real medians are 54, 29, 23 and 31 mm.
        assert (np.abs(1e3 * middle - [54, 29, 23, 31]) < [39, 15, 12, 18]).all()


def test_judged_people_are_the_first_that_the_pinned_digest_draws_and_the_next_come_after() -> None:
    few = {"first": 1, "second": 2}
    drawn = simulate_population(SALT, {"judge": few}).people
    assert len(drawn) > 0
    for one, same in zip(pinned_people(JUDGED, few), drawn, strict=True):
        assert np.array_equal(one.xy, same.xy, equal_nan=True)
    for person in pinned_people(NEXT, few):
        pinned = PEOPLE["judge"][source := person.meta["source"]]
        assert pinned <= person.meta["number"] < pinned + few[source]
