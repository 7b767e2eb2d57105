"""`sandbox capture` from files, as a person would run it."""

from __future__ import annotations

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from encoders.capture import Capture, load_capture
from models.errors import InputError, MotionError
from models.frames import Contact, TouchFrame
from models.motion.asf import AmcWriter
from models.motion.bvh import BvhWriter
from models.motion.pose_table import COLUMNS, read_pose_table
from models.motion.vicon_v import VWriter
from models.pose import joint_vectors
from models.reader_report import ReaderReport
from models.rotations import geodesic_angle
from models.surface import Surface
from sandbox.cli.main import main
from sandbox.devices.files.touch_log_file import read_touch_log
from sandbox.recording.recording import RecordingWriter
from tests.support.hand_recording import (
    RATE,
    SCALE,
    Truth,
    markers,
    played,
    touch_log,
    write_pose_table,
    write_shown,
    write_tsv,
)
from tests.support.motion_poses import written
from tests.support.tuio_packets import frame as tuio_frame

AHEAD = 1.25
WIDTH, HEIGHT = 0.3, 0.25

CORNERS = "[surface]\ntop_left = [0, 0, 0]\ntop_right = [1, 0, 0]\nbottom_left = "
WRITERS = {"bvh": (BvhWriter, "y"), "amc": (AmcWriter, "y"), "v": (VWriter, "z")}
"""By the file's ending, and the axis that points up in it."""


@pytest.fixture(scope="module")
def truth() -> Truth:
    return played(12.0, seed=3)


