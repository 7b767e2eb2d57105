"""Measures of trials that are played anew by their seeds are the frozen ones, of all tasks."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from sandbox.recording.versions import versions
from sandbox.study.measures.measures import MEASURES, Measured
from tasks.registry import TASKS
from tests.support.measured_trials import SEEDS, frozen, measured, play, throughput_of

FROZEN = frozen()
BY_TRIAL = {(trial["task"], trial["seed"]): trial for trial in FROZEN["trials"]}
LIVE = ("lost_s", "latency_p95_ms")
"""Measures of the machine, which no seed decides."""
NAMES = [m.name for m in MEASURES if m.of is not None and m.name not in LIVE]


def played_again(task: str, seed: int, folder: Path) -> Measured:
    """Plays a trial again and compares its measures with the frozen ones."""
    before = BY_TRIAL[task, seed]
    attempt = play(task, seed, folder)
    if attempt.result.state_hash != before["state_hash"]:
        if versions()["fingerprint"] == FROZEN["fingerprint"]:
            pytest.fail("states have changed: python -m tests.support.measured_trials")
        pytest.skip("states of another machine")
    now = measured(attempt)
    for name in NAMES:
        assert now.values[name] == approximately(before["measures"][name]), (task, seed, name)
    return now


def approximately(value: Any) -> Any:
    """The value to 1e-6, if it is a number."""
    return pytest.approx(value, abs=1e-6, rel=1e-6) if isinstance(value, float) else value


@pytest.mark.parametrize(("task", "seed"), [("box-to-goal", 1), ("dial", 3), ("single-keys", 2)])
def test_measures_of_some_trials_are_the_frozen_ones(task: str, seed: int, tmp_path: Path) -> None:
    played_again(task, seed, tmp_path)


@pytest.mark.full
@pytest.mark.parametrize("task", TASKS)
def test_measures_of_all_trials_are_the_frozen_ones_and_their_throughput_too(
    task: str, tmp_path: Path
) -> None:
    trials = [played_again(task, seed, tmp_path) for seed in SEEDS]
    assert throughput_of(trials) == approximately(FROZEN["throughput"][task])
