"""The simulated first Leap is as real recordings show that device."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from encoders.paalm.palm import palm_of
from encoders.paalm.simulated.air import AirTake, simulate_air
from encoders.paalm.simulated.forward import (
    FROZEN_LEAP,
    QUANTILES,
    FirstSoftware,
    LeapConfiguration,
    SeenHand,
    leap_take,
)
from tests.support.leap_hands import SHORT, real_take

STILL = replace(SHORT, open_seconds=1.0, seconds=0.1)
ALWAYS = replace(FROZEN_LEAP, lost_rate=0.0, reversed_share=0.0, swapped=0.0)


@cache
def held_open(
    seconds: float, configuration: LeapConfiguration = ALWAYS, seed: int = 3
) -> tuple[AirTake, list[SeenHand]]:
    """What the device says of one open hand that does not move, 100 times a second."""
    hand = simulate_air(seed, configuration=STILL)
    device = FirstSoftware(np.random.default_rng(seed), configuration)
    return hand, [
        device.see(0.01, hand.origin[0], hand.rotation[0], hand.joints[0])
        for _ in range(round(100 * seconds))
    ]


def test_of_a_finger_that_stands_still_more_or_less_is_seen() -> None:
    hand, seen = held_open(150.0)
    lengths = np.array([s.lengths for s in seen])[:, 1:]
    whole = np.percentile(lengths, 99, axis=0)
    found = np.percentile(lengths / whole, [5, 25, 50], axis=0)
    wanted = np.interp([0.05, 0.25, 0.5], QUANTILES, FROZEN_LEAP.seen)
    np.testing.assert_allclose(found.mean(axis=1), wanted, atol=0.06)
    # Its tip stays where it is, and its direction says nothing about the length.
    tips = np.array([s.tips for s in seen])
    truth = hand.origin[0] + hand.joints[0, :, 3] @ hand.rotation[0].T
    assert np.abs(tips - truth).max() < 0.0002
    along = np.array([(s.along @ hand.rotation[0])[1:] for s in seen])
    flexion = np.degrees(np.arctan2(-along[..., 2], along[..., 1]))
    for finger in range(4):
        little = lengths[:, finger] < 0.7 * whole[finger]
        apart = flexion[little, finger].mean() - flexion[~little, finger].mean()
        assert abs(apart) < 2.5


def test_lengths_change_as_slowly_as_real_ones_and_together() -> None:
    _, seen = held_open(150.0)
    lengths = np.array([s.lengths for s in seen])[:, 1:]
    later = {
        lag: np.mean([np.corrcoef(x[:-lag], x[lag:])[0, 1] for x in lengths.T])
        for lag in (10, 20, 40)
    }
    # In the real recording: 0.88, 0.67 and 0.31.
    np.testing.assert_allclose(list(later.values()), [0.88, 0.67, 0.31], atol=0.1)
    together = np.corrcoef(lengths.T)[np.triu_indices(4, 1)]
    assert 0.3 < together.mean() < 0.6


@pytest.mark.parametrize("side", ["right", "left"])
def test_a_mirrored_hand_is_seen_in_a_mirror(side: str) -> None:
    one = real_take(2, side=side)
    for frame in one.frames[40:400:30]:
        (hand,) = frame.hands
        assert hand.side is None
        palm = palm_of(hand, side)
        places = {
            one.fingers[one.frames.index(frame)][f.id]: palm.place(f.tip)[0] for f in hand.fingers
        }
        across = [places[name] for name in sorted(places)]
        assert across == sorted(across) or not one.open[one.frames.index(frame)]


def test_the_same_seed_is_the_same_device() -> None:
    hand = simulate_air(1, configuration=STILL)
    assert leap_take(hand, 5).frames == leap_take(hand, 5).frames
    assert leap_take(hand, 5).frames != leap_take(hand, 6).frames
