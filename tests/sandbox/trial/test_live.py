"""A trial with a person keeps real time, and reports what breaks in its own thread."""

from __future__ import annotations

import time
from collections.abc import Sequence

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import DeviceError
from models.frames import TouchFrame
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.server.web import WebDevice
from sandbox.trial.assembly import build
from sandbox.trial.driver import Trial
from sandbox.trial.live import JITTER, ROOM, LiveTrial, clear_of
from sandbox.trial.settings import Settings
from tests.support.processes import until


class Breaking(Device):
    """A device that breaks once it was asked some times.

    Args:
        error: How.
    """

    name = "breaking"
    finished = False

    def __init__(self, error: Exception) -> None:
        self._error, self._asked = error, 0

    def poll(self, now: float) -> Sequence[TouchFrame]:
        self._asked += 1
        if self._asked > 5:
            raise self._error
        return []

    def close(self) -> None:
        self.finished = True


@pytest.mark.parametrize("error", [DeviceError("unplugged"), ZeroDivisionError("somebody's code")])
def test_a_device_that_breaks_ends_the_session_and_is_no_trial_that_was_played(
    error: Exception,
) -> None:
    def breaks(_task: object, _surface: Surface) -> Breaking:
        return Breaking(error)

    session = build(Settings(), (breaks,))
    live = LiveTrial(Trial(session))
    assert not live.over and live.failure is None
    live.start()
    until(lambda: live.over)
    live.stop()
    assert live.failure is error and not session.over


def test_a_touch_from_before_time_went_on_is_none_that_waited_for_a_step() -> None:
    session = build(Settings(), (lambda _task, surface: WebDevice(surface),))
    latency = session.first_rig.device.latency
    assert latency is not None
    live = LiveTrial(Trial(session))
    live.pause(True)
    live.start()
    before = time.monotonic()
    live.pause(False)
    until(lambda: session.time > 0.0)
    live.stop()
    latency.take_in(before, before + 60.0)
    assert latency.percentiles() == {}


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
