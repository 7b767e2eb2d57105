"""Fingers that a person declares are the only ones that labels name, in the declared proportion."""

from __future__ import annotations

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from encoders.labels.labelling import finger_sets, odds_of_first, odds_of_sets, parse_finger_sets
from encoders.labels.pair_network import USUAL_SETS
from models.errors import InputError
from models.frames import FINGERS
from sandbox.trial.settings import PipelineSettings
from tests.encoders.labels.test_belief import Contacts, claims_table, new_belief, touches

SETS = [each for count in range(1, 6) for each in finger_sets(count)]
ANY_SETS = st.dictionaries(st.sampled_from(SETS), st.floats(0.01, 100.0), min_size=1, max_size=6)


def text_of(sets: dict[tuple[int, ...], float]) -> str:
    names = ["+".join(FINGERS[f] for f in fingers) for fingers in sets]
    return ", ".join(f"{a}:{w!r}" for a, w in zip(names, sets.values(), strict=True))


@given(ANY_SETS)
def test_a_text_of_sets_is_read_as_written(sets: dict[tuple[int, ...], float]) -> None:
    assert parse_finger_sets(text_of(sets)) == sets


@given(touches(), st.integers(3, 5))
def test_a_hand_with_fewer_fingers_gets_only_their_names_in_proportion_to_the_belief(
    contacts: Contacts, fingers: int
) -> None:
    whole, fewer = new_belief(), new_belief()
    fewer.odds = odds_of_first(fingers)
    free, labelling = whole.assign(contacts, {}), fewer.assign(contacts, {})
    if not len(contacts) <= fingers < 5:
        assert (labelling.labels, labelling.probability) == (free.labels, free.probability)
    else:
        claims = claims_table(whole, list(contacts))
        shares = {labels: share for labels, share in claims.items() if max(labels) < fingers}
        best = max(shares, key=lambda labels: shares[labels])
        assert tuple(labelling.labels[i] for i in contacts) == best
        assert labelling.probability == pytest.approx(shares[best] / sum(shares.values()))


@given(touches(), ANY_SETS)
def test_labels_are_parts_of_a_declared_set_unless_more_fingers_touch_than_any_set_has(
    contacts: Contacts, sets: dict[tuple[int, ...], float]
) -> None:
    belief, undeclared = new_belief(), new_belief()
    belief.odds = odds_of_sets(sets, USUAL_SETS)
    labelling, free = belief.assign(contacts, {}), undeclared.assign(contacts, {})
    named = set(labelling.labels.values())
    if len(contacts) > max(len(fingers) for fingers in sets):
        assert (labelling.labels, labelling.probability) == (free.labels, free.probability)
    else:
        assert any(named <= set(fingers) for fingers in sets)
    assert 0.0 < labelling.probability <= 1.0 + 1e-12


@given(touches(least=2, most=4), st.data())
def test_a_set_that_is_used_more_often_gains_by_that_factor(
    contacts: Contacts, data: st.DataObject
) -> None:
    count = len(contacts)
    two = data.draw(st.lists(st.sampled_from(finger_sets(count)), min_size=2, max_size=2))
    assume(two[0] != two[1])
    factor = data.draw(st.floats(0.1, 10.0))
    shares = []
    for weight in (1.0, factor):
        belief = new_belief()
        belief.odds = odds_of_sets({two[0]: weight, two[1]: 1.0}, USUAL_SETS)
        chances = belief.assign(contacts, {}).chances
        assert chances is not None
        # A finger that only the first set has shows the share of that set.
        only = (set(two[0]) - set(two[1])).pop()
        shares.append(sum(float(chance[only]) for chance in chances().values()))
    before, after = shares
    assume(1e-6 < before < 1.0 - 1e-6)
    assert after / (1.0 - after) == pytest.approx(factor * before / (1.0 - before), rel=1e-6)


@given(touches(least=2, most=4))
def test_with_all_sets_in_their_usual_proportion_nothing_changes(contacts: Contacts) -> None:
    count = len(contacts)
    usual = {each: USUAL_SETS.get(each, 1.0) for each in finger_sets(count)}
    belief, undeclared = new_belief(), new_belief()
    belief.odds = odds_of_sets(usual, USUAL_SETS)
    labelling, free = belief.assign(contacts, {}), undeclared.assign(contacts, {})
    assert labelling.labels == free.labels
    assert labelling.probability == pytest.approx(free.probability)


@pytest.mark.parametrize(
    "text",
    [
        "thumb+indx",
        "thumb+thumb",
        "thumb+index,index+thumb",
        "thumb:often",
        "thumb:0",
        "thumb:nan",
        "thumb,",
    ],
)
def test_a_wrong_set_is_refused_where_it_is_written(text: str) -> None:
    with pytest.raises(InputError) as error:
        PipelineSettings(finger_sets=text)
    assert error.value.where == "finger_sets"


def test_the_papers_labels_take_no_finger_sets() -> None:
    with pytest.raises(InputError, match="finger-sets"):
        PipelineSettings(finger_sets="thumb+index", labels="paper")
