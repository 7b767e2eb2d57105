"""The Inspire Hand follows, with the models of robosuite, of which nothing is imported."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from models.errors import InputError
from models.robot.mapping import REMEDIES, find_robot
from models.robot.mapping_fit import fit_mapping
from sandbox import replay_recording, run_trial

SEED = 5000
"""A training seed."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with robosuite alone; `HAND_SANDBOX_ROBOSUITE` names one that is there already."""
    if there := os.environ.get("HAND_SANDBOX_ROBOSUITE"):
        return Path(there)
    folder = tmp_path_factory.mktemp("robosuite")
    words = REMEDIES["robosuite"].split()[1:]
    subprocess.run([sys.executable, "-m", "pip", *words, "-q", "--target", folder], check=True)
    return folder


@pytest.mark.full
def test_the_inspire_hand_brings_the_box_to_its_goal_and_replays(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.syspath_prepend(str(folder))
    file = tmp_path / "run.jsonl"
    run = run_trial("box-to-goal", SEED, record=file, robot="inspire", fingers=3)
    assert run.success
    again = replay_recording(file)
    assert again.verification is not None and again.verification.exact


@pytest.mark.full
def test_its_mapping_is_that_of_the_fit(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(folder))
    ships = find_robot("inspire")
    fit = fit_mapping(ships.path, ships.tips, model=ships.model, ends=True)
    assert fit.other_side > 5 * fit.side
    assert np.allclose(fit.mapping.places, ships.places, atol=1e-4)
    assert np.allclose(fit.mapping.offset, ships.offset, atol=1e-4)
    assert np.allclose(fit.mapping.turn, ships.turn, atol=1e-3)
    assert np.allclose(fit.mapping.radii, ships.radii, atol=1e-4)
    assert fit.mapping.scales == ships.scales and fit.mapping.side == ships.side


def test_without_robosuite_one_line_says_how_to_install_its_models(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("models.robot.mapping.find_spec", lambda name: None)
    with pytest.raises(InputError, match="pip install --no-deps robosuite") as error:
        _ = find_robot("inspire").path
    assert "\n" not in str(error.value)
