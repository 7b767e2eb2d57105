"""Hands do not wait for screens with noise: touches that stay where they are rest."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from sandbox.options.scene_options import SceneOptions, plan
from sandbox.recording.recording import load_recording
from sandbox.session.session import Session
from sandbox.trial.headless import run_trial
from sandbox.trial.replay import replay
from tests.support.waits import Waits


def rules_of(**options: object) -> int:
    return plan(SceneOptions(**options)).settings.rules  # type: ignore[arg-type]


@pytest.mark.parametrize("device", ["mouse", "web", "tuio"])
def test_whatever_screen_a_person_has_its_noise_is_not_taken_for_motion(device: str) -> None:
    assert rules_of(device=device) == 3


def test_one_screen_of_a_person_beside_a_simulated_hand_is_enough() -> None:
    assert rules_of(device="simulated", second_device="tuio", task="carry-together") == 3


def test_simulated_touches_keep_the_rules_by_which_they_were_judged_but_for_noise() -> None:
    assert rules_of() == rules_of(vary="latency=40") == 2
    assert rules_of(vary="noise=0.5") == 3


def waits(rules: int, noise: float, record: Path | None = None) -> list[float]:
    """The same trial of the simulated user by rules, with noise in mm."""
    watched: list[Waits] = []

    def watch(session: Session) -> list[Waits]:
        watched.append(Waits(session))
        return watched

    chosen = plan(SceneOptions(seed=5, fingers=3, vary=f"noise={noise:g}" if noise else ""))
    settings = replace(chosen.settings, rules=rules)
    result = run_trial(settings, chosen.makers, watch, record=record, about=chosen.about)
    assert result.success, result.reason
    return watched[0].waits


def test_a_millimetre_of_noise_costs_a_hand_no_time() -> None:
    assert min(waits(2, 1.0)) > 0.9
    assert max(waits(3, 1.0)) < 0.2
    assert waits(3, 0.0)[0] <= waits(2, 0.0)[0]


def test_noisy_touches_replay_to_the_bit(tmp_path: Path) -> None:
    waits(3, 1.5, tmp_path / "noisy.jsonl")
    recording = load_recording(tmp_path / "noisy.jsonl")
    assert recording.header["settings"]["rules"] == 3
    _, verification = replay(recording)
    assert verification.exact and verification.complete
    # Touches that are played again keep the rules that they were recorded by.
    assert rules_of(device=str(tmp_path / "noisy.jsonl")) == 3
