"""A sight is computed at the first look, and once."""

from dataclasses import fields

import numpy as np
import pytest

from tasks.user import LateSight, Sight


def sight() -> Sight:
    return Sight(1.5, {3: np.arange(3.0)}, True, {}, (), False)


def test_a_sight_that_nobody_looks_at_is_never_computed() -> None:
    def compute() -> Sight:
        raise AssertionError("somebody looked")

    late = LateSight.of(1.5, compute)
    assert late.time == 1.5
    with pytest.raises(AssertionError, match="somebody looked"):
        _ = late.tips


def test_a_late_sight_shows_the_same_and_is_computed_once() -> None:
    computed = []

    def compute() -> Sight:
        computed.append(sight())
        return computed[-1]

    late = LateSight.of(1.5, compute)
    for field in fields(Sight):
        assert getattr(late, field.name) is getattr(late, field.name)
        assert field.name == "time" or getattr(late, field.name) is getattr(computed[0], field.name)
    assert len(computed) == 1
