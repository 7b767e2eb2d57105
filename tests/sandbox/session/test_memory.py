"""A trial that has ended is gone, with all of MuJoCo's memory, before Python looks for garbage.

Python does not see how large MuJoCo's arrays are: a trial that waits for the search of garbage in a
cycle of references costs a regression run tens of megabytes a trial.
"""

from __future__ import annotations

import gc
import weakref
from collections.abc import Sequence
from pathlib import Path

import pytest

from sandbox.session.session import Session
from sandbox.trial.assembly import device_makers
from sandbox.trial.driver import View, play_trial
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.registry import find_task, task_names


def left_over(options: TrialOptions, record: Path | None = None) -> list[str]:
    """What is still there of a trial that has ended, by the names of the classes."""
    seen: list[weakref.ref[object]] = []

    def watch(session: Session) -> Sequence[View]:
        rig = session.rigs[0]
        parts = (session, session.scene, session.task, rig.device, rig.reconstructor)
        seen.extend(weakref.ref(part) for part in parts)
        return ()

    chosen = trial_settings(options)
    gc.collect()
    gc.disable()
    try:
        play_trial(chosen, device_makers(chosen), watch, record)
        del chosen
        found = [part for part in (ref() for ref in seen) if part is not None]
    finally:
        gc.enable()
    assert len(seen) == 5
    return [type(part).__name__ for part in found]


@pytest.mark.parametrize("task", task_names())
def test_nothing_is_left_of_a_trial_that_has_ended(
    task: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(find_task(task), "time_limit", 2.0)
    assert left_over(TrialOptions(task=task, seed=3)) == []


@pytest.mark.parametrize("device", ["leap-simulated", "simulated"])
def test_nothing_is_left_of_a_recorded_trial_nor_of_one_by_hands_in_the_air(
    device: str, tmp_path: Path
) -> None:
    options = TrialOptions(task="box-to-goal", seed=4, device=device)
    assert left_over(options, tmp_path / "trial.jsonl") == []
