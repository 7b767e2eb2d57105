"""A person's time begins with their first touch, on the window's devices as on the page."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.devices.tuio.tuio import TuioDevice
from sandbox.devices.wrappers.playing import FirstTouch
from sandbox.play.window_play import _from_first_touch, _waiting
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.processes import PATIENCE, Sender
from tests.support.scripted import Played
from tests.support.tuio_packets import frame


def test_nothing_has_come_before_a_finger_is_down_and_then_all_of_it_is_there() -> None:
    mouse = MouseDevice(Surface())
    device = FirstTouch(mouse)
    assert not device.came()
    mouse.move((0.05, 0.05))
    assert not device.came()
    mouse.press((0.05, 0.05), pin=True)
    mouse.move((0.06, 0.05))
    assert device.came() and device.came()
    mouse.release()
    mouse.lift_fingers()
    frames = device.poll(0.0)
    assert [len(frame.contacts) for frame in frames] == [1, 1, 0]
    np.testing.assert_allclose([frames[0].contacts[0].x, frames[1].contacts[0].x], [0.05, 0.06])
    assert device.poll(0.0) == []
    assert device.came(), "a hand that was lifted has been there"


def test_what_a_device_said_before_the_first_touch_is_forgotten() -> None:
    finger = (Contact(1, 0.05, 0.05),)
    said = [TouchFrame(0.0, ()), TouchFrame(0.0, finger), TouchFrame(0.0, ())]
    device = FirstTouch(Played(said))
    assert device.came()
    assert list(device.poll(0.0)) == said[1:]


@pytest.mark.parametrize(
    "more", [{"vary": "latency=50"}, {"task": "carry-together", "surface": "400x200mm"}]
)
def test_time_begins_where_touches_come_late_or_two_hands_share_the_surface(
    more: dict[str, Any],
) -> None:
    chosen = trial_settings(TrialOptions(device="tuio", device_options={"port": 0}, **more))
    session = build(chosen, device_makers(chosen, _from_first_touch))
    tuio = session.first_rig.device.find(TuioDevice)
    assert tuio is not None
    with Sender(tuio.port) as send:
        assert _waiting(session) and _waiting(session)
        send(frame(1, {0: (0.5, 0.5)}))
        assert tuio.wait(PATIENCE)
        assert not _waiting(session)
        for _ in range(10):
            session.advance()
    seen = [contact for hand in session.snapshot().hands for contact in hand.contacts]
    assert len(seen) == 1
    session.close()
