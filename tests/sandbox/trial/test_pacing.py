"""A step that nobody asked for is made out of the way of frame_ready that is expected."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from sandbox.trial.pacing import JITTER, ROOM, clear_of

moments = st.floats(0.0, 100.0)
near = st.floats(-0.1, 0.1)


@given(moments, near)
def test_a_tick_is_never_later_than_due_and_never_much_earlier(due: float, before: float) -> None:
    assert due - ROOM <= clear_of(due, due + before) <= due


@given(moments, near)
def test_no_tick_is_made_just_before_expected_news(due: float, before: float) -> None:
    expected = due + before
    free = expected - clear_of(due, expected)
    # The tiny part is what numbers of this size are rounded to.
    assert not 1e-9 < free < ROOM - JITTER - 1e-9


@given(moments)
def test_without_expectations_a_tick_comes_when_it_is_due(due: float) -> None:
    assert clear_of(due, float("inf")) == clear_of(due, float("-inf")) == due
