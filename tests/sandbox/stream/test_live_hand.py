"""A live hand tells its newest pose, ends with its device, and says when the device fails."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pytest

from models.errors import DeviceError
from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.stream.hand_sources import LiveHand
from sandbox.trial.assembly import build
from sandbox.trial.settings import Settings
from tasks.task import Task
from tests.support.processes import until


class Moving(Device):
    """Three fingers that move to the right for a while, and then perhaps an error."""

    def __init__(self, seconds: float, fails: bool) -> None:
        self._seconds, self._fails = seconds, fails
        self._ended = False

    @property
    def finished(self) -> bool:
        return self._ended

    def poll(self, now: float) -> Sequence[TouchFrame]:
        if now > self._seconds:
            if self._fails:
                raise OSError("unplugged")
            self._ended = True
        places = ((0.05, 0.09), (0.06, 0.05), (0.085, 0.045))
        return [
            TouchFrame(now, tuple(Contact(i, x + 0.1 * now, y) for i, (x, y) in enumerate(places)))
        ]


def live(seconds: float, fails: bool = False) -> LiveHand:
    def open_device(task: Task, surface: Surface) -> Device:
        return Moving(seconds, fails)

    return LiveHand(build(Settings(), (open_device,)))


def test_it_follows_its_device_and_keeps_the_last_pose() -> None:
    hand = live(0.4)
    first = hand.pose()
    until(lambda: hand.over)
    last = hand.pose()
    assert first.shape == (48,) and not np.array_equal(first, last)
    hand.close()
    hand.close()
    assert np.array_equal(hand.pose(), last)


def test_a_device_that_fails_is_told_in_one_line() -> None:
    hand = live(0.05, fails=True)
    until(lambda: hand.over)
    with pytest.raises(DeviceError, match="the hand is lost") as error:
        hand.pose()
    assert "unplugged" in str(error.value) and "\n" not in str(error.value)
    hand.close()
