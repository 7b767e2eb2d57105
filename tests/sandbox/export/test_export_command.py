"""`sandbox export`: what is written is the hand that was recorded, whichever way it goes there."""

from __future__ import annotations

import gzip
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest

from encoders.capture import Capture, save_capture
from models.arithmetic import Array
from models.motion.armature import Y_UP, Armature, Keys
from models.motion.bvh import BvhWriter, read_bvh
from models.motion.sampling import Sampler
from models.rotations import quaternion_exp
from models.skeleton import ADULT
from sandbox.cli.main import main
from sandbox.export.sources import commanded_poses
from sandbox.export.targets import MotionView, simulated_poses
from sandbox.recording.recording import RecordingWriter
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.driver import View, play_trial
from sandbox.trial.settings import encoded
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.motion_poses import moving

BOTH: dict[Literal["simulated", "commanded"], Any] = {
    "simulated": simulated_poses,
    "commanded": commanded_poses,
}


Recorded = tuple[Path, dict[str, list[Keys]], dict[float, Array]]
"""Folder of a session's files, keys by kind of motion, and fingertips (5, 3) m by time."""


@pytest.fixture(scope="module")
def session(tmp_path_factory: pytest.TempPathFactory) -> Recorded:
    """A recorded trial; BVHs that views wrote meanwhile; and the keys somebody else collected."""
    folder = tmp_path_factory.mktemp("session")
    chosen = trial_settings(TrialOptions(seed=3, fingers=3))
    sampler = {of: Sampler((Armature(ADULT),), 60.0) for of in BOTH}
    keys: dict[str, list[Keys]] = {of: [] for of in BOTH}
    open_views, tips = [], {}

    def views(session: Session) -> Sequence[View]:
        for of in BOTH:
            open_views.append(MotionView(folder / f"{of}.bvh", session, of=of))
            open_views[-1].__enter__()

        def collect(snapshot: Snapshot) -> None:
            tips[snapshot.time] = snapshot.hands[0].tips
            for of, poses in BOTH.items():
                found = sampler[of].add(poses(snapshot))
                if found is not None:
                    keys[of].append(found[0])

        return [*(view.show for view in open_views), collect]

    play_trial(chosen, device_makers(chosen), views, record=folder / "run.jsonl")
    for view in open_views:
        view.__exit__(None, None, None)
    return folder, keys, tips


@pytest.fixture(scope="module")
def two_hands(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[Array]]:
    """A recording of two hands whose poses are known, and the poses."""
    path = tmp_path_factory.mktemp("two") / "two.jsonl"
    settings = encoded(trial_settings(TrialOptions(task="carry-together", seed=1)))
    assert [hand["side"] for hand in settings["hands"]] == ["right", "left"]
    q = [moving(ADULT, 200, seed, rate=62.5) for seed in (1, 2)]
    writer = RecordingWriter(path, {"settings": settings})
    for i in range(200):
        hands = [np.r_[p[i, :3], quaternion_exp(p[i, 3:].reshape(15, 3)).ravel()] for p in q]
        row = np.concatenate([*hands, np.zeros(7)])
        writer.state(8 * i, np.zeros(3), "", row, [frozenset(), frozenset()])
    writer.end(1600, {"state_hash": ""})
    writer.close()
    return path, q


@pytest.mark.parametrize("of", BOTH)
def test_a_session_to_keys_to_bvh_is_the_bvh_that_was_written_directly(
    session: Recorded, of: str, tmp_path: Path
) -> None:
    folder, keys, _ = session
    with BvhWriter(tmp_path / "keys.bvh", Armature(ADULT), 60.0) as writer:
        for some in keys[of]:
            writer.write(some)
    assert (tmp_path / "keys.bvh").read_bytes() == (folder / f"{of}.bvh").read_bytes()


def test_a_recording_played_again_commands_to_the_bit_what_was_commanded(
    session: Recorded, tmp_path: Path
) -> None:
    folder, _, _ = session
    out = tmp_path / "again.bvh"
    assert main(["export", str(folder / "run.jsonl"), "--to", str(out), "--of", "commanded"]) == 0
    assert out.read_bytes() == (folder / "commanded.bvh").read_bytes()


