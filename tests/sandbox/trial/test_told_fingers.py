"""A device that names fingers is believed by the hand: from TUIO 2.0 packets to the session."""

from __future__ import annotations

import pytest

from sandbox.devices.tuio.touch_capture import CaptureDevice, CapturedPacket, TouchCapture
from sandbox.trial.assembly import build
from sandbox.trial.settings import Settings
from tests.support.tuio_packets import alv, bundle, frm, ptr

PLACES = ((0.35, 0.65), (0.42, 0.4), (0.5, 0.36), (0.58, 0.38))
"""Thumb to ring finger of a right hand in the middle of the surface."""

TYPES = (5, 1, 2, 3, 4)
"""Of pointers, by finger."""


@pytest.mark.parametrize("fingers", [(0, 1, 2, 3), (0, 1, 3, 4), (1, 2, 3, 4)])
def test_the_names_that_a_device_gives_are_those_of_the_hand(fingers: tuple[int, ...]) -> None:
    packets = [
        bundle(
            frm(n + 1),
            *(ptr(i, *PLACES[i], kind=TYPES[finger]) for i, finger in enumerate(fingers)),
            alv(*range(len(fingers))),
        )
        for n in range(60)
    ]
    capture = TouchCapture(tuple(CapturedPacket(n / 60, p) for n, p in enumerate(packets)))
    session = build(Settings(), (lambda task, surface: CaptureDevice(capture, surface),))
    try:
        while session.time < 0.9:
            snapshot = session.advance()
        named = {c.id: c.label for c in snapshot.hands[0].contacts}
    finally:
        session.close()
    assert named == dict(enumerate(fingers))
