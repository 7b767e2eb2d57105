"""A trial's result goes into JSON and back, and every record keeps a declared part of it."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from models.errors import RecordingError
from sandbox.recording.recording import load_recording
from sandbox.trial.driver import play_trial
from sandbox.trial.result import ResultRecord, TrialResult, record_fields
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.score import Status

RESULT = TrialResult(
    task="box-to-goal",
    seed=3,
    success=True,
    instant=True,
    held=True,
    final=False,
    status=Status.HELD,
    progress=0.5,
    time_s=1.25,
    reason="",
    state_hash="ab",
    extra={"lab": "room 2"},
)


def test_a_result_comes_back_from_json_with_the_keys_that_a_caller_added() -> None:
    values = json.loads(json.dumps(RESULT.as_json()))
    assert values["lab"] == "room 2" and values["status"] == "held"
    assert "encoder" not in values and "extra" not in values
    assert TrialResult.from_json(values, "here") == RESULT


def test_the_part_that_a_journal_keeps_is_a_result_itself() -> None:
    part = RESULT.values_for(ResultRecord.JOURNAL)
    again = TrialResult.from_json(part, "here")
    assert (again.score, again.settings) == (RESULT.score, None)
    assert set(part) <= set(record_fields(ResultRecord.JOURNAL))


@pytest.mark.parametrize(
    ("change", "said"),
    [({"time_s": "soon"}, "time_s"), ({"status": "won"}, "won"), ({"seed": None}, "seed")],
)
def test_json_that_is_not_a_result_is_refused_with_its_place(
    change: dict[str, Any], said: str
) -> None:
    with pytest.raises(RecordingError, match=said) as refused:
        TrialResult.from_json(RESULT.as_json() | change, "T001.jsonl")
    assert "T001.jsonl" in str(refused.value)


def test_the_result_of_a_run_is_the_one_that_its_recording_ends_with(tmp_path: Path) -> None:
    chosen = trial_settings(TrialOptions(task="tests/support/regress_tasks.py:Quick", seed=2))
    path = tmp_path / "trial.jsonl"
    result = play_trial(chosen, record=path)
    recording = load_recording(path)
    assert recording.end["result"] == json.loads(json.dumps(result.as_json()))
    assert result.fingerprint == recording.header["versions"]["fingerprint"]
    assert not result.extra, "all keys of our own are declared"
