"""A rest posture in trials: options, profile, recording and replay."""

import json
from pathlib import Path
from typing import Any

import pytest

from encoders.captures.subject import FROZEN, SEED, simulate
from encoders.person.rest_posture import rest_samples, save_rest
from models.errors import InputError
from models.person import Person, RestSamples
from sandbox.cli.main import main
from sandbox.trial.profiles import Profile, load_profile, save_profile
from sandbox.trial.trial_options import TrialOptions, trial_settings


@pytest.fixture(scope="module")
def samples() -> RestSamples:
    return rest_samples(simulate(FROZEN, SEED, 1), 3)


@pytest.fixture
def rest(tmp_path: Path, samples: RestSamples) -> Path:
    save_rest(samples, tmp_path / "rest.json", "right", simulated=True)
    return tmp_path / "rest.json"


def test_a_profile_keeps_a_rest_posture_for_the_encoder_of_any_person(
    tmp_path: Path, samples: RestSamples
) -> None:
    path = tmp_path / "me.json"
    profile = Profile(Person(), (0.9, 1.1), "tuio", True, (), samples)
    save_profile(profile, path)
    assert load_profile(path) == profile and "3 samples" in profile.line

    def used(**options: Any) -> RestSamples:
        return trial_settings(TrialOptions(profile=str(path), **options)).hands[0].rest

    assert used(encoder="population") == samples
    assert used() == samples
    assert used(encoder="cubic") == () == used(encoder="population", hand="left")


def test_a_damaged_rest_posture_of_a_profile_is_told(tmp_path: Path, samples: RestSamples) -> None:
    path = tmp_path / "me.json"
    save_profile(Profile(Person(), (0.9, 1.1), "tuio", True, (), samples), path)
    values = json.loads(path.read_text())
    values["rest"][1]["pose"][20] = 5.0
    path.write_text(json.dumps(values))
    with pytest.raises(InputError, match=r"no hand has such a joint \(me.json|.*rest, sample 2"):
        load_profile(path)


def test_a_trial_with_a_rest_posture_replays_without_its_file(
    tmp_path: Path, rest: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = ["run", "box-to-goal", "--encoder", "population", "--seed", "3", "--json", "-"]
    recording = tmp_path / "run.jsonl"
    assert main([*line, "--rest", str(rest), "--record", str(recording)]) == 0
    seen = json.loads(capsys.readouterr().out)
    rest.unlink()
    assert main(["replay", str(recording)]) == 0
    capsys.readouterr()
    assert main(line) == 0
    assert json.loads(capsys.readouterr().out)["state_hash"] != seen["state_hash"]


def test_a_rest_posture_needs_an_encoder_of_any_person(
    rest: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "box-to-goal", "--encoder", "cubic", "--rest", str(rest)]) == 2
    assert "cannot use a rest posture" in capsys.readouterr().err


def test_a_measured_hand_keeps_a_rest_posture(
    tmp_path: Path, rest: Path, samples: RestSamples
) -> None:
    out = tmp_path / "me.json"
    line = ["hand", "measure", "--device", "simulated", "--rest", str(rest), "--out", str(out)]
    assert main(line) == 0
    assert load_profile(out).rest == samples
