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


def played(
    change: Change, monkeypatch: pytest.MonkeyPatch, frames: int = FRAMES
) -> tuple[HeadsetDevice, list[HandFrame]]:
    """A device after a right hand that drifts by 1 mm a frame, each message changed."""
    device, clock = HeadsetDevice(), [time.monotonic()]
    monkeypatch.setattr(time, "monotonic", lambda: clock[0])
    for n in range(frames):
        message = {"seq": n + 1, "t": None, "hands": [drifting(n)], "controllers": []}
        change(n, message)
        clock[0] += STEP
        device.receive(msgspec.convert(message, PageHands), SCREEN)
    return device, list(device.poll())


def drifting(n: int, side: str = "right", seed: int = 1) -> Hand:
    return moved(joints(seed, side), 0.001 * n)


def moved(hand: Hand, right: float = 0.0, up: float = 0.0) -> Hand:
    """A hand at another place, m."""
    known = [j and [j[0] + right, j[1], j[2] + up] for j in hand["joints"]]
    return {**hand, "joints": known}


def test_a_hand_as_it_should_be_has_no_report(monkeypatch: pytest.MonkeyPatch) -> None:
    device, frames = played(lambda n, message: None, monkeypatch)
    assert not device.report and len(frames) == FRAMES and all(f.hands for f in frames)


# The idle hand at the origin, or at the head, for a moment: pmndrs/xr 273, WiVRn 385.
def test_a_hand_that_is_elsewhere_for_a_frame_is_left_out_of_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def away(n: int, message: dict[str, Any]) -> None:
        if n in (10, 40):
            message["hands"] = [moved(message["hands"][0], up=1.2)]

    device, frames = played(away, monkeypatch)
    assert [n for n, frame in enumerate(frames) if not frame.hands] == [10, 40]
    assert device.report.line() == "left out: 2 hands that jump farther than a hand moves"


# Hands that move on from where controllers were: ALVR 1725.
def test_a_hand_that_stays_elsewhere_is_believed_from_its_next_frame_on(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def moves(n: int, message: dict[str, Any]) -> None:
        if n >= 30:
            message["hands"] = [moved(message["hands"][0], 0.8)]

    _, frames = played(moves, monkeypatch)
    assert [n for n, frame in enumerate(frames) if not frame.hands] == [30]


# A hand that was lost and stays: com.xrtk.oculus 141, STYLY-NetSync 474.
def test_a_hand_that_stands_still_in_every_digit_is_reported(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    device, _ = played(
        lambda n, message: message.update(hands=[drifting(min(n, 20))]), monkeypatch, 200
    )
    assert "did not move in any digit for 1.9 s" in device.report.line()


def test_a_controller_may_lie_still(monkeypatch: pytest.MonkeyPatch) -> None:
    held = {
        "side": "right",
        "position": [0.1, 0.0, 0.1],
        "quaternion": [1.0, 0.0, 0.0, 0.0],
        "trigger": 0.0,
    }
    device, frames = played(
        lambda n, message: message.update(hands=[], controllers=[held]), monkeypatch, 200
    )
    assert not device.report and all(frame.hands for frame in frames)


# The same hand as both sides.
def test_a_hand_that_is_there_as_the_other_one_too_is_one_hand(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def again(n: int, message: dict[str, Any]) -> None:
        message["hands"].append({**message["hands"][0], "side": "left"})

    device, frames = played(again, monkeypatch)
    assert all([hand.side for hand in frame.hands] == ["right"] for frame in frames)
    assert device.report.left_out == {"hands that lie on another one": FRAMES}


# A wrist that is never set: WebXR-emulator-extension 254.
def test_a_wrist_that_stays_at_the_origin_is_the_palm_of_no_hand(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def unset(n: int, message: dict[str, Any]) -> None:
        message["hands"] = [moved(message["hands"][0], up=0.7)]
        message["hands"][0]["joints"][0] = [0.0] * 3

    device, frames = played(unset, monkeypatch)
    assert not frames[-1].hands
    assert "the distance from wrist to knuckles is impossible in any unit" in device.notices[0]
    assert "hands whose palm is of a size that no hand has" in device.report.line()


# Single joints that are lost: webxr-hand-input 91 and 60.
@pytest.mark.parametrize("place", [[0.0, 0.0, 5.0], None])
def test_a_joint_that_is_nowhere_costs_its_finger_alone(
    place: list[float] | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    def lost(n: int, message: dict[str, Any]) -> None:
        if n >= 40:
            message["hands"][0]["joints"][8] = place

    device, frames = played(lost, monkeypatch)
    (hand,) = frames[-1].hands
    assert [finger.finger for finger in hand.fingers] == [0, 2, 3, 4]
    assert device.report.left_out == {"hands without a finger": FRAMES - 40}


# Hands that are turned inside out after they were lost: three.js 31634.
def test_a_hand_whose_fingers_bend_to_its_back_is_doubted(monkeypatch: pytest.MonkeyPatch) -> None:
    def bent(n: int, message: dict[str, Any]) -> None:
        message["hands"] = [{**drifting(n, seed=FIST), "side": "left"}]

    device, _ = played(bent, monkeypatch)
    assert "the left hand is a right hand" in device.notices[0]
    assert "the left hand is a right hand" in device.report.line()


FIST = 1
"""Seed of a hand whose fingers are bent."""


# A world in which a unit is a centimetre: Babylon.js 12441.
def test_a_world_in_centimetres_is_read_in_centimetres(monkeypatch: pytest.MonkeyPatch) -> None:
    def scaled(n: int, message: dict[str, Any]) -> None:
        hand = message["hands"][0]
        hand["joints"] = [joint and [100.0 * c for c in joint] for joint in hand["joints"]]

    device, frames = played(scaled, monkeypatch)
    assert "lengths are read in cm" in device.notices[0]
    true = played(lambda n, message: None, monkeypatch)[1][-1].hands[0]
    assert frames[-1].hands[0].palm == pytest.approx(true.palm)