def test_a_recordings_own_poses_are_the_simulated_hand_to_what_it_rounds(
    session: Recorded, tmp_path: Path
) -> None:
    folder, _, tips = session
    out = tmp_path / "hand.bvh"
    line = ["export", str(folder / "run.jsonl"), "--to", str(out), "--rate", "62.5"]
    assert main(line) == 0
    motion = read_bvh(out)
    found = motion.place().ends[:, [motion.index(n) for n in ("thumb_mcp", "index_dip")]]
    checked = 0
    for time, places in tips.items():
        # The track begins at step 0, 62.5 poses a second.
        at = round(time * 62.5)
        if at < len(found):
            # A snapshot's fingertips are those of the last physics step but one, 2 ms before.
            assert np.abs(found[at] - places[:2] @ Y_UP.T).max() < 3e-3
            checked += 1
    assert checked > 100


@pytest.mark.parametrize("kind", [".csv", ".c3d", ".glb", ".amc", ".asf", ".v", ".vsk"])
def test_every_format_is_written(session: Recorded, tmp_path: Path, kind: str) -> None:
    out = tmp_path / f"hand{kind}"
    assert main(["export", str(session[0] / "run.jsonl"), "--to", str(out)]) == 0
    beside = {".amc": {"hand.asf"}, ".asf": {"hand.amc"}, ".v": {"hand.vsk"}}.get(kind, set())
    assert {path.name for path in tmp_path.iterdir()} == {out.name, *beside}


def test_two_hands_go_into_two_files_or_one(
    two_hands: tuple[Path, list[Array]], tmp_path: Path
) -> None:
    path, q = two_hands
    assert main(["export", str(path), "--to", str(tmp_path / "h.bvh"), "--rate", "62.5"]) == 0
    for name, poses, skeleton in (("right", q[0], ADULT), ("left", q[1], ADULT.mirrored())):
        motion = read_bvh(tmp_path / f"h-{name}.bvh")
        joints, _ = Armature(skeleton).place(Armature(skeleton).keys(poses))
        found = motion.place().positions[:, [motion.index(n) for n in Armature(skeleton).names]]
        # A track rounds quaternions to 2e-5.
        assert np.abs(found - joints @ Y_UP.T).max() < 1e-4
    fingers = ["--fingers", "index", "thumb"]
    assert main(["export", str(path), "--to", str(tmp_path / "h.csv"), *fingers]) == 0
    head = (tmp_path / "h.csv").read_text().splitlines()[0].split(",")
    names = ["right_thumb_tip", "right_index_tip", "left_thumb_tip", "left_index_tip"]
    assert head == ["time", *(f"{name}_{axis}" for name in names for axis in "xyz")]


def test_a_take_of_a_capture_is_its_poses(tmp_path: Path) -> None:
    q = moving(ADULT, 90, 4, rate=30)
    time = np.r_[np.arange(40), np.arange(50)] / 30
    xy = np.zeros((90, 5, 2))
    trial = np.repeat([3, 8], [40, 50])
    ids = np.tile(np.arange(5), (90, 1))
    save_capture(Capture(time, trial, ids, xy, q, {"simulated": True}), tmp_path / "c.npz")
    line = ["export", str(tmp_path / "c.npz"), "--to", str(tmp_path / "c.bvh"), "--rate", "30"]
    assert main([*line, "--take", "2"]) == 0
    motion = read_bvh(tmp_path / "c.bvh")
    joints, _ = Armature(ADULT).place(Armature(ADULT).keys(q[40:]))
    found = motion.place().positions[:, [motion.index(n) for n in Armature(ADULT).names]]
    assert np.abs(found - joints @ Y_UP.T).max() < 1e-6
    assert main([*line, "--take", "3"]) == 2


