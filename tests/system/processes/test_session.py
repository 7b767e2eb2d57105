"""Another process computes the same to the bit."""

from __future__ import annotations

import json
import re
import signal
from pathlib import Path
from typing import Any

import pytest

from sandbox.recording.recording import load_recording
from sandbox.trial.driver import play_trial
from sandbox.trial.replay import replay
from sandbox.trial.result import TrialResult
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.processes import program, run, until


def trial(record: Path | None = None, **options: Any) -> TrialResult:
    chosen = trial_settings(TrialOptions(**options))
    return play_trial(chosen, record=record)


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> tuple[TrialResult, Path]:
    path = tmp_path_factory.mktemp("run") / "run.jsonl"
    return trial(path, seed=11, fingers=3), path


def test_a_recording_as_a_device_of_another_process_gives_the_same_hash(
    recorded: tuple[TrialResult, Path],
) -> None:
    result, path = recorded
    status, lines, errors = run("run", "--device", path, "--json", "-")
    assert status == 0, errors
    again = json.loads("".join(lines))
    assert again["state_hash"] == result.state_hash
    assert again["seed"] == 11 and again["success"] == result.success


def test_a_changed_touch_is_noticed_by_the_replay(
    recorded: tuple[TrialResult, Path], tmp_path: Path
) -> None:
    _, path = recorded
    lines = path.read_text().splitlines()
    where = next(i for i, t in enumerate(lines) if len(json.loads(t).get("contacts", [])) == 3)
    line = json.loads(lines[where])
    line["contacts"][0][1] += 1e-9
    lines[where] = json.dumps(line)
    forged = tmp_path / "forged.jsonl"
    forged.write_text("\n".join(lines) + "\n")
    _, found = replay(load_recording(forged))
    assert found.first_difference is not None
    status, said, _ = run("replay", forged)
    assert status == 1 and "differs" in "".join(said)


@pytest.mark.parametrize("ends", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_live_run_that_is_ended_keeps_its_motion_and_a_recording_that_replays(
    ends: signal.Signals, tmp_path: Path, as_without_nohup: None
) -> None:
    motion, record = tmp_path / "hand.bvh", tmp_path / "run.jsonl"
    files = ("--motion", motion, "--record", record)
    with program("run", "--device", "tuio", "--port", "0", *files) as it:
        # Some seconds of the trial: a keyframe is the state after one of them.
        until(lambda: record.exists() and record.read_text().count('"keyframe"') >= 3)
        it.process.send_signal(ends)
        status, _ = it.end()
    said = "".join(it.errors)
    assert status == 130 and "Traceback" not in said
    assert all(f"what came before is in {path}" in said for path in (motion, record))
    written = motion.read_text()
    frames = re.search(r"^Frames: (\d+) *$", written, re.M)
    lines = written.partition("Frame Time:")[2].splitlines()[1:]
    assert frames and int(frames[1]) == len(lines) >= 60
    _, found = replay(load_recording(record))
    assert found.exact
