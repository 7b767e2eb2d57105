"""A recording names its program, and one of other states is read but never played again."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.errors import RecordingError
from sandbox.cli.main import main
from sandbox.export.sources import open_source
from sandbox.recording.recording import load_recording
from sandbox.recording.versions import STATES, DifferentStatesError, commit, made_with, states_of
from sandbox.study.record.stored_sessions import session_path
from sandbox.study.run.simulated_study import run_simulated
from sandbox.trial.driver import play_trial
from sandbox.trial.replay import replay
from sandbox.trial.settings import recorded_settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.study_files import TRIALS, open_study

MADE_WITH = "made with states 1 (hand-sandbox 0.2.0, commit abc1234)"


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("run") / "run.jsonl"
    chosen = trial_settings(TrialOptions(seed=11, fingers=3))
    play_trial(chosen, record=path)
    return path


def of_other_states(path: Path, to: Path, **settings: Any) -> Path:
    """The recording as a program with states 1 would have written it."""
    first, _, rest = path.read_text().partition("\n")
    header = json.loads(first)
    del header["states"]
    header["versions"] |= {"hand-sandbox": "0.2.0", "commit": "abc1234"}
    header["settings"] |= settings
    to.write_text(f"{json.dumps(header)}\n{rest}")
    return to


def test_a_recording_names_the_states_of_its_program_and_plays_again(recorded: Path) -> None:
    recording = load_recording(recorded)
    assert recording.header["states"] == states_of(recording.header) == STATES
    _, verification = replay(recording)
    assert verification.exact and verification.complete


def test_settings_without_groups_are_read_as_they_were_and_play_again(
    recorded: Path, tmp_path: Path
) -> None:
    first, _, rest = recorded.read_text().partition("\n")
    header = json.loads(first)
    settings, device = header["settings"], header["settings"].pop("device")
    del settings["second_device"]
    surface = settings.pop("surface")
    flat = {**settings.pop("pipeline"), **settings.pop("physics"), **settings}
    flat |= {"surface_in": surface["size_in"], "surface_calibrated": surface["calibrated"]}
    del flat["hover"]
    header |= {"settings": flat, "device": device["name"], **device["options"]}
    old = tmp_path / "old.jsonl"
    old.write_text(f"{json.dumps(header)}\n{rest}")
    recording = load_recording(old)
    assert recorded_settings(recording.header) == recorded_settings(load_recording(recorded).header)
    assert replay(recording)[1].exact


@pytest.mark.parametrize(
    "words",
    [
        ["replay", "{}"],
        ["replay", "{}", "--film", "film.webp"],
        ["export", "{}", "--of", "commanded", "--to", "hand.bvh"],
        ["export", "{}", "--to", "lerobot", "--name", "me/old"],
    ],
    ids=" ".join,
)
def test_whatever_would_play_it_again_refuses_it_in_one_line_with_both_programs(
    recorded: Path,
    tmp_path: Path,
    words: list[str],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    of_other_states(recorded, tmp_path / "old.jsonl", rules=2)
    assert main([word.format("old.jsonl") for word in words]) in (1, 2)
    said = capsys.readouterr().err
    assert said.count("\n") == 1 and MADE_WITH in said and f"states {STATES}" in said
    assert [path.name for path in tmp_path.iterdir()] == ["old.jsonl"]


def test_its_recorded_poses_are_exported_whatever_settings_it_has(
    recorded: Path, tmp_path: Path
) -> None:
    old = of_other_states(recorded, tmp_path / "old.jsonl", rules=2, labels="no such labels")
    poses = []
    for path in (recorded, old):
        taken: list[Any] = []
        source = open_source(path)
        source.play(taken.append)
        poses.append(np.concatenate([each.root for each in taken]))
    np.testing.assert_array_equal(poses[0], poses[1])
    assert source.remarks == (f"{MADE_WITH}; this program has states {STATES}",)


def test_its_touches_play_anew_as_a_device_and_a_line_names_both(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    old = of_other_states(recorded, tmp_path / "old.jsonl", rules=2)
    assert main(["run", "--device", str(old)]) == 0
    assert MADE_WITH in capsys.readouterr().err.replace("\n", " ")


def test_a_header_whose_states_are_no_number_is_refused_with_its_file(
    recorded: Path, tmp_path: Path
) -> None:
    for wrong in ("2", None, True, 2.0):
        first, _, rest = recorded.read_text().partition("\n")
        broken = tmp_path / "broken.jsonl"
        broken.write_text(f"{json.dumps({**json.loads(first), 'states': wrong})}\n{rest}")
        with pytest.raises(RecordingError, match=r"broken\.jsonl, states"):
            load_recording(broken)
    recording = load_recording(recorded)
    recording.header["states"] = STATES + 1
    with pytest.raises(DifferentStatesError):
        replay(recording)
    assert made_with({}) == "states 1 (hand-sandbox unknown)"


def test_a_study_of_other_states_is_verified_but_for_its_replays(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    study = open_study(tmp_path)
    run_simulated(study, 1, lambda text: None)
    tables = session_path(study.path, study.participants()[0].ppid)
    frames = sorted(path.name for path in tables.rglob("*.frames.csv.gz"))
    assert frames
    monkeypatch.setattr("sandbox.recording.versions.STATES", STATES + 1)
    capsys.readouterr()
    assert main(["replay", str(study.path), "--verify"]) == 0
    said = " ".join(capsys.readouterr().out.split())
    assert f"{TRIALS} recordings not replayed: made with states {STATES}" in said
    assert sorted(path.name for path in tables.rglob("*.frames.csv.gz")) == frames


def git(folder: Path, *words: str) -> str:
    names = ["-c", "user.name=A", "-c", "user.email=a@example.org"]
    command = ["git", *names, "-C", str(folder), *words]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
def test_a_checkout_tells_its_commit_and_whether_files_differ_from_it(tmp_path: Path) -> None:
    git(tmp_path, "init", "-q")
    assert commit(tmp_path) == "", "there is no commit yet"
    (tmp_path / "a.py").write_text("1\n")
    git(tmp_path, "add", "a.py")
    git(tmp_path, "commit", "-q", "-m", "One")
    name = git(tmp_path, "rev-parse", "--short", "HEAD")
    (tmp_path / "note.txt").write_text("of nobody\n")
    assert commit(tmp_path) == name
    (tmp_path / "a.py").write_text("2\n")
    assert commit(tmp_path) == f"{name} with changes"


@pytest.mark.skipif(shutil.which("git") is None, reason="git is not installed")
def test_a_folder_inside_of_somebody_elses_checkout_has_no_commit(tmp_path: Path) -> None:
    git(tmp_path, "init", "-q")
    (tmp_path / "site-packages").mkdir()
    assert commit(tmp_path / "site-packages") == ""
