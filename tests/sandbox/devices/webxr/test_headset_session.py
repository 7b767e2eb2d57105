"""Hands in a headset in a session: trials, recordings, replays, two hands, options."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import pytest

from models.errors import InputError
from models.frames import HandFrame
from sandbox.cli.main import main
from sandbox.devices.webxr.webxr import HeadsetDevice
from sandbox.recording.recording import load_recording
from sandbox.server.protocol import PageHands, PageScreen
from sandbox.trial.assembly import build
from sandbox.trial.driver import play_trial
from sandbox.trial.open_devices import device_makers
from sandbox.trial.settings import recorded_settings
from sandbox.trial.trial_options import TrialOptions, trial_settings


def test_a_trial_in_a_simulated_headset_is_recorded_and_replays_to_the_bit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "trial.jsonl"
    assert main(["run", "box-to-goal", "--device", "webxr-simulated", "--record", str(file)]) == 0
    assert main(["replay", str(file)]) == 0
    assert "equal to the bit" in capsys.readouterr().out
    recording = load_recording(file)
    frames = [entry.frame for entry in recording.inputs[0]]
    last = frames[-1]
    assert all(isinstance(frame, HandFrame) for frame in frames) and isinstance(last, HandFrame)
    joints = [f.joints for f in last.hands[0].fingers]
    assert len(joints) == 5 and all(joints)
    settings = recorded_settings(recording.header)
    assert settings.hands[0].in_air is not None and settings.hands[0].in_air.joints


@pytest.mark.parametrize(("task", "hand"), [("box-to-goal", "left"), ("stack", "right")])
def test_the_simulated_person_succeeds(task: str, hand: Literal["left", "right"]) -> None:
    chosen = trial_settings(TrialOptions(task=task, device="webxr-simulated", hand=hand))
    result = play_trial(chosen)
    assert result.success, result.reason


def test_two_hands_in_one_headset_see_the_same_frames() -> None:
    chosen = trial_settings(TrialOptions(device="webxr", task="carry-together"))
    assert [hand.side for hand in chosen.hands] == ["right", "left"]
    assert all(hand.in_air and hand.in_air.joints for hand in chosen.hands)
    session = build(chosen, device_makers(chosen))
    first, second = (rig.device for rig in session.rigs)
    headset = first.find(HeadsetDevice)
    assert headset is not None and second.find(HeadsetDevice) is headset
    headset.receive(PageHands(1, 0.0, []), PageScreen(100.0, 1000.0, 500.0, True))
    (mine,), (other,) = first.poll(0.1), second.poll(0.1)
    assert mine is other and not first.poll(0.2) and not second.poll(0.2)


def test_two_right_hands_in_one_headset_are_refused() -> None:
    with pytest.raises(InputError, match="a right and a left hand"):
        trial_settings(
            TrialOptions(device="webxr", second_device="webxr", hand="right", second_hand="right")
        )


def test_a_headset_is_the_first_device() -> None:
    with pytest.raises(InputError, match="comes first"):
        trial_settings(TrialOptions(device="tuio", second_device="webxr"))


def test_touches_alone_can_be_degraded() -> None:
    with pytest.raises(InputError, match="in the air"):
        trial_settings(TrialOptions(device="webxr", vary="noise=0.001"))


@pytest.mark.parametrize("view", ["window", "none"])
def test_a_headset_has_no_other_view(view: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["play", "box-to-goal", "--device", "webxr", "--view", view]) == 2
    assert "a headset's own page shows the scene" in capsys.readouterr().err


def test_run_serves_no_page(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "box-to-goal", "--device", "webxr"]) == 2
    assert "sandbox play box-to-goal --device webxr" in capsys.readouterr().err
