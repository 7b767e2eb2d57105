"""A simulation that loses its meaning is stopped, marked, and leaves behind how it came to that."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.errors import DivergenceError
from sandbox.recording.recording import load_recording
from sandbox.session.session import Session
from sandbox.trial.driver import DUMPED_STATES, play_trial
from sandbox.trial.replay import replay
from sandbox.trial.result import TrialResult
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.scripted import run, scripted

ABSURD = f"{Path(__file__).parent / 'absurd_task.py'}:Absurd"


def diverge(record: Path | None = None, dump: Path | None = None) -> TrialResult:
    chosen = trial_settings(TrialOptions(task=ABSURD, seed=7))
    return play_trial(chosen, record=record, dump=dump)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[TrialResult, Path]:
    path = tmp_path_factory.mktemp("diverged") / "run.jsonl"
    return diverge(path), path


def test_the_dump_beside_a_recording_replays_to_the_same_divergence_to_the_bit(
    recorded: tuple[TrialResult, Path],
) -> None:
    result, path = recorded
    dump = path.with_name("run-diverged.jsonl")
    assert result.dump == str(dump)
    recording = load_recording(dump)
    session, found = replay(recording)
    assert found.exact and found.complete and not recording.damage
    assert session.state_hash == result.state_hash
    assert found.diverged == result.diverged
    assert session.scorer.score.status == "diverged"


def test_a_dump_holds_the_last_hundred_control_states_the_broken_one_included(
    recorded: tuple[TrialResult, Path],
) -> None:
    result, _ = recorded
    recording = load_recording(Path(result.dump))
    end = recording.end["step"]
    assert recording.header["dump"]["states"] == DUMPED_STATES == 100
    dense = [end - 8 * i for i in range(DUMPED_STATES)]
    assert set(dense) <= set(recording.keyframes)
    assert dense[-1] > 0
    turning = [abs(recording.keyframes[step]).max() for step in reversed(dense)]
    assert turning[-1] > 5000.0 and turning == sorted(turning)
    assert set(recording.track.qpos) == set(range(0, end + 1, 8))


def test_without_a_recording_the_dump_goes_to_its_folder_and_overwrites_nothing(
    tmp_path: Path,
) -> None:
    folder = tmp_path / "new" / "folder"
    first, second = diverge(dump=folder), diverge(dump=folder)
    assert Path(first.dump).name == "diverged-absurd-7.jsonl"
    assert Path(second.dump).name == "diverged-absurd-7-2.jsonl"
    assert len(list(folder.iterdir())) == 2
    assert first.state_hash == second.state_hash


def test_a_dump_that_cannot_be_written_costs_no_result(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    result = diverge(dump=tmp_path / "file" / "folder")
    assert result.status == "diverged"
    assert result.dump == "" and "folder" in result.dump_error


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (lambda s: s.data.qvel.__setitem__(-1, np.nan), "not finite"),
        (lambda s: s.data.qpos.__setitem__(0, np.inf), "not finite"),
        (lambda s: s.data.qvel.__setitem__(slice(-6, -3), [0.0, 0.0, 400.0]), "box moves at"),
    ],
)
def test_numbers_without_meaning_are_caught_in_the_step_that_meets_them(
    spoil: Callable[[Session], object], words: str
) -> None:
    session = scripted(lambda now: (), seed=1)
    run(session, 0.1)
    spoil(session)
    with pytest.raises(DivergenceError, match=words):
        session.advance()
    assert session.scorer.score.status == "diverged"
    assert words in session.diverged


def test_a_commanded_pose_that_is_not_finite_is_caught_before_the_hand_follows_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    session = scripted(lambda now: (), seed=1)
    run(session, 0.1)
    before = session.data.qpos.copy()
    reconstructor = session.rigs[0].reconstructor
    sound = reconstructor.step
    broken = np.full(48, np.nan)
    monkeypatch.setattr(reconstructor, "step", lambda frame: replace(sound(frame), q=broken))
    with pytest.raises(DivergenceError, match="commanded pose"):
        session.advance()
    np.testing.assert_array_equal(session.data.qpos, before)
