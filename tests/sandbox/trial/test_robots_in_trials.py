"""A robot's hand plays a whole trial, and its recording replays to the bit."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from models.errors import RecordingError
from models.robot.mapping_fit import fit_mapping
from sandbox import TrialRun, replay_recording, run_trial
from tests.models.robot.hinge_hand import TIPS, hinge_hand
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
    assert run.result["settings"]["physics"]["robot"] == "shadow" and run.result["unreached"] < 0.05


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


@pytest.fixture(scope="module")
def four_fingers(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A hand without a little finger, with its mapping."""
    path = hinge_hand(tmp_path_factory.mktemp("four"), tips=4)
    path.with_suffix(".toml").write_text(fit_mapping(path, TIPS[:4]).mapping.as_toml())
    return str(path)


def test_a_finger_that_the_robot_lacks_is_never_solid_and_is_counted_as_unreached(
    four_fingers: str, tmp_path: Path
) -> None:
    file = tmp_path / "run.jsonl"
    run = run_trial("dial", SEED, record=file, robot=four_fingers, fingers=5)
    assert run.trajectories is not None
    (hand,) = run.trajectories.hands
    assert hand.solid[:, :4].any() and not hand.solid[:, 4].any()
    assert run.result["unreached"] > 0.3
    again = replay_recording(file, trajectories=False)
    assert again.verification is not None and again.verification.exact
    assert again.state_hash == run.state_hash