def test_a_recording_that_breaks_off_is_written_up_to_there(
    two_hands: tuple[Path, list[Array]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, _ = two_hands
    text = path.read_text().splitlines()
    tracks = [i for i, line in enumerate(text) if '"kind":"track"' in line]
    cut = tmp_path / "cut.jsonl"
    cut.write_text("\n".join([*text[: tracks[2]], text[tracks[2]][:-300]]) + "\n")
    assert main(["export", str(cut), "--to", str(tmp_path / "h.csv")]) == 0
    assert f"line {tracks[2] + 1} is damaged" in " ".join(capsys.readouterr().err.split())
    table = np.loadtxt(tmp_path / "h.csv", delimiter=",", skiprows=1)
    # Two lines of a second's poses each are whole.
    assert 1.9 < table[-1, 0] < 2.0


def test_a_recording_that_is_cut_before_its_first_pose_says_so_and_names_itself(
    two_hands: tuple[Path, list[Array]], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    lines = two_hands[0].read_bytes().splitlines(keepends=True)
    first = next(i for i, line in enumerate(lines) if b'"kind":"track"' in line[:20])
    cut = tmp_path / "cut.jsonl"
    cut.write_bytes(b"".join(lines[:first]) + lines[first][:60])
    assert main(["export", str(cut), "--to", str(tmp_path / "cut.csv")]) != 0
    said = capsys.readouterr().err
    assert "cut.jsonl: the recording ends before the first pose" in said and "cut.csv" not in said


def test_a_compressed_recording_is_the_same_to_the_bit(
    session: Recorded, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, _, _ = session
    packed = tmp_path / "run.jsonl.gz"
    packed.write_bytes(gzip.compress((folder / "run.jsonl").read_bytes()))
    for of in BOTH:
        outs = [tmp_path / f"{of}-{name}.bvh" for name in ("plain", "packed")]
        for source, out in zip((folder, tmp_path), outs, strict=True):
            line = ["export", str(source / "run.jsonl"), "--to", str(out), "--of", of]
            assert main(line) == 0
        assert outs[0].read_bytes() == outs[1].read_bytes()
    whole = packed.read_bytes()
    packed.write_bytes(whole[: len(whole) // 2])
    capsys.readouterr()
    assert main(["export", str(tmp_path / "run.jsonl"), "--to", str(tmp_path / "cut.csv")]) == 0
    assert "is damaged" in capsys.readouterr().err
    table = np.loadtxt(tmp_path / "cut.csv", delimiter=",", skiprows=1)
    assert 0.5 < table[-1, 0] < 5.0


def test_what_cannot_be_exported_is_refused_in_one_line(
    session: Recorded, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, _, _ = session
    run = str(folder / "run.jsonl")
    (tmp_path / "notes.txt").write_text("no recording")
    (tmp_path / "zip.npz").write_bytes(b"PK\3\4 no capture")
    settings = encoded(trial_settings(TrialOptions(seed=1)))
    header = {"kind": "header", "schema": 2, "settings": settings}
    (tmp_path / "empty.jsonl").write_text(json.dumps(header) + "\n")
    (tmp_path / "other.jsonl").write_text(json.dumps({**header, "schema": 99}) + "\n")
    writer = RecordingWriter(tmp_path / "scene.jsonl", {"settings": settings})
    writer.state(0, np.zeros(3), "", np.zeros(9), [frozenset()])
    writer.end(8, {"state_hash": ""})
    writer.close()
    (tmp_path / "run.csv").write_bytes((folder / "run.jsonl").read_bytes())
    out = str(tmp_path / "out.bvh")
    for line, why in (
        ([str(tmp_path / "none.jsonl"), "--to", out], "no such recording"),
        ([str(tmp_path), "--to", out], "this folder has no recordings"),
        ([str(tmp_path), "--to", "a.bvh", "--points", "joints"], "--points: this option has no"),
        ([str(tmp_path / "notes.txt"), "--to", out], "neither a recording nor a capture"),
        ([str(tmp_path / "zip.npz"), "--to", out], "zip.npz"),
        ([str(tmp_path / "empty.jsonl"), "--to", out], "has no poses"),
        ([str(tmp_path / "other.jsonl"), "--to", out], "another version"),
        ([str(tmp_path / "scene.jsonl"), "--to", out], "another scene"),
        ([run, "--to", str(tmp_path / "out.fbx")], "--out FILE, and stream the recording"),
        ([run, "--to", str(tmp_path / "out.obj")], "cannot be written"),
        ([run, "--to", str(tmp_path / "no" / "out.bvh")], "no such folder"),
        ([run, "--to", out, "--rate", "nan"], "out of range"),
        ([str(tmp_path / "run.csv"), "--to", str(tmp_path / "run.csv")], "would replace"),
    ):
        assert main(["export", *line]) == 2, line
        said = capsys.readouterr().err.strip().splitlines()
        assert len([t for t in said if t.startswith("sandbox: ")]) == 1 and why in said[-1], said
    assert not Path(out).exists() and not list(tmp_path.glob("*.part"))


def test_a_session_that_is_stopped_keeps_its_motion_and_a_broken_one_leaves_none(
    tmp_path: Path,
) -> None:
    chosen = trial_settings(TrialOptions(seed=3))
    for error, kept in ((KeyboardInterrupt, True), (ValueError, False)):
        path = tmp_path / f"{error.__name__}.bvh"
        session = build(chosen, device_makers(chosen))
        with pytest.raises(error), MotionView(path, session) as view:
            for _ in range(20):
                view.show(session.advance())
            raise error
        assert path.exists() == kept
    assert len(read_bvh(tmp_path / "KeyboardInterrupt.bvh")) == 19
