"""Hands in a headset in a session: trials, recordings, replays, two hands, options."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import pytest

from models.errors import InputError
from models.frames import HandFrame
from sandbox.cli.main import main
from sandbox.recording.recording import load_recording
from sandbox.trial.driver import play_trial
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


def test_a_headset_is_the_first_device() -> None:
    with pytest.raises(InputError, match="must be the first hand"):
        trial_settings(TrialOptions(device="tuio", second_device="webxr"))


@pytest.mark.parametrize("view", ["window", "none"])
def test_a_headset_has_no_other_view(view: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["play", "box-to-goal", "--device", "webxr", "--view", view]) == 2
    assert "a headset's own page shows the scene" in capsys.readouterr().err


def test_run_serves_no_page(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["run", "box-to-goal", "--device", "webxr"]) == 2
    assert "sandbox play box-to-goal --device webxr" in capsys.readouterr().err
