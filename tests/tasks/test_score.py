"""A trial is won by holding the goal without a break, and what was won stays won."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from models.scene import CONTROL_PERIOD
from models.surface import Surface
from tasks.box_to_goal import BoxToGoal
from tasks.score import AFTERMATH, Score, Scorer, Status, points
from tasks.task import Measure

TASK = BoxToGoal.draw(0, Surface())
HOLD, LIMIT = TASK.hold_time, TASK.time_limit

REACHED = Measure(True, 1.0, "")
MISSED = Measure(False, 0.4, "the box is 38 mm from the goal")

HOLD_STEPS = round(HOLD / CONTROL_PERIOD) + 1
AFTERMATH_STEPS = round(AFTERMATH / CONTROL_PERIOD) + 1


def play(steps: list[bool], dt: float = CONTROL_PERIOD) -> Scorer:
    """A scorer that has seen the goal reached, or not, at one control step after another."""
    scorer = Scorer(TASK)
    for i, reached in enumerate(steps, start=1):
        scorer.update(i * dt, REACHED if reached else MISSED)
    return scorer


def longest_hold(steps: list[bool], dt: float) -> float:
    """s from the first to the last step of the longest unbroken run in which it was reached."""
    runs = "".join("x" if reached else " " for reached in steps).split()
    return max((len(run) - 1 for run in runs), default=-1) * dt


def stretches(longest: int) -> st.SearchStrategy[list[bool]]:
    """Steps in stretches of reached and missed, none of them longer than so many."""
    stretch = st.tuples(st.booleans(), st.integers(1, longest))
    return st.lists(stretch, max_size=12).map(
        lambda parts: [reached for reached, n in parts for _ in range(n)]
    )


@given(steps=stretches(140), dt=st.sampled_from([0.004, 0.008, CONTROL_PERIOD]))
def test_held_means_reached_for_the_hold_time_without_a_break(steps: list[bool], dt: float) -> None:
    scorer = play(steps, dt)
    seen = steps
    if scorer.over and scorer.score.status is Status.HELD:
        # What comes after the end is not looked at.
        seen = steps[: math.ceil((scorer.score.time + AFTERMATH) / dt - 1e-4)]
    assert scorer.score.held == (longest_hold(seen, dt) >= HOLD - 1e-6)
    assert scorer.score.success == scorer.score.held
    assert scorer.score.instant == any(seen)
    assert scorer.score.final == (bool(seen) and seen[-1])


def test_the_trial_runs_one_second_longer_and_reports_the_final_state() -> None:
    lasting = play([True] * (HOLD_STEPS + 1 + AFTERMATH_STEPS))
    held: Any = pytest.approx((1 + HOLD_STEPS) * CONTROL_PERIOD)
    assert lasting.score == Score(True, True, True, Status.HELD, 1.0, "", held)
    short = play([True] * (HOLD_STEPS + 1) + [True] * (AFTERMATH_STEPS - 2))
    assert not short.over
    toppled = play([True] * (HOLD_STEPS + 1) + [False] * AFTERMATH_STEPS)
    assert toppled.over
    assert (toppled.score.held, toppled.score.final) == (True, False)
    assert toppled.score.status is Status.HELD
    assert toppled.score.reason == MISSED.reason
    assert toppled.score.progress == MISSED.progress


def test_a_trial_that_is_never_held_ends_at_its_time_limit() -> None:
    steps = round(LIMIT / CONTROL_PERIOD)
    assert not play([False] * (steps - 1)).over
    scorer = play([False] * (steps + 1))
    assert scorer.score.status is Status.TIMEOUT
    assert scorer.score.time == pytest.approx(LIMIT, abs=CONTROL_PERIOD)
    assert scorer.score.reason == MISSED.reason
    assert not scorer.score.success


def test_a_hold_in_the_last_second_still_gets_its_second_of_aftermath() -> None:
    steps = round(LIMIT / CONTROL_PERIOD)
    scorer = play([False] * (steps - HOLD_STEPS - 5) + [True] * (HOLD_STEPS + 20))
    assert scorer.score.held
    assert not scorer.over
    scorer = play([False] * (steps - HOLD_STEPS - 5) + [True] * (HOLD_STEPS + 100))
    assert scorer.score.status is Status.HELD


LOST = Measure(False, 0.2, "it is spoiled", lost=True)


def test_an_irreversible_failure_ends_a_trial_at_once() -> None:
    scorer = play([True] * 3)
    scorer.update(4 * CONTROL_PERIOD, LOST)
    assert (scorer.score.status, scorer.score.reason) == (Status.FAILED, LOST.reason)
    assert scorer.score.instant and not scorer.score.success


def test_a_success_is_not_lost_afterwards() -> None:
    scorer = play([True] * (HOLD_STEPS + 1))
    scorer.update((HOLD_STEPS + 2) * CONTROL_PERIOD, LOST)
    assert scorer.score.success and not scorer.over


ended = st.sampled_from([Status.DIVERGED, Status.INPUT_ENDED])


@given(steps=stretches(45), status=ended)
def test_an_abort_keeps_an_earlier_success(steps: list[bool], status: Status) -> None:
    scorer = play(steps)
    before = scorer.score
    after = scorer.abort(status, "the tablet was unplugged")
    assert scorer.over
    assert (after.instant, after.held, after.final) == (before.instant, before.held, before.final)
    assert (after.progress, after.time) == (before.progress, before.time)
    if before.held:
        assert (after.status, after.reason) == (Status.HELD, before.reason)
    elif before.status is Status.RUNNING:
        assert (after.status, after.reason) == (status, "the tablet was unplugged")


@given(steps=stretches(45), later=stretches(45), status=ended)
def test_nothing_changes_a_trial_that_is_over(
    steps: list[bool], later: list[bool], status: Status
) -> None:
    scorer = play(steps)
    result = scorer.abort(status, "the tablet was unplugged")
    for i, reached in enumerate(later):
        scorer.update(100.0 + i, REACHED if reached else MISSED)
    assert scorer.abort(Status.INPUT_ENDED, "again") == result
    assert scorer.score == result


@given(st.floats(0.0, 1.0), st.floats(0.0, 60.0), st.floats(0.0, 60.0))
def test_every_success_has_more_points_than_any_failure_and_sooner_is_better(
    progress: float, one: float, other: float
) -> None:
    sooner, later = sorted((one, other))
    assert 100.0 >= points(True, 1.0, sooner, 60.0) >= points(True, 1.0, later, 60.0) >= 50.0
    assert 50.0 >= points(False, progress, one, 60.0) >= 0.0
    assert points(False, progress, one, 60.0) >= points(False, progress / 2, other, 60.0)


@given(first=stretches(80), then=stretches(80))
@example(first=33 * [True], then=33 * [True])
def test_what_has_to_be_held_first_is_held_before_the_goal_counts(
    first: list[bool], then: list[bool]
) -> None:
    scorer, begun, dt = Scorer(TASK), False, CONTROL_PERIOD
    lying = Measure(True, 0.0, "")
    for i, (rests, reached) in enumerate(zip(first, then, strict=False), start=1):
        goal = REACHED if reached else MISSED
        score = scorer.update(i * dt, replace(goal, first=replace(lying, reached=rests)))
        if not begun:
            assert not score.instant and score.progress == 0.0
        begun = begun or longest_hold(first[:i], dt) >= HOLD - 1e-6
    ends = range(len(first) + 1)
    moment = next((i for i in ends if longest_hold(first[:i], dt) >= HOLD - 1e-6), 0)
    counted = then[moment : len(first)] if begun else []
    held = longest_hold(counted, dt) >= HOLD - 1e-6
    assert scorer.score.held == held


def test_what_is_lost_in_the_first_phase_ends_the_trial() -> None:
    scorer = Scorer(TASK)
    scorer.update(0.1, replace(MISSED, first=Measure(False, 0.0, "the key fell", lost=True)))
    assert (scorer.score.status, scorer.score.reason) == (Status.FAILED, "the key fell")


def test_without_a_hold_time_a_goal_is_held_once_it_is_reached_and_not_before() -> None:
    class AtOnce(BoxToGoal):
        hold_time = 0.0

    scorer = Scorer(AtOnce.draw(0, Surface()))
    assert not scorer.update(0.016, MISSED).held
    assert not scorer.update(0.032, Measure(False, 1.0, "", first=MISSED)).held
    assert scorer.update(0.048, REACHED).held
