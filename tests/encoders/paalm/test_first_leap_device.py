"""The simulated first Leap is as the real recording shows that device."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np

from encoders.paalm.simulated.air import AirTake, simulate_air
from encoders.paalm.simulated.forward import (
    FROZEN_LEAP,
    QUANTILES,
    FirstSoftware,
    SeenHand,
    leap_take,
)
from tests.support.leap_hands import SHORT

STILL = replace(SHORT, open_seconds=1.0, seconds=0.1)


@cache
def held_open() -> tuple[AirTake, list[SeenHand]]:
    """An open hand that does not move, and 15,000 frames of it in 150 s."""
    hand = simulate_air(3, configuration=STILL)
    always = replace(FROZEN_LEAP, lost_rate=0.0, reversed_share=0.0, swapped=0.0)
    device = FirstSoftware(np.random.default_rng(3), always)
    place = hand.origin[0], hand.rotation[0], hand.joints[0]
    return hand, [device.see(0.01, *place) for _ in range(15_000)]


def test_of_a_still_finger_more_or_less_is_seen_up_to_a_tip_that_stays() -> None:
    hand, seen = held_open()
    lengths = np.array([s.lengths for s in seen])[:, 1:]
    whole = np.percentile(lengths, 99, axis=0)
    found = np.percentile(lengths / whole, [5, 25, 50], axis=0).mean(axis=1)
    wanted = np.interp([0.05, 0.25, 0.5], QUANTILES, FROZEN_LEAP.seen)
    np.testing.assert_allclose(found, wanted, atol=0.06)
    tips = hand.origin[0] + hand.joints[0, :, 3] @ hand.rotation[0].T
    assert np.abs(np.array([s.tips for s in seen]) - tips).max() < 0.0002


def test_seen_lengths_change_as_slowly_as_real_ones_and_together() -> None:
    lengths = np.array([s.lengths for s in held_open()[1]])[:, 1:]
    # The real recording has 0.88, 0.67 and 0.31.
    for lag, real in ((10, 0.88), (20, 0.67), (40, 0.31)):
        found = [np.corrcoef(x[:-lag], x[lag:])[0, 1] for x in lengths.T]
        assert abs(np.mean(found) - real) < 0.1
    assert 0.3 < np.corrcoef(lengths.T)[np.triu_indices(4, 1)].mean() < 0.6


def test_the_same_seed_is_the_same_device() -> None:
    hand = simulate_air(1, configuration=STILL)
    assert leap_take(hand, 5).frames == leap_take(hand, 5).frames != leap_take(hand, 6).frames
