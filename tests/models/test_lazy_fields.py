"""Fields that are worked out when somebody looks, and pictures that nobody has looked at yet."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from models.lazy_fields import LazyFields
from sandbox.trial.assembly import build
from sandbox.trial.open_devices import device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings


@dataclass(frozen=True)
class Place(LazyFields):
    x: float
    y: float
    name: str = "here"


def test_fields_that_nobody_reads_are_never_computed() -> None:
    def compute() -> dict[str, float]:
        raise AssertionError("somebody looked")

    place = Place.deferred(compute, x=1.0)
    assert (place.x, place.name) == (1.0, "here")
    with pytest.raises(AssertionError, match="somebody looked"):
        _ = place.y


def test_a_field_is_computed_once_and_kept() -> None:
    calls = []
    place = Place.deferred(lambda: calls.append(1) or {"y": 2.0}, x=1.0)
    assert (place.y, place.y, len(calls)) == (2.0, 2.0, 1)


def test_an_object_with_lazy_fields_is_like_any_other() -> None:
    late = Place.deferred(lambda: {"y": 2.0}, x=1.0)
    assert late == Place(1.0, 2.0)
    assert replace(Place.deferred(lambda: {"y": 2.0}, x=1.0), x=3.0) == Place(3.0, 2.0)
    assert repr(Place.deferred(lambda: {"y": 2.0}, x=1.0)) == "Place(x=1.0, y=2.0, name='here')"


@pytest.mark.parametrize("name", ["z", "_work", "__len__"])
def test_an_unknown_attribute_is_an_attribute_error(name: str) -> None:
    place = Place.deferred(lambda: {"y": 2.0}, x=1.0)
    assert not hasattr(place, name)
    assert not hasattr(Place(1.0, 2.0), name)


def test_a_field_that_the_function_does_not_return_is_an_attribute_error() -> None:
    with pytest.raises(AttributeError, match="Place has no y"):
        _ = Place.deferred(dict, x=1.0).y


def test_a_snapshot_shows_its_own_moment_whenever_it_is_looked_at() -> None:
    chosen = trial_settings(TrialOptions(seed=1))
    session = build(chosen, device_makers(chosen))
    show = session.rigs[0].device.show
    while not session.solid(0):
        show(session.advance())
    looked_at, later = session.snapshot(), session.snapshot()
    hand, box = looked_at.hands[0], looked_at.objects["box"]
    for _ in range(60):
        show(session.advance())
    assert not np.array_equal(session.snapshot().objects["box"].position, box.position)
    np.testing.assert_array_equal(later.hands[0].tips, hand.tips)
    np.testing.assert_array_equal(later.hands[0].target, hand.target)
    assert (later.hands[0].solid, later.hands[0].phase) == (hand.solid, hand.phase)
    assert hand.contacts and len(later.hands[0].contacts) == len(hand.contacts)
    for a, b in zip(later.hands[0].contacts, hand.contacts, strict=True):
        assert (a.id, a.label, a.state) == (b.id, b.label, b.state)
        np.testing.assert_array_equal(a.position, b.position)
    np.testing.assert_array_equal(later.objects["box"].position, box.position)
    np.testing.assert_array_equal(later.objects["box"].rotation, box.rotation)
    assert later.goals == looked_at.goals
