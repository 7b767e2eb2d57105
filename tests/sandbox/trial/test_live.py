"""A session with a person: what breaks in its own thread is heard of by who waits for it."""

from __future__ import annotations

import time
from collections.abc import Sequence

import pytest

from models.errors import DeviceError
from models.frames import TouchFrame
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.server.web import WebDevice
from sandbox.trial.assembly import build
from sandbox.trial.driver import Trial
from sandbox.trial.live import LiveTrial
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
