"""A belief is a probability over labellings, whatever comes and goes."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from encoders.labels.belief import BeliefLabels, _marginals, builtin_population_model, claimed
from encoders.labels.labelling import hypotheses, normalised
from encoders.regression.trained import builtin_capture
from models.arithmetic import Array

Contacts = dict[int, tuple[float, float]]
SEEDS = st.integers(0, 2**32 - 1)


def new_belief() -> BeliefLabels:
    """A belief without contacts, which learns no layouts of five fingers."""
    return BeliefLabels(builtin_population_model())


@st.composite
def touches(draw: st.DrawFn, least: int = 1, most: int = 5) -> Contacts:
    """The touches of a frame of the capture, some of them, a little displaced, with any ids."""
    capture = builtin_capture()
    rng = np.random.default_rng(draw(SEEDS))
    fitting = np.flatnonzero(capture.down.sum(axis=1) >= least)
    frame = int(rng.choice(fitting))
    fingers = rng.permutation(np.flatnonzero(capture.down[frame]))[:most]
    count = draw(st.integers(least, len(fingers)))
    ids = draw(st.lists(st.integers(0, 2**40), min_size=count, max_size=count, unique=True))
    xy = capture.xy[frame, fingers[:count]] + rng.normal(0, 0.003, (count, 2))
    return {i: (float(x), float(y)) for i, (x, y) in zip(ids, xy, strict=True)}


def moved(contacts: Contacts, rng: np.random.Generator) -> Contacts:
    step = rng.normal(0, 0.004, (len(contacts), 2))
    return {
        i: (x + dx, y + dy) for (i, (x, y)), (dx, dy) in zip(contacts.items(), step, strict=True)
    }


def marginals(belief: BeliefLabels) -> dict[int, np.ndarray]:
    """Probabilities (5,) of the fingers by contact id, after the last `assign`."""
    return _marginals(belief._ids, claimed(belief._belief, len(belief._ids)))


def table(belief: BeliefLabels, ids: list[int]) -> dict[tuple[int, ...], float]:
    """Believed probability of every labelling of the ids, in their order, after the last
    `assign`."""
    return _by_labels(belief, ids, belief._belief)


def claims_table(belief: BeliefLabels, ids: list[int]) -> dict[tuple[int, ...], float]:
    """Claimed probability of every labelling of the ids, without declared sets of fingers."""
    return _by_labels(belief, ids, claimed(belief._belief, len(ids)))


def _by_labels(
    belief: BeliefLabels, ids: list[int], log_probabilities: Array
) -> dict[tuple[int, ...], float]:
    places = [belief._ids.index(i) for i in ids]
    rows = zip(hypotheses(len(ids)).tolist(), np.exp(log_probabilities).tolist(), strict=True)
    return {tuple(labels[place] for place in places): share for labels, share in rows}


@given(touches(), st.data())
def test_probabilities_add_up_to_one_after_any_coming_and_going(
    contacts: Contacts, data: st.DataObject
) -> None:
    belief = new_belief()
    rng = np.random.default_rng(data.draw(SEEDS))
    for _ in range(4):
        shown = data.draw(st.lists(st.sampled_from(list(contacts)), min_size=1, unique=True))
        contacts = moved(contacts, rng)
        labelling = belief.assign({i: contacts[i] for i in shown}, {})
        assert sum(table(belief, shown).values()) == pytest.approx(1.0)
        assert marginals(belief).keys() == set(shown)
        for share in marginals(belief).values():
            assert share.shape == (5,)
            assert share.sum() == pytest.approx(1.0)
        assert len(set(labelling.labels.values())) == len(shown)
        assert 0.0 < labelling.probability <= 1.0


@given(touches(least=2), st.data())
def test_of_contacts_that_leave_the_labels_are_summed_out(
    contacts: Contacts, data: st.DataObject
) -> None:
    belief = new_belief()
    belief.assign(contacts, {})
    before = table(belief, list(contacts))
    stay = data.draw(
        st.lists(st.sampled_from(list(contacts)), min_size=1, max_size=len(contacts), unique=True)
    )
    belief.assign({i: contacts[i] for i in stay}, {})
    places = [list(contacts).index(i) for i in stay]
    for labels, probability in table(belief, stay).items():
        expected = sum(
            p
            for all_, p in before.items()
            if all(all_[at] == f for at, f in zip(places, labels, strict=True))
        )
        assert probability == pytest.approx(expected, abs=1e-9)


@given(touches(), st.floats(0.0, 0.0005), st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2)))
def test_trembling_and_moving_as_a_whole_say_no_more_than_one_look(
    contacts: Contacts, size: float, way: tuple[float, float]
) -> None:
    belief = new_belief()
    rng = np.random.default_rng(0)
    first = belief.assign(contacts, {})
    for step in range(20):
        dx, dy = step / 20 * way[0], step / 20 * way[1]
        again = belief.assign(
            {i: (x + dx + size * rng.uniform(-1, 1), y + dy) for i, (x, y) in contacts.items()}, {}
        )
        assert again.labels == first.labels
        assert again.probability == pytest.approx(first.probability)


@given(touches(least=2), st.data())
def test_an_id_that_is_given_anew_is_another_contact(
    contacts: Contacts, data: st.DataObject
) -> None:
    """Devices number their slots and use them again."""
    gone = data.draw(st.sampled_from(list(contacts)))
    stay = {i: place for i, place in contacts.items() if i != gone}
    other = max(contacts) + 1
    place = (contacts[gone][0] + 0.01, contacts[gone][1] - 0.03)
    same, new = new_belief(), new_belief()
    for belief, name in ((same, gone), (new, other)):
        belief.assign(contacts, {})
        belief.assign(stay, {})
        belief.assign({**stay, name: place}, {})
    assert marginals(new)[other] == pytest.approx(marginals(same)[gone])


@given(touches(least=2), st.data())
def test_fingers_that_join_unmoved_ones_leave_nothing_but_one_look_at_all(
    contacts: Contacts, data: st.DataObject
) -> None:
    """p(all | layout) is p(old | layout) times what the new ones say given the old."""
    first = data.draw(st.lists(st.sampled_from(list(contacts)), min_size=1, unique=True))
    joined, fresh = new_belief(), new_belief()
    joined.assign({i: contacts[i] for i in first}, {})
    joined.assign(contacts, {})
    fresh.assign(contacts, {})
    for i, share in marginals(fresh).items():
        assert marginals(joined)[i] == pytest.approx(share, abs=1e-3)


@given(touches(), st.data())
def test_order_ids_and_place_change_no_label_with_history(
    contacts: Contacts, data: st.DataObject
) -> None:
    first = data.draw(st.lists(st.sampled_from(list(contacts)), min_size=1, unique=True))
    order = data.draw(st.permutations(list(contacts)))
    other = dict(zip(contacts, order, strict=True))
    dx, dy = data.draw(st.tuples(st.floats(-0.2, 0.2), st.floats(-0.2, 0.2)))
    here, there = new_belief(), new_belief()
    here.assign({i: contacts[i] for i in first}, {})
    there.assign({other[i]: (contacts[i][0] + dx, contacts[i][1] + dy) for i in first[::-1]}, {})
    here.assign(contacts, {})
    there.assign({other[i]: (contacts[i][0] + dx, contacts[i][1] + dy) for i in order}, {})
    for i, share in marginals(here).items():
        assert marginals(there)[other[i]] == pytest.approx(share, abs=1e-3)


@given(touches(), st.data())
def test_fixed_labels_are_kept_but_do_not_change_what_is_believed(
    contacts: Contacts, data: st.DataObject
) -> None:
    some = data.draw(st.lists(st.sampled_from(list(contacts)), unique=True))
    fixed = dict(zip(some, data.draw(st.permutations(range(5))), strict=False))
    bound, free = new_belief(), new_belief()
    labelling = bound.assign(contacts, fixed)
    free.assign(contacts, {})
    assert fixed.items() <= labelling.labels.items()
    assert table(bound, list(contacts)) == table(free, list(contacts))
    best = max(
        (p, labels)
        for labels, p in claims_table(free, list(contacts)).items()
        if fixed.items() <= dict(zip(contacts, labels, strict=True)).items()
    )
    assert labelling.probability == pytest.approx(best[0])
    chances = marginals(free)
    for contact, finger in labelling.labels.items():
        assert labelling.label_probabilities[contact] == chances[contact][finger]


@given(touches(), touches())
def test_after_a_reset_nothing_is_left(before: Contacts, contacts: Contacts) -> None:
    used, new = new_belief(), new_belief()
    used.assign(before, {})
    used.reset()
    assert marginals(used) == {}
    assert used.assign(contacts, {}) == new.assign(contacts, {})


@given(arrays(float, 60, elements=st.floats(-30.0, 0.0)))
def test_claims_are_probabilities_in_the_order_of_the_belief_and_less_sure(weights: Array) -> None:
    belief = normalised(weights)
    claims = claimed(belief, 3)
    assert np.exp(claims).sum() == pytest.approx(1.0)
    assert (np.diff(claims[np.argsort(belief)]) >= 0.0).all()
    assert claims.max() <= belief.max() + 1e-12
