"""Who records is told at once when the disk is full, and keeps what was written."""

from __future__ import annotations

import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from models.errors import InputError, RecordingError
from sandbox.recording.recording import load_recording
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import device_makers
from sandbox.trial.driver import LiveRun, View, open_trial, play_trial
from sandbox.trial.replay import replay
from sandbox.trial.trial_options import TrialOptions, trial_settings
from sandbox.views.display import FilmError
from sandbox.views.film_files import _Mp4, open_film
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
    chosen, path = trial_settings(TrialOptions(seed=3)), tmp_path / "run.jsonl"
    seen: list[float] = []

    def watch(snapshot: Snapshot) -> None:
        seen.append(snapshot.time)

    with full_disk(), pytest.raises(RecordingError, match="incomplete"):
        play_trial(chosen, device_makers(chosen), lambda session: [watch], path)
    recording = load_recording(path)
    _, found = replay(recording)
    assert found.exact and recording.end is None
    whole = play_trial(chosen)
    assert seen[-1] < whole.time_s


def test_a_person_who_plays_is_told_while_playing(tmp_path: Path) -> None:
    chosen = trial_settings(TrialOptions(seed=3))
    with (
        full_disk(),
        pytest.raises(RecordingError, match="incomplete"),
        open_trial(chosen, record=tmp_path / "run.jsonl") as trial,
    ):
        live = LiveRun(trial, speed=1000.0)
        live.start()
        until(lambda: live.over)
        live.stop()
        assert isinstance(live.failure, RecordingError)
        assert not trial.session.over


def test_a_film_of_which_ffmpeg_wrote_a_part_is_refused_and_the_old_one_stays(
    tmp_path: Path,
) -> None:
    path = tmp_path / "film.mp4"
    path.write_bytes(b"the old one")
    film = open_film(path, (320, 240), 30.0)
    rng = np.random.default_rng(0)
    for _ in range(20):
        film.add(Image.fromarray(rng.integers(0, 255, (240, 320, 3), np.uint8)))
    assert isinstance(film, _Mp4)
    # What a full disk leaves: ffmpeg has ended, and its file stops in the middle.
    film._pipe.close()
    with film._part.open("r+b") as part:
        part.truncate(film._part.stat().st_size // 2)
    with pytest.raises(FilmError, match="did not write the whole film"):
        film.close()
    assert [each.name for each in tmp_path.iterdir()] == ["film.mp4"]
    assert path.read_bytes() == b"the old one"


def test_a_trial_that_cannot_begin_leaves_no_recording(tmp_path: Path) -> None:
    chosen, path = trial_settings(TrialOptions(seed=3)), tmp_path / "run.jsonl"

    def no_views(session: Session) -> list[View]:
        raise InputError("no such format of films")

    with pytest.raises(InputError, match="no such format"):
        play_trial(chosen, device_makers(chosen), no_views, path)
    assert not path.exists()
    path.write_text("somebody's own")
    with pytest.raises(RecordingError, match="exists"):
        play_trial(chosen, device_makers(chosen), no_views, path)
    assert path.read_text() == "somebody's own"
