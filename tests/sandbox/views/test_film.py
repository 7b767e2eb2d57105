"""Films and single pictures, read back by programs that know nothing of us."""

from __future__ import annotations

import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import imageio_ffmpeg
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

from models.errors import InputError
from sandbox.session.messages import Snapshot
from sandbox.views import film, film_files
from sandbox.views.display import FilmError
from sandbox.views.film import FilmView
from sandbox.views.film_files import durations
from tests.support.needs import require
from tests.support.viewed import Viewed, viewed

STEP = 0.016
"""s between two snapshots of a session."""


@pytest.fixture(scope="module")
def v() -> Viewed:
    """What is filmed; without OpenGL, nothing is."""
    require("opengl")
    return viewed()


@pytest.fixture(autouse=True)
def small_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    # Software OpenGL draws what is asked for; nothing here depends on how large that is.
    monkeypatch.setattr(film, "PICTURE_SIZE", (320, 180))


def trial(v: Viewed, seconds: float, begin: float = 0.0) -> Iterator[Snapshot]:
    """A trial in which nothing but the time goes on."""
    for i in range(1, round(seconds / STEP) + 1):
        yield replace(v.ghost, time=begin + i * STEP)


def filmed(path: Path, v: Viewed, snapshots: Iterable[Snapshot], **how: Any) -> FilmView:
    """A small film of snapshots, ten pictures a second, once it is closed."""
    with FilmView(path, v.scene, v.surface, fps=10, size=(160, 90), **how) as view:
        for snapshot in snapshots:
            view.show(snapshot)
    return view


def played(path: Path) -> tuple[int, int, tuple[int, int]]:
    """Frames, ms and size of an animation, as Pillow reads it."""
    image: Any
    with Image.open(path) as image:
        total = 0
        for i in range(image.n_frames):
            image.seek(i)
            image.load()
            total += round(image.info["duration"])
        return image.n_frames, total, image.size


@pytest.mark.parametrize("kind", ["webp", "gif"])
def test_an_animation_lasts_as_long_as_its_trial(v: Viewed, tmp_path: Path, kind: str) -> None:
    path = tmp_path / f"film.{kind}"
    view = filmed(path, v, trial(v, 1.5), caption="SIMULATED")
    frames, total, size = played(path)
    # Frames at 0.016 s, 0.116 s and so on; equal ones in a row are stored as a longer one.
    assert view.frames == 15 and view.dropped == 0
    assert total == 1500 and size == (160, 90)
    assert 8 <= frames <= 15
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


def test_a_video_has_all_frames_and_the_rate_that_was_asked_for(v: Viewed, tmp_path: Path) -> None:
    path = tmp_path / "film.mp4"
    picture = tmp_path / "picture.png"
    with FilmView(path, v.scene, v.surface, fps=25, size=(160, 90)) as view:
        for snapshot in trial(v, 1.2):
            view.show(snapshot)
        view.picture(next(trial(v, STEP)), picture, size=(160, 90))
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(path))
    assert frames == view.frames == 30
    assert seconds == pytest.approx(1.2, abs=0.05)
    reader = imageio_ffmpeg.read_frames(str(path))
    assert next(reader)["size"] == (160, 90)
    first = np.frombuffer(next(reader), np.uint8).reshape(90, 160, 3).astype(float)
    reader.close()
    assert np.abs(first - np.asarray(Image.open(picture), float)).mean() < 8.0


def test_a_second_trial_goes_on_where_the_first_one_s_film_ended(v: Viewed, tmp_path: Path) -> None:
    path = tmp_path / "film.webp"
    view = filmed(path, v, [*trial(v, 0.8), *trial(v, 0.5)])
    assert view.frames == 13
    assert played(path)[1] == 1300


def test_a_late_snapshot_stands_for_the_frames_that_were_missed(v: Viewed, tmp_path: Path) -> None:
    path = tmp_path / "film.webp"
    view = filmed(path, v, [replace(v.ghost, time=time) for time in (0.0, 0.1, 1.0)])
    assert view.frames == 11 and played(path)[1] == 1100


@pytest.mark.parametrize("kind", ["webp", "gif"])
def test_frames_that_wait_on_the_disk_come_back_unchanged_and_leave_nothing_behind(
    v: Viewed, tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    spool = tmp_path / "spool"
    spool.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(spool))
    paths = tmp_path / f"memory.{kind}", tmp_path / f"disk.{kind}"
    for path, limit in zip(paths, (film_files.REEL_BYTES, 3 * 160 * 90 * 2), strict=True):
        monkeypatch.setattr(film_files, "REEL_BYTES", limit)
        filmed(path, v, trial(v, 1.1))
    memory, disk = (path.read_bytes() for path in paths)
    assert memory == disk
    assert list(spool.iterdir()) == []