@pytest.fixture(scope="module")
def folder(truth: Truth, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Files of one session, as different recorders would write them."""
    folder = tmp_path_factory.mktemp("session")
    write_shown(folder / "shown.jsonl", touch_log(truth, AHEAD))
    write_tsv(folder / "hand.tsv", markers(truth))
    write_pose_table(folder / "hand.csv", truth.time, truth.q)
    for kind, (make, _) in WRITERS.items():
        written(lambda a, m=make, k=kind: m(folder / f"hand.{k}", a, RATE), truth.skeleton, truth.q)  # type: ignore[misc]
    (folder / "z.toml").write_text(CORNERS + "[0, -1, 0]\n")
    (folder / "y.toml").write_text(CORNERS + "[0, 0, 1]\n")
    return folder


def converted(capsys: pytest.CaptureFixture[str], *words: object) -> tuple[int, str, str]:
    """Exit status of a command of these words, what was printed and what was complained about."""
    status = main(["capture", *" ".join(map(str, words)).split()])
    said = capsys.readouterr()
    return status, said.out, said.err


def assert_as_played(
    path: Path, truth: Truth, degrees: float, wrist: float, ahead: float = AHEAD
) -> Capture:
    capture = load_capture(path)
    rows = np.clip(np.round((capture.time + ahead) * RATE).astype(int), 0, len(truth.time) - 1)
    assert len(capture) > 0.4 * (truth.down.sum(axis=1) > 1).sum()
    # The grid of 30 Hz lies between frames of 60 Hz, so that edges may fall to either side.
    assert (capture.down == truth.down[rows]).all(axis=1).mean() > 0.95
    off = geodesic_angle(joint_vectors(capture.q), joint_vectors(truth.q[rows]))
    assert np.rad2deg(off).mean() < degrees
    assert np.linalg.norm(capture.q[:, :3] - truth.q[rows, :3], axis=1).mean() < wrist
    return capture


@pytest.mark.parametrize("kind", WRITERS)
def test_touches_and_motion_become_a_capture_by_taps(
    folder: Path, truth: Truth, capsys: pytest.CaptureFixture[str], tmp_path: Path, kind: str
) -> None:
    status, out, err = converted(
        capsys,
        f"--touches {folder}/shown.jsonl --joints {folder}/hand.{kind} --sync tap --subject P07",
        f"--mapping {folder}/{WRITERS[kind][1]}.toml --out {tmp_path}/c.npz --simulated",
    )
    assert status == 0, err
    assert "with one finger" in out and "taps agreeing" in out and "offset" in out
    # Joints show no twist of the last bones.
    capture = assert_as_played(tmp_path / "c.npz", truth, degrees=4.0, wrist=0.004)
    assert capture.meta["subject"] == "P07" and capture.meta["simulated"] is True
    found = capture.meta["conversion"]
    assert abs(found["offset_s"] - AHEAD) < 1 / RATE and abs(found["hand_scale"] - SCALE) < 0.01


def test_markers_alone_become_a_capture(
    folder: Path, truth: Truth, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    status, out, err = converted(
        capsys,
        f"--markers {folder}/hand.tsv --mapping {folder}/z.toml --out {tmp_path}/c.npz",
    )
    assert status == 0, err
    assert "within 5 mm" in out
    capture = assert_as_played(tmp_path / "c.npz", truth, degrees=8.0, wrist=0.010, ahead=0.0)
    rows = np.round(capture.time * RATE).astype(int)
    both = capture.down & truth.down[rows]
    assert np.linalg.norm(capture.xy - truth.xy[rows], axis=2)[both].mean() < 0.006


def test_a_left_hand_comes_out_as_its_mirror_image(
    folder: Path, truth: Truth, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    points = {name: p * [-1.0, 1.0, 1.0] for name, p in markers(truth).items()}
    write_tsv(tmp_path / "left.tsv", points)
    log = touch_log(truth, AHEAD)
    write_shown(tmp_path / "left.jsonl", replace(log, xy=log.xy * [-1.0, 1.0]))
    shutil.copy(folder / "z.toml", tmp_path)
    status, _, err = converted(
        capsys,
        f"--touches {tmp_path}/left.jsonl --markers {tmp_path}/left.tsv --side left",
        f"--mapping {tmp_path}/z.toml --offset {AHEAD} --out {tmp_path}/c.npz",
    )
    assert status == 0, err
    capture = assert_as_played(tmp_path / "c.npz", truth, degrees=8.0, wrist=0.010)
    assert (capture.meta["side"], capture.meta["recorded_side"]) == ("right", "left")


def test_a_packet_capture_and_a_recording_say_the_same(
    folder: Path, truth: Truth, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    log = touch_log(truth, AHEAD)
    shown = [
        {int(log.ids[r]): log.xy[r] for r in np.flatnonzero(log.frame == f)}
        for f in range(len(log.time))
    ]
    with (tmp_path / "packets.jsonl").open("w") as file:
        for number, (time, touches) in enumerate(zip(log.time, shown, strict=True), start=1):
            scaled = {i: (x / WIDTH, y / HEIGHT) for i, (x, y) in touches.items()}
            data = tuio_frame(number, scaled, source="tablet")
            file.write(json.dumps({"t": float(time), "hex": data.hex()}) + "\n")
    writer = RecordingWriter(tmp_path / "run.jsonl", {"settings": {"timestep": 0.002}})
    for step, (time, touches) in enumerate(zip(log.time, shown, strict=True)):
        contacts = tuple(Contact(i, float(x), float(y)) for i, (x, y) in touches.items())
        writer.input(step, 0, TouchFrame(float(time), contacts), "")
    writer.close()
    captures = []
    for file_of_touches, offset in (
        (tmp_path / "packets.jsonl", 0.0),
        (tmp_path / "run.jsonl", AHEAD),
    ):
        # A packet capture's clock begins with its first packet.
        status, _, err = converted(
            capsys,
            f"--touches {file_of_touches} --joints {folder}/hand.csv --offset {offset}",
            f"--surface {1000 * WIDTH:g}x{1000 * HEIGHT:g}mm --out {tmp_path}/c.npz",
        )
        assert status == 0, err
        assert ("breaks off" in err) == (file_of_touches.name == "run.jsonl")
        captures.append(assert_as_played(tmp_path / "c.npz", truth, 0.5, 0.001, ahead=offset))
    np.testing.assert_array_equal(captures[0].down, captures[1].down)
    np.testing.assert_allclose(captures[0].xy, captures[1].xy, atol=1e-6)


def test_the_real_glove_becomes_a_capture(
    shared_data: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    """Fingers on a pillow: a soft surface, so that 10 mm must pass for touching it."""
    status, out, err = converted(
        capsys,
        f"--markers {shared_data}/formats/hand-markers.tsv.gz --threshold 10",
        f"--out {tmp_path}/c.npz",
    )
    assert status == 0, err
    assert "hand scale" in out
    capture = load_capture(tmp_path / "c.npz")
    assert capture.meta["simulated"] is False
    # Markers are on skin and glove: they keep to a rigid skeleton within a few millimetres.
    assert capture.meta["conversion"]["residual_mm"] < 3.0
    assert len(capture) > 100 and len(np.unique(capture.trial)) > 5


@pytest.mark.parametrize(("kind", "skeleton"), [("amc", ".asf"), ("v", ".vsk")])
def test_a_motion_needs_its_skeleton_beside_it_or_by_name(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], kind: str, skeleton: str
) -> None:
    shutil.copy(folder / f"hand.{kind}", tmp_path)
    shutil.copy(folder / f"hand{skeleton}", tmp_path / f"elsewhere{skeleton}")
    line = (
        f"--touches {folder}/shown.jsonl --joints {tmp_path}/hand.{kind} --offset {AHEAD}",
        f"--mapping {folder}/{WRITERS[kind][1]}.toml --out {tmp_path}/c.npz",
    )
    status, _, err = converted(capsys, *line)
    assert status == 2 and f"--skeleton FILE{skeleton}" in err
    assert converted(capsys, *line, f"--skeleton {tmp_path}/elsewhere{skeleton}")[0] == 0
    status, _, err = converted(capsys, *line, f"--skeleton {folder}/y.toml")
    assert status == 2 and "y.toml" in err


def test_the_rate_of_a_foreign_amc_file_comes_from_an_option(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    shutil.copy(folder / "hand.asf", tmp_path)
    text = (folder / "hand.amc").read_text()
    assert text.startswith("#!keys a second: 60\n")
    (tmp_path / "hand.amc").write_text(text.partition("\n")[2])
    line = (
        f"--touches {folder}/shown.jsonl --joints {tmp_path}/hand.amc --offset {AHEAD}",
        f"--mapping {folder}/y.toml --out",
    )
    assert converted(capsys, *line, tmp_path / "c.npz", "--joints-rate", RATE)[0] == 0
    # Without the option, the hand would be twice as fast as its touches.
    assert converted(capsys, *line, tmp_path / "d.npz")[0] == 2 or len(
        load_capture(tmp_path / "d.npz")
    ) < len(load_capture(tmp_path / "c.npz"))


def test_a_body_without_fingers_is_refused(
    folder: Path, shared_data: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    status, _, err = converted(
        capsys,
        f"--joints {shared_data}/formats/backflip.amc --mapping {folder}/y.toml",
        f"--out {tmp_path}/c.npz",
    )
    assert status == 2 and "not recognised" in err


BAD = {
    "no hand": (["--touches", "shown.jsonl"], "one recording of the hand"),
    "two hands": (["--joints", "hand.bvh", "--markers", "hand.tsv"], "one recording"),
    "tap without touches": (["--markers", "hand.tsv", "--sync", "tap"], "no touches"),
    "missing file": (["--joints", "none.bvh"], "no such file"),
    "missing touches": (["--touches", "none", "--joints", "hand.csv"], "cannot be read"),
    "unknown kind": (["--joints", "shown.jsonl"], "cannot be read"),
    "no surface": (["--touches", "shown.jsonl", "--joints", "hand.bvh"], "touch surface in this"),
    "wrong unit": (
        ["--markers", "hand.tsv", "--mapping", "z.toml", "--unit", "0.1"],
        "size",
    ),
    "a skeleton alone": (["--joints", "hand.asf", "--mapping", "y.toml"], "give the motion"),
    "another skeleton alone": (["--joints", "hand.vsk", "--mapping", "y.toml"], "give the motion"),
    "bad rate of joints": (["--joints", "hand.amc", "--joints-rate", "-5"], "--joints-rate"),
    "bad rate": (["--markers", "hand.tsv", "--rate", "0"], "--rate"),
    "bad offset": (["--joints", "hand.csv", "--offset", "nan"], "--offset"),
    "bad threshold": (["--joints", "hand.csv", "--threshold", "500"], "--threshold"),
    "bad scale": (["--joints", "hand.csv", "--scale", "9"], "--scale"),
    "no folder": (["--joints", "hand.csv", "--out", "nowhere/c.npz"], "no such folder"),
    "touches that are poses": (["--touches", "hand.csv", "--joints", "hand.csv"], "touches"),
    "a mapping that is none": (["--joints", "hand.bvh", "--mapping", "hand.csv"], "damaged"),
    "clocks apart": (
        ["--touches", "shown.jsonl", "--joints", "hand.csv", "--offset", "500"],
        "no touch is near",
    ),
}


@pytest.mark.parametrize("case", BAD)
def test_what_cannot_be_converted_is_one_clear_line_and_exit_2(
    folder: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path, case: str
) -> None:
    args, message = BAD[case]
    given = [str(folder / a) if (folder / a).exists() or a.startswith("no") else a for a in args]
    out = [] if "--out" in args else ["--out", tmp_path / "c.npz"]
    status, _, err = converted(capsys, *given, *out)
    assert status == 2
    assert err.count("sandbox: ") == 1 and "Traceback" not in err
    assert message in err
    assert not (tmp_path / "c.npz").exists()


@pytest.mark.parametrize("option", ["--joints", "--touches", "--markers"])
def test_a_capture_does_not_replace_what_it_is_made_from(
    folder: Path, capsys: pytest.CaptureFixture[str], option: str
) -> None:
    name = {"--joints": "hand.csv", "--touches": "shown.jsonl", "--markers": "hand.tsv"}[option]
    source = folder / name
    kept = source.read_bytes()
    also = ["--joints", folder / "hand.csv"] if option == "--touches" else []
    status, _, err = converted(capsys, option, source, *also, "--out", source)
    assert status == 2 and "would replace a file from which it is made" in err
    assert source.read_bytes() == kept


@pytest.mark.parametrize(
    "text",
    (
        "points = 3",
        "[fingers]",
        "[surface]\ntop_left = [0, 0, 0]",
        '[surface]\ntop_left = "nowhere"\ntop_right = [1, 0, 0]\nbottom_left = [0, -1, 0]',
        "[surface]\ntop_left = [0, 0]\ntop_right = [1, 0]\nbottom_left = [0, -1]",
        "[surface]\ntop_left = [0,0,0]\ntop_right = [0,0,0]\nbottom_left = [0, -1, 0]",
        '[points]\nhand_top = "no_such_site"',
        "\0",
        "= =",
    ),
)
def test_a_mapping_file_with_a_wrong_part_is_refused(
    folder: Path, capsys: pytest.CaptureFixture[str], tmp_path: Path, text: str
) -> None:
    (tmp_path / "m.toml").write_text(text)
    status, _, err = converted(
        capsys, f"--markers {folder}/hand.tsv --mapping {tmp_path}/m.toml --out {tmp_path}/c.npz"
    )
    assert status == 2
    assert err.count("sandbox: ") == 1


def test_markers_on_the_corners_tell_where_the_surface_is(
    truth: Truth, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    places = {"c1": [0.0, 0.0, 0.0], "c2": [0.2, 0.0, 0.0], "c3": [0.0, -0.15, 0.0]}
    corners = {name: np.tile(place, (len(truth.q), 1)) for name, place in places.items()}
    # A marker at the recorder's very origin would read as one that was not seen.
    shift = np.array([0.5, 0.4, 0.3])
    points = {name: place + shift for name, place in {**markers(truth), **corners}.items()}
    write_tsv(tmp_path / "hand.tsv", points)
    (tmp_path / "m.json").write_text(
        json.dumps({"surface": {"top_left": "c1", "top_right": "c2", "bottom_left": "c3"}})
    )
    status, _, err = converted(
        capsys, f"--markers {tmp_path}/hand.tsv --mapping {tmp_path}/m.json --out {tmp_path}/c.npz"
    )
    assert status == 0, err
    assert_as_played(tmp_path / "c.npz", truth, degrees=8.0, wrist=0.010, ahead=0.0)


def test_a_table_of_poses_comes_back_to_the_bit_in_any_order_of_columns(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    time, q = np.array([0.0, 0.01, 0.3]), rng.normal(size=(3, 48))
    path = tmp_path / "poses.csv"
    write_pose_table(path, time, q)
    for name, got in zip(("time", "q"), read_pose_table(path, ReaderReport()), strict=True):
        np.testing.assert_array_equal(got, {"time": time, "q": q}[name])
    rows = [line.split(",") for line in path.read_text().splitlines()]
    order = rng.permutation(49)
    path.write_text("\n".join(",".join(row[i] for i in order) for row in rows))
    np.testing.assert_array_equal(read_pose_table(path, ReaderReport())[1], q)
    numbered = {name: f"q{i}" for i, name in enumerate(COLUMNS)}
    head = ",".join(numbered.get(rows[0][i], "time") for i in order)
    path.write_text("\n".join([head, *path.read_text().splitlines()[1:]]))
    np.testing.assert_array_equal(read_pose_table(path, ReaderReport())[1], q)


@pytest.mark.parametrize(
    ("old", "new"),
    (
        ("time", "t"),
        ("index_mcp_rx", "index_mcp_rw"),
        ("index_mcp_rx", "root_x"),
        ("0.25", "nan"),
        ("0.25", "zero"),
        ("0.25", "0.25,1"),
        ("0.5,", "0.0,"),
        ("\n0.0,", "\n0.9,"),
    ),
)
def test_a_table_with_a_wrong_part_is_refused_and_named(tmp_path: Path, old: str, new: str) -> None:
    path = tmp_path / "poses.csv"
    write_pose_table(path, np.array([0.0, 0.5]), np.full((2, 48), 0.25))
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(MotionError, match=r"poses\.csv"):
        read_pose_table(path, ReaderReport())
    path.write_text(text.splitlines()[0])
    with pytest.raises(MotionError, match="no pose"):
        read_pose_table(path, ReaderReport())


def test_touches_at_a_guessed_size_are_stretched_to_the_measured_one(tmp_path: Path) -> None:
    lines = [
        {"surface_in": [8.0, 6.0], "surface_calibrated": False, "device": "tuio"},
        {"time": 0.0, "contacts": [{"id": 1, "x": 8.0, "y": 3.0, "finger": None}]},
    ]
    file = tmp_path / "touches.jsonl"
    file.write_text("".join(json.dumps(line) + "\n" for line in lines))
    log, said = read_touch_log(file, None)
    assert "a guess: give --surface" in said
    np.testing.assert_allclose(log.xy, [[8.0 * 0.0254, 3.0 * 0.0254]])
    log, said = read_touch_log(file, Surface(12.0, 9.0))
    assert not said
    np.testing.assert_allclose(log.xy, [[12.0 * 0.0254, 4.5 * 0.0254]])
    lines[0]["surface_calibrated"] = True
    file.write_text("".join(json.dumps(line) + "\n" for line in lines))
    with pytest.raises(InputError, match="is not that of --surface"):
        read_touch_log(file, Surface(12.0, 9.0))
    assert read_touch_log(file, Surface(8.0, 6.02))[1] == ""
