"""Frames that `benchmarks.first_second` counts."""

from __future__ import annotations

import pytest

from benchmarks.first_second import FINGERS, WINDOW, Counts, share, trial

PERIOD = 0.016
"""s, the control period."""


@pytest.mark.parametrize(("task", "hands"), [("box-to-goal", 1), ("carry-together", 2)])
def test_every_hand_counts_for_one_second_from_its_first_touch_on(task: str, hands: int) -> None:
    counts = trial((task, 3, 4, "population"))
    frames = sum(counts.all.values())
    # Not with fewer than two fingers, which is short, as fingers come within 33 ms.
    assert hands * (WINDOW / PERIOD - 5) < frames <= hands * (WINDOW / PERIOD + 1)
    for count in FINGERS:
        assert 0 <= counts.right[count] <= counts.named[count] <= counts.all[count]
    unnamed = frames - sum(counts.named.values())
    assert unnamed >= hands * 0.1 / PERIOD - 1, "names wait for a tenth of a second"


def test_shares_are_of_named_frames_or_of_all() -> None:
    trials = []
    for right in (10, 20):
        counts = Counts()
        counts.right[2], counts.named[2], counts.all[2] = right, 20, 30
        trials.append(counts)
    assert share(trials, 2).startswith("75 [50, 100] of 40")
    assert share(trials, 2, of_all=True).startswith("50 [33, 67] of 60")
    assert share(trials, 3) == "-"
