"""The examples run as their docstrings say, and are short enough to be read."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from tests.support.processes import ROOT, python

EXAMPLES = ROOT / "examples"


def run(name: str, folder: Path, *arguments: str) -> str:
    """Runs an example in a folder; what it prints."""
    program = (
        f"import sys, runpy; sys.argv[1:] = {arguments!r}\n"
        f"runpy.run_path({str(EXAMPLES / name)!r}, run_name='__main__')"
    )
    answer = python("-c", program, cwd=folder, OPENBLAS_NUM_THREADS="1")
    assert answer.returncode == 0, answer.stderr
    assert "Warning" not in answer.stderr
    return answer.stdout


def test_a_trial_is_run_replayed_and_exported_from_python(tmp_path: Path) -> None:
    told = run("run_a_trial.py", tmp_path, "out")
    periods = re.search(r"(\d+) control periods", told)
    assert "success True" in told and periods
    assert f"hand poses ({periods[1]}, 48)" in told
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert {"run.jsonl", "objects.csv", "hands.csv", "touches.csv"} <= names
    told = run("replay_and_export.py", tmp_path, "out/run.jsonl", "exported")
    assert "box-to-goal, seed 3" in told and "exact True" in told
    names = {path.name for path in (tmp_path / "exported").iterdir()}
    assert {"hand.bvh", "hand.glb", "tips.csv", "objects.csv"} <= names


@pytest.mark.needs("opengl")
def test_the_film_of_a_trial_comes_as_an_array(tmp_path: Path) -> None:
    told = run("run_a_trial.py", tmp_path, "out", "--film")
    film = re.search(r"film \((\d+), 180, 320, 3\), uint8", told)
    assert film and int(film[1]) > 60


def test_an_encoder_is_trained_saved_and_asked_from_python(tmp_path: Path) -> None:
    told = run("train_and_predict.py", tmp_path)
    assert "7083 frames" in told and "pose (48,)" in told
    assert (tmp_path / "mine.npz").is_file()
