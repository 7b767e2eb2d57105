"""The example of a whole body does what it says."""

from __future__ import annotations

import importlib.util
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.support.processes import python

ROOT = Path(__file__).resolve().parents[3]


def example(*args: object) -> subprocess.CompletedProcess[str]:
    """Runs it as a person would; one thread, for small matrices need no more."""
    return python("examples/body.py", *args, OMP_NUM_THREADS="1")


@pytest.fixture(scope="module", params=["humanoid", "backflip"])
def ran(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[subprocess.CompletedProcess[str], Path]:
    picture = tmp_path_factory.mktemp("body") / "body.png"
    data = ("--data", request.getfixturevalue("shared_data")) * (request.param == "backflip")
    return example(*data, "--out", picture), picture


def test_the_quadratic_encoder_knows_a_held_out_body_better_than_the_mean_pose(
    ran: tuple[subprocess.CompletedProcess[str], Path],
) -> None:
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


def test_the_picture_shows_both_bodies(ran: tuple[subprocess.CompletedProcess[str], Path]) -> None:
    _, path = ran
    with Image.open(path) as picture:
        colours = {colour for _, colour in picture.convert("RGB").getcolors(1 << 20)}
    assert {(120, 120, 120), (30, 90, 200)} <= colours


def test_the_humanoid_turns_within_its_ranges_and_stands_on_the_floor() -> None:
    pytest.importorskip("gymnasium")
    spec = importlib.util.spec_from_file_location("body", ROOT / "examples" / "body.py")
    body = importlib.util.module_from_spec(spec)
    sys.modules["body"] = body
    spec.loader.exec_module(body)
    motion = body.humanoid()
    placed = motion.place()
    feet = placed.ends[:, [motion.index(n) for n in ("left_foot", "right_foot")], 1]
    hands = placed.ends[:, [motion.index(n) for n in ("left_lower_arm", "right_lower_arm")], 1]
    # The centres of the spheres at the ends, whose radii are 75 and 40 mm.
    assert np.all(np.minimum(feet.min(axis=1) - 0.075, hands.min(axis=1) - 0.04) > -1e-9)
    assert np.median(feet.min(axis=1)) == pytest.approx(0.075, abs=1e-6)
    assert np.allclose(motion.rotations @ motion.rotations.swapaxes(-1, -2), np.eye(3))
    again = body.humanoid()
    assert np.array_equal(motion.rotations, again.rotations)


def test_a_missing_recording_is_one_clear_line(tmp_path: Path) -> None:
    result = example("--data", tmp_path)
    assert result.returncode == 2
    assert "no such file" in result.stderr and str(tmp_path) in result.stderr
    assert "Traceback" not in result.stderr
