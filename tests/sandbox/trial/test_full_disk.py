"""Who records is told at once when the disk is full, and keeps what was written."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from models.errors import RecordingError
from sandbox.options.scene_options import SceneOptions, plan
from sandbox.recording.recording import load_recording
from sandbox.session.messages import Snapshot
from sandbox.trial.driver import open_trial
from sandbox.trial.headless import run_trial
from sandbox.trial.live import LiveTrial
from sandbox.trial.replay import replay
from tests.support.processes import until

ROOM = 60_000
"""Bytes that the disk takes; a whole recording of this trial is some 280,000."""


@contextmanager
def full_disk() -> Iterator[None]:
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (ROOM, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_a_trial_ends_soon_after_its_recording_cannot_go_on(tmp_path: Path) -> None:
    chosen, path = plan(SceneOptions(seed=3)), tmp_path / "run.jsonl"
    seen: list[float] = []

    def watch(snapshot: Snapshot) -> None:
        seen.append(snapshot.time)

    with full_disk(), pytest.raises(RecordingError, match="incomplete"):
        run_trial(chosen.settings, chosen.makers, lambda session: [watch], path, chosen.about)
    recording = load_recording(path)
    _, found = replay(recording)
    assert found.exact and recording.end is None
    whole = run_trial(chosen.settings, chosen.makers, about=chosen.about)
    assert seen[-1] < whole.time_s


def test_a_person_who_plays_is_told_while_playing(tmp_path: Path) -> None:
    chosen = plan(SceneOptions(seed=3))
    with (
        full_disk(),
        pytest.raises(RecordingError, match="incomplete"),
        open_trial(
            chosen.settings, chosen.makers, record=tmp_path / "run.jsonl", about=chosen.about
        ) as trial,
    ):
        live = LiveTrial(trial, speed=1000.0)
        live.start()
        until(lambda: live.over)
        live.stop()
        assert isinstance(live.failure, RecordingError)
        assert not trial.session.over
