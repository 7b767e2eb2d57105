"""A trial with a person keeps real time, and reports what breaks in its own thread."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import DeviceError
from models.frames import TouchFrame
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.tuio.tuio import TuioDevice
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import PageScreen, PageTouches, Pause
from sandbox.server.web import WebDevice
from sandbox.session.messages import Snapshot
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.driver import JITTER, ROOM, LiveRun, Trial, clear_of
from sandbox.trial.logs import LatencyLog, Timing, timed
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.page_client import SCREEN
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
    live = LiveRun(Trial(session))
    assert not live.over and live.failure is None
    live.start()
    until(lambda: live.over)
    live.stop()
    assert live.failure is error and not session.over


def test_a_touch_from_before_time_went_on_is_none_that_waited_for_a_step() -> None:
    latency = LatencyLog()
    makers = (timed(lambda _task, surface: WebDevice(surface), Timing(latency)),)
    session = build(Settings(), makers)
    live = LiveRun(Trial(session))
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


def test_a_run_ends_at_once_where_its_turn_ends_it_and_its_end_comes_once() -> None:
    session = build(Settings(), (lambda _task, surface: WebDevice(surface),))
    live, ended = LiveRun(Trial(session)), list[float]()
    live.play(lambda: None, lambda: ended.append(session.time))
    assert ended == [0.0] and live.newest is None


def test_time_stands_still_while_a_turn_gives_a_reason_and_pages_show_the_last_one() -> None:
    session = build(Settings(), (lambda _task, surface: WebDevice(surface),))
    server, reasons = PageServer(), iter(["start", "start", "", "menu", None])
    times, shown = list[float](), list[str]()
    publish = server.publish

    def noted(snapshot: Snapshot, pause: Pause = "") -> None:
        shown.append(pause)
        publish(snapshot, pause)

    server.publish = noted  # type: ignore[method-assign]

    def turn() -> Any:
        times.append(session.time)
        if len(times) == 4:
            until(lambda: session.time > 0.0)
        return next(reasons)

    LiveRun(Trial(session), [server]).play(turn)
    server.close()
    assert times[:3] == [0.0, 0.0, 0.0]
    assert shown == ["start", "start", "menu", ""]


def test_a_picture_lingers_after_the_end_but_not_after_a_failure() -> None:
    def breaks(_task: object, _surface: Surface) -> Breaking:
        return Breaking(DeviceError("unplugged"))

    session, ended = build(Settings(), (breaks,)), list[bool]()
    with pytest.raises(DeviceError, match="unplugged"):
        LiveRun(Trial(session)).play(lambda: "", lambda: ended.append(True), lingers=True)
    assert ended == [True]


def test_a_frame_of_any_hand_wakes_the_run() -> None:
    port = {"port": 0}
    chosen = trial_settings(
        TrialOptions(task="carry-together", device="tuio", second_device="web", device_options=port)
    )
    session = build(chosen, device_makers(chosen))
    LiveRun(Trial(session))
    first, second = (rig.device for rig in session.rigs)
    tuio, web = first.find(TuioDevice), second.find(WebDevice)
    assert tuio is not None and web is not None
    assert not tuio.frame_ready.is_set()
    web.receive(PageTouches(1, 0.0, [(1, 300.0, 300.0, 20.0, 20.0)]), PageScreen(**SCREEN))
    assert tuio.frame_ready.is_set()
    session.close()
