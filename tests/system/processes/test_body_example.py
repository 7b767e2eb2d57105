"""The example of a whole body does what it says."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

ROOT = Path(__file__).resolve().parents[3]


def example(*args: object) -> subprocess.CompletedProcess[str]:
    """Runs it as a person would; one thread, for small matrices need no more."""
    return subprocess.run(
        [sys.executable, "examples/body.py", *map(str, args)],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture(scope="module")
def ran(shared_data, tmp_path_factory):
    picture = tmp_path_factory.mktemp("body") / "body.png"
    return example("--data", shared_data, "--out", picture), picture


def test_the_quadratic_encoder_knows_a_held_out_body_better_than_the_mean_pose(ran):
    result, _ = ran
    assert result.returncode == 0, result.stderr
    rows = {
        line[:12].strip(): [float(word) for word in line[12:].split()]
        for line in result.stdout.splitlines()
        if line.startswith(("mean pose", "linear", "quadratic"))
    }
    assert set(rows) == {"mean pose", "linear", "quadratic"}
    assert all(q < m for q, m in zip(rows["quadratic"], rows["mean pose"], strict=True))
    assert rows["quadratic"][2] < 0.7 * rows["mean pose"][2]
    assert rows["quadratic"][2] < rows["linear"][2]


def test_the_picture_shows_both_bodies(ran):
    _, path = ran
    with Image.open(path) as picture:
        colours = {colour for _, colour in picture.convert("RGB").getcolors(1 << 20)}
    assert {(120, 120, 120), (30, 90, 200)} <= colours


def test_a_missing_recording_is_one_clear_line(tmp_path):
    result = example("--data", tmp_path)
    assert result.returncode == 2
    assert "no such file" in result.stderr and str(tmp_path) in result.stderr
    assert "Traceback" not in result.stderr
