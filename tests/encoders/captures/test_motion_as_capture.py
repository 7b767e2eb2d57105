"""Motion in the files of other programs becomes a capture: BVH, ASF/AMC, Vicon V with its VSK."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from encoders.store import load_capture
from models.motion.asf import AmcWriter
from models.motion.bvh import BvhWriter
from models.motion.vicon_v import VWriter
from models.pose import joint_vectors
from models.rotations import geodesic_angle
from sandbox.cli.main import main
from tests.support.hand_recording import RATE, Truth, played, touch_log, write_shown
from tests.support.motion_poses import written

AHEAD = 1.25

CORNERS = {
    "z": "top_left = [0, 0, 0]\ntop_right = [1, 0, 0]\nbottom_left = [0, -1, 0]",
    "y": "top_left = [0, 0, 0]\ntop_right = [1, 0, 0]\nbottom_left = [0, 0, 1]",
}
"""By the axis that points up in the file."""

KINDS = {"bvh": (BvhWriter, "y"), "amc": (AmcWriter, "y"), "v": (VWriter, "z")}


@pytest.fixture(scope="module")
def truth() -> Truth:
    return played(8.0, seed=3)


@pytest.fixture(scope="module")
def folder(truth: Truth, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One session: touches, and the hand in every format."""
    folder = tmp_path_factory.mktemp("session")
    write_shown(folder / "shown.jsonl", touch_log(truth, AHEAD))
    for kind, (make, _) in KINDS.items():
        written(lambda a, m=make, k=kind: m(folder / f"hand.{k}", a, RATE), truth.skeleton, truth.q)  # type: ignore[misc]
    for up, corners in CORNERS.items():
        (folder / f"{up}.toml").write_text(f"[surface]\n{corners}\n")
    return folder


def converted(folder: Path, kind: str, out: Path, *more: object) -> int:
    up, hand = KINDS[kind][1], folder / f"hand.{kind}"
    recorded = f"--touches {folder}/shown.jsonl --joints {hand} --mapping {folder}/{up}.toml"
    line = f"capture {recorded} --offset {AHEAD} --simulated --out {out}"
    return main([*line.split(), *map(str, more)])


@pytest.mark.parametrize("kind", KINDS)
def test_motion_of_every_kind_becomes_the_capture_that_it_was(
    folder: Path, truth: Truth, tmp_path: Path, kind: str
) -> None:
    assert converted(folder, kind, tmp_path / "c.npz") == 0
    capture = load_capture(tmp_path / "c.npz")
    rows = np.clip(np.round((capture.time + AHEAD) * RATE).astype(int), 0, len(truth.time) - 1)
    assert len(capture) > 0.4 * (truth.down.sum(axis=1) > 1).sum()
    assert (capture.down == truth.down[rows]).all(axis=1).mean() > 0.95
    # The grid of 30 Hz lies between frames of 60 Hz; joints show no twist of the last bones.
    off = np.rad2deg(geodesic_angle(joint_vectors(capture.q), joint_vectors(truth.q[rows])))
    assert off.mean() < 4.0
    assert np.linalg.norm(capture.q[:, :3] - truth.q[rows, :3], axis=1).mean() < 0.004
    assert abs(capture.meta["conversion"]["hand_scale"] - 0.95) < 0.01


def test_a_motion_without_its_skeleton_says_what_is_missing(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for kind, skeleton in (("amc", ".asf"), ("v", ".vsk")):
        for name in ("shown.jsonl", "y.toml", "z.toml", f"hand.{kind}"):
            shutil.copy(folder / name, tmp_path / name)
        assert converted(tmp_path, kind, tmp_path / "c.npz") == 2
        said = capsys.readouterr().err
        assert "the skeleton file is missing" in said and f"--skeleton FILE{skeleton}" in said
        shutil.copy(folder / f"hand{skeleton}", tmp_path / f"elsewhere{skeleton}")
        elsewhere = tmp_path / f"elsewhere{skeleton}"
        assert converted(tmp_path, kind, tmp_path / "c.npz", "--skeleton", elsewhere) == 0
        assert converted(tmp_path, kind, tmp_path / "c.npz", "--skeleton", tmp_path / "y.toml") == 2
        assert "y.toml" in capsys.readouterr().err


def test_a_skeleton_alone_and_a_body_without_fingers_are_refused(
    folder: Path, shared_data: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out, mapping = str(folder / "no.npz"), ["--mapping", str(folder / "y.toml")]
    for name, why in (
        (folder / "hand.asf", "give the motion"),
        (folder / "hand.vsk", "give the motion"),
        (shared_data / "formats" / "backflip.amc", "not recognised"),
        (folder / "hand.amc", "--joints-rate"),
    ):
        more = ["--joints-rate", "-5"] if "rate" in why else []
        assert main(["capture", "--joints", str(name), *mapping, *more, "--out", out]) == 2
        assert why in capsys.readouterr().err


def test_the_rate_of_a_foreign_amc_file_comes_from_an_option(
    folder: Path, truth: Truth, tmp_path: Path
) -> None:
    for name in ("shown.jsonl", "y.toml", "hand.asf"):
        shutil.copy(folder / name, tmp_path / name)
    text = (folder / "hand.amc").read_text()
    assert text.startswith("#!keys a second: 60\n")
    (tmp_path / "hand.amc").write_text(text.partition("\n")[2])
    assert converted(tmp_path, "amc", tmp_path / "c.npz", "--joints-rate", RATE) == 0
    # Without being told, the hand would be twice as fast as its touches.
    assert converted(tmp_path, "amc", tmp_path / "d.npz") == 2 or len(
        load_capture(tmp_path / "d.npz")
    ) < len(load_capture(tmp_path / "c.npz"))
