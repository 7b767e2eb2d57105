"""Hands do not wait for screens with noise: touches that stay where they are rest."""

from __future__ import annotations

from pathlib import Path

import pytest

from sandbox.recording.recording import load_recording
from sandbox.session.session import Session
from sandbox.trial.assembly import device_makers
from sandbox.trial.driver import play_trial
from sandbox.trial.replay import replay
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.waits import Waits


def waits(noise: float, record: Path | None = None) -> list[float]:
    """s that the hand waited over each of the simulated user's touches, with noise in mm."""
    watched: list[Waits] = []

    def watch(session: Session) -> list[Waits]:
        watched.append(Waits(session))
        return watched

    chosen = trial_settings(
        TrialOptions(seed=5, fingers=3, vary=f"noise={noise:g}" if noise else "")
    )
    result = play_trial(chosen, device_makers(chosen), watch, record=record)
    assert result.success, result.reason
    return watched[0].waits


@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_a_millimetre_of_noise_costs_a_hand_no_time(noise: float) -> None:
    assert max(waits(noise)) < 0.2


def test_noisy_touches_replay_to_the_bit(tmp_path: Path) -> None:
    waits(1.5, tmp_path / "noisy.jsonl")
    _, verification = replay(load_recording(tmp_path / "noisy.jsonl"))
    assert verification.exact and verification.complete