def test_a_picture_is_taken_while_filming_in_its_own_size(v: Viewed, tmp_path: Path) -> None:
    target = tmp_path / "picture.png"
    with FilmView(tmp_path / "film.webp", v.scene, v.surface, fps=10, size=(160, 90)) as view:
        view.show(v.ghost)
        view.picture(v.solid, target)
        view.picture(v.solid, tmp_path / "small.jpg", size=(64, 36))
        with pytest.raises(InputError, match="format"):
            view.picture(v.solid, tmp_path / "picture.txt")
        with pytest.raises(InputError, match="written here"):
            view.picture(v.solid, tmp_path / "nowhere" / "picture.png")
        with pytest.raises(InputError, match="cannot be drawn"):
            view.picture(v.solid, target, size=(5000, 5000))
    with Image.open(target) as image:
        assert image.size == (320, 180) and np.asarray(image).std() > 20
    with pytest.raises(FilmError, match="no picture can be drawn"):
        view.picture(v.solid, target)


def test_a_film_of_nothing_is_no_file(v: Viewed, tmp_path: Path) -> None:
    for kind in ("webp", "gif", "mp4"):
        FilmView(tmp_path / f"film.{kind}", v.scene, v.surface, size=(160, 90)).close()
    assert list(tmp_path.iterdir()) == []


def test_what_cannot_be_filmed_is_refused_before_anything_is_drawn(
    v: Viewed, tmp_path: Path
) -> None:
    def refused(match: str, name: str, **how: object) -> None:
        with pytest.raises(InputError, match=match):
            FilmView(tmp_path / name, v.scene, v.surface, **how)  # type: ignore[arg-type]

    refused("format", "film.avi")
    refused("written here", "no/such/folder/film.webp")
    refused("even", "film.mp4", size=(161, 90))
    refused("cannot be drawn", "film.webp", size=(2, 2))
    refused("rate", "film.webp", fps=0.0)
    refused("rate", "film.webp", fps=1000.0)
    assert list(tmp_path.iterdir()) == []


def test_a_film_that_cannot_be_finished_says_so_at_the_end_and_leaves_no_file(
    v: Viewed, tmp_path: Path
) -> None:
    folder = tmp_path / "taken"
    folder.mkdir()
    path = folder / "film.webp"
    view = FilmView(path, v.scene, v.surface, fps=10, size=(160, 90))
    view.show(v.ghost)
    folder.rmdir()
    with pytest.raises(FilmError, match="could not be written"):
        view.close()
    view.show(v.ghost)
    view.close()
    assert not path.exists()


def test_a_snapshot_that_cannot_be_drawn_ends_the_film_and_nothing_else(
    v: Viewed, tmp_path: Path
) -> None:
    view = FilmView(tmp_path / "film.webp", v.scene, v.surface, fps=10, size=(160, 90))
    view.show(replace(v.ghost, qpos=v.ghost.qpos[:-1]))
    for snapshot in trial(v, 0.5, begin=1.0):
        view.show(snapshot)
    with pytest.raises(FilmError, match="could not be written"):
        view.close()
    assert list(tmp_path.iterdir()) == []


def test_a_full_film_takes_no_more_frames_and_counts_them(
    v: Viewed, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(film_files, "MAX_FRAMES", 5)
    path = tmp_path / "film.webp"
    view = filmed(path, v, trial(v, 0.9))
    assert view.dropped == 4 and played(path)[1] == 500


def test_a_long_gif_is_thinned_out_but_lasts_as_long(
    v: Viewed, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(film_files, "MAX_GIF_FRAMES", 5)
    path = tmp_path / "film.gif"
    filmed(path, v, trial(v, 1.2))
    frames, total, _ = played(path)
    assert frames <= 5 and total == 1200


@given(st.integers(1, 2000), st.floats(1.0, 60.0), st.sampled_from([1, 10]))
def test_the_durations_of_frames_never_drift(frames: int, fps: float, unit: int) -> None:
    each = durations(frames, fps, unit)
    assert len(each) == frames and all(d % unit == 0 for d in each)
    assert abs(sum(each) - 1000.0 * frames / fps) <= unit / 2 + 1e-6
    assert max(each) - min(each) <= unit
