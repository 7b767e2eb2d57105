"""Hands of headsets as public reports describe them: right, reported, or left out with reason."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import msgspec
import pytest

from models.frames import HandFrame
from sandbox.devices.webxr.webxr import HeadsetDevice
from sandbox.server.protocol import PageHands, PageScreen
from tests.encoders.air.joint_hands import joints

SCREEN = PageScreen(px_per_in=110.0, width_px=800.0, height_px=600.0, calibrated=False)
FRAMES = 60
STEP = 0.011
"""s, of a headset with 90 pictures a second."""

Hand = dict[str, Any]
Change = Callable[[int, dict[str, Any]], object]


@pytest.fixture
def played(monkeypatch: pytest.MonkeyPatch) -> Callable[..., tuple[HeadsetDevice, list[HandFrame]]]:
    """Plays a right hand that drifts by 1 mm a frame, each message changed."""
    clock = [time.monotonic()]
    monkeypatch.setattr(time, "monotonic", lambda: clock[0])

    def play(change: Change, frames: int = FRAMES) -> tuple[HeadsetDevice, list[HandFrame]]:
        device = HeadsetDevice()
        for n in range(frames):
            message = {"seq": n + 1, "t": None, "hands": [drifting(n)], "controllers": []}
            change(n, message)
            clock[0] += STEP
            device.receive(msgspec.convert(message, PageHands), SCREEN)
        return device, list(device.poll())

    return play


def drifting(n: int, side: str = "right") -> Hand:
    return moved(joints(1, side), 0.001 * n)


def moved(hand: Hand, right: float = 0.0, up: float = 0.0) -> Hand:
    """A hand at another place, m."""
    known = [j and [j[0] + right, j[1], j[2] + up] for j in hand["joints"]]
    return {**hand, "joints": known}


def away(n: int, message: dict[str, Any]) -> None:
    if n in (10, 40):
        message["hands"] = [moved(message["hands"][0], up=1.2)]


def elsewhere(n: int, message: dict[str, Any]) -> None:
    if n >= 30:
        message["hands"] = [moved(message["hands"][0], 0.8)]


def as_both_sides(n: int, message: dict[str, Any]) -> None:
    message["hands"].append({**message["hands"][0], "side": "left"})


def far_joint(n: int, message: dict[str, Any]) -> None:
    if n >= 40:
        message["hands"][0]["joints"][8] = [0.0, 0.0, 5.0]


REPORTS: dict[str, tuple[Change, Callable[[int], bool], str]] = {
    "a hand as it should be": (lambda n, message: None, lambda n: True, ""),
    # The idle hand at the origin, or at the head, for a moment: pmndrs/xr 273, WiVRn 385.
    "a hand that is elsewhere for a frame": (
        away,
        lambda n: n not in (10, 40),
        "left out: 2 hands that jump farther than a hand moves",
    ),
    # Hands that move on from where controllers were: ALVR 1725.
    "a hand that stays elsewhere": (
        elsewhere,
        lambda n: n != 30,
        "left out: 1 hands that jump farther than a hand moves",
    ),
    # The same hand as both sides.
    "a hand that is there as the other one too": (
        as_both_sides,
        lambda n: True,
        f"left out: {FRAMES} hands that lie on another one",
    ),
    "a joint that is five metres away": (
        far_joint,
        lambda n: True,
        f"left out: {FRAMES - 40} hands without a finger",
    ),
    # Hands that are turned inside out after they were lost: three.js 31634.
    "bent fingers of the other side": (
        lambda n, message: message.update(hands=[drifting(n, "left")]),
        lambda n: True,
        "the left hand is a right hand",
    ),
}


@pytest.mark.parametrize(("change", "shown", "report"), REPORTS.values(), ids=REPORTS)
def test_a_hand_is_shown_or_left_out_with_a_report(
    change: Change, shown: Callable[[int], bool], report: str, played: Any
) -> None:
    device, frames = played(change)
    assert [bool(frame.hands) for frame in frames] == [shown(n) for n in range(FRAMES)]
    assert all(len(frame.hands) <= 1 for frame in frames)
    assert report in device.report.line() and bool(report) == bool(device.report)


# A wrist that is never set: WebXR-emulator-extension 254.
def test_a_wrist_that_stays_at_the_origin_is_the_palm_of_no_hand(played: Any) -> None:
    def unset(n: int, message: dict[str, Any]) -> None:
        message["hands"] = [moved(message["hands"][0], up=0.7)]
        message["hands"][0]["joints"][0] = [0.0] * 3

    device, frames = played(unset)
    assert not frames[-1].hands
    assert "the distance from wrist to knuckles is impossible in any unit" in device.notices[0]
    assert "hands whose palm is of a size that no hand has" in device.report.line()


# A hand that was lost and stays: com.xrtk.oculus 141, STYLY-NetSync 474.
def test_a_hand_that_stands_still_in_every_digit_is_reported_but_a_controller_may(
    played: Any,
) -> None:
    device, _ = played(lambda n, message: message.update(hands=[drifting(min(n, 20))]), 200)
    assert "did not move in any digit for 1.9 s" in device.report.line()
    still = {"side": "right", "position": [0.1, 0.0, 0.1], "quaternion": [1.0, 0.0, 0.0, 0.0]}
    controllers = [{**still, "trigger": 0.0}]
    device, frames = played(lambda n, m: m.update(hands=[], controllers=controllers), 200)
    assert not device.report and all(frame.hands for frame in frames)


# A world in which a unit is a centimetre: Babylon.js 12441.
@pytest.mark.parametrize("unit", [10.0, 25.4, 100.0, 1000.0, 0.1, 1 / 25.4, 1e-3])
def test_a_world_in_another_unit_is_read_in_it_or_reported(unit: float, played: Any) -> None:
    def scaled(n: int, message: dict[str, Any]) -> None:
        hand = message["hands"][0]
        hand["joints"] = [joint and [unit * c for c in joint] for joint in hand["joints"]]

    device, frames = played(scaled)
    assert device.notices and device.report
    if unit == 100.0:
        assert "lengths are read in cm" in device.notices[0]
        true = played(lambda n, message: None)[1][-1].hands[0]
        assert frames[-1].hands[0].palm == pytest.approx(true.palm)
