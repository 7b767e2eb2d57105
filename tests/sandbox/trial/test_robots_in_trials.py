"""A robot's hand plays a whole trial, and its recording replays to the bit."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from models.errors import RecordingError
from sandbox import TrialRun, replay_recording, run_trial
from tests.support.needs import require

SEED = 3
"""A training seed."""


@pytest.fixture(scope="module")
def played(tmp_path_factory: pytest.TempPathFactory) -> tuple[TrialRun, Path]:
    """A trial of the Shadow Hand, and its recording."""
    require("robots")
    file = tmp_path_factory.mktemp("shadow") / "run.jsonl"
    run = run_trial("box-to-goal", SEED, record=file, robot="shadow", trajectories=False, fingers=3)
    return run, file


def test_the_shadow_hand_brings_the_box_to_its_goal(played: tuple[TrialRun, Path]) -> None:
    run, _ = played
    assert run.success and run.score.status == "held"
    assert run.result["settings"]["robot"] == "shadow" and run.result["unreached"] < 0.05


def test_its_recording_replays_to_the_bit(played: tuple[TrialRun, Path]) -> None:
    run, file = played
    again = replay_recording(file, trajectories=False)
    assert again.verification is not None
    assert again.verification.exact and again.verification.complete
    assert again.verification.compared > 200
    assert again.state_hash == run.state_hash


def test_a_recording_of_another_model_or_mapping_is_refused(
    played: tuple[TrialRun, Path], tmp_path: Path
) -> None:
    header, _, rest = played[1].read_text(encoding="utf-8").partition("\n")
    values = json.loads(header)
    values["digests"]["robot"] = "0" * 32
    file = tmp_path / "run.jsonl"
    file.write_text(json.dumps(values) + "\n" + rest, encoding="utf-8")
    with pytest.raises(RecordingError, match="another") as error:
        replay_recording(file)
    assert "\n" not in str(error.value)
