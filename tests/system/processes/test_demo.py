"""The first thing a new user runs, as a new user runs it."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from tests.support.processes import python

ROOT = Path(__file__).parents[3]


def demo(folder: Path, *options: str, **environment: Any) -> subprocess.CompletedProcess:
    no_screen: dict[str, Any] = {"DISPLAY": None, "WAYLAND_DISPLAY": None, "COLUMNS": "200"}
    command = ("-m", "sandbox.cli.main", "demo", *options)
    return python(*command, cwd=folder, **no_screen, **environment)


@pytest.mark.needs("opengl")
def test_the_demo_succeeds_and_leaves_a_film_and_a_picture(tmp_path: Path) -> None:
    done = demo(tmp_path)
    assert done.returncode == 0, done.stderr
    assert "box-to-goal: done" in done.stdout
    assert "simulated" in done.stdout
    film: Any
    with Image.open(tmp_path / "sandbox-demo" / "demo.webp") as film:
        # Still moments are one long frame, so that there are fewer frames than pictures.
        assert film.n_frames > 30
        first = film.convert("L").resize((64, 36)).tobytes()
        film.seek(film.n_frames - 1)
        assert film.convert("L").resize((64, 36)).tobytes() != first
    with Image.open(tmp_path / "sandbox-demo" / "demo.png") as picture:
        assert len(picture.convert("RGB").getcolors(10**6)) > 1000


def test_without_opengl_the_demo_plays_and_scores_and_says_what_is_missing(tmp_path: Path) -> None:
    done = demo(tmp_path, MUJOCO_GL="disabled")
    assert done.returncode == 0, done.stderr
    assert "box-to-goal: done" in done.stdout
    assert "no film" in done.stdout and "MUJOCO_GL" in done.stdout


def test_a_folder_that_cannot_be_written_costs_the_film_only(tmp_path: Path) -> None:
    (tmp_path / "sandbox-demo").write_text("a file is in the way")
    done = demo(tmp_path)
    assert done.returncode == 0, done.stderr
    assert "box-to-goal: done" in done.stdout and "no film" in done.stdout
