"""`sandbox paalm`, `devices leap` and `evaluate --paalm` do what their help says."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from sandbox.cli.main import main
from sandbox.devices.leap.leap_fake import FakeLeapd
from sandbox.devices.leap.leap_file import read_leap
from sandbox.devices.leap.leap_write import write_take
from tests.support.leap_hands import take


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    path = tmp_path / "hand.json"
    write_take(take(1), path, {"seed": 1})
    return path


def shown(capsys: pytest.CaptureFixture[str]) -> list[dict[str, Any]]:
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def test_show_says_every_frame_as_a_line_of_json(
    recording: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["paalm", "show", str(recording), "--json"]) == 0
    lines = shown(capsys)
    assert len(lines) == len(take(1).frames)
    last = lines[-1]["hands"]["right"]
    assert len(last["angles"]) == 20 and set(last["ratios"]) == set(last["ids"])
    assert {f for f, i in last["ids"].items() if i is None} == set(last["held"])


def test_a_calibration_measured_once_serves_again(
    recording: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "c.json"
    args = ["paalm", "calibrate", str(recording), "--hands", "right", "--frames", "120"]
    assert main([*args, "--out", str(out)]) == 0
    (summary,) = shown(capsys)
    assert summary["hands"]["right"]["frames"] >= 100
    show = ["paalm", "show", str(recording), "--calibration", str(out), "--json"]
    assert main([*show, "--seconds", "0.5"]) == 0
    assert 45 <= len(shown(capsys)) <= 52


def test_a_running_service_is_shown_as_its_recording_is(
    recording: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    server = FakeLeapd(read_leap(recording).messages, port=0, rate=400.0, loop=True)
    try:
        args = ["paalm", "show", "--device", "leap", "--address", server.address, "--json"]
        assert main([*args, "--frames", "60", "--seconds", "0.5"]) == 0
    finally:
        server.close()
    assert len(shown(capsys)) > 20


def test_a_real_recording_needs_no_average_hand(
    shared_data: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    # The first one has open hands here and there; the second one's device knows bones.
    for name, frames in (("v1-hands.json", 744), ("waiting-short.json.lz", 118)):
        path = str(shared_data / "leap" / name)
        assert main(["paalm", "show", path, "--json"]) == 0
        said = capsys.readouterr()
        for word in ("average hand", "too few", "not open", "cannot"):
            assert word not in said.err
        lines = [json.loads(line) for line in said.out.splitlines()]
        assert len(lines) == frames
        angles = lines[-1]["hands"]["right"]["angles"]
        assert len(angles) == 20 and all(-40.0 <= v <= 110.0 for v in angles.values())
        # The first needs but a few frames in which all of a finger is seen.
        asked = main(["paalm", "show", path, "--frames", "100"])
        assert asked == (0 if name == "v1-hands.json" else 2)
        capsys.readouterr()


@pytest.mark.parametrize("hand", ["right", "left"])
def test_a_hand_whose_thumb_is_that_of_the_other_one_is_not_taken_for_this_one_without_a_word(
    hand: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(tmp_path / "hand.json")
    assert main(["devices", "leap", "simulate", "--hand", hand, "--out", path]) == 0
    for taken_for in ("right", "left"):
        capsys.readouterr()
        assert main(["paalm", "show", path, "--hands", taken_for, "--seconds", "0.1"]) == 0
        told = f"the thumb shows that the recorded hand is a {hand} hand: use --hands {hand}"
        assert (told in " ".join(capsys.readouterr().err.split())) == (taken_for != hand)


@pytest.mark.parametrize(
    "args",
    (
        ["paalm", "show"],
        ["paalm", "show", "none.json"],
        ["paalm", "show", __file__],
        ["paalm", "calibrate", "none.json", "--hands", "right"],
        ["paalm", "calibrate", "--frames", "10"],
        ["devices", "leap", "fake", "none.json"],
        ["devices", "leap", "simulate", "--out", "/none/of/this/hand.json", "--seed", "-1"],
        ["evaluate", "--paalm", "none"],
        ["evaluate", "--paalm", "simulated", "--takes", "0"],
    ),
)
def test_bad_input_is_one_clear_line_and_exit_status_2(
    args: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    try:
        status: object = main(args)
    except SystemExit as stop:
        status = stop.code
    assert status == 2
    assert "Traceback" not in capsys.readouterr().err


def test_a_folder_of_simulated_recordings_is_judged_by_the_truth_in_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder, out = tmp_path / "takes", tmp_path / "out.json"
    folder.mkdir()
    for seed in (1, 2):
        write_take(take(seed, "v3"), folder / f"v3-{seed}.json", {"seed": seed})
    (folder / "notes.txt").write_text("no recording")
    assert main(["evaluate", "--paalm", str(folder), "--json", str(out)]) == 0
    found = json.loads(out.read_text())
    assert found["recordings"] == 2 and found["pip_dip_deg"] < 5.0
    assert set(found["identity_percent"]) == {"paper", "tracked"}
    assert "notes.txt" in found["left_out"]
    assert set(found["couplings"]) == {"two_thirds", "equal", "fitted"}


def test_recordings_whose_joints_bend_alike_by_construction_are_no_truth(
    shared_data: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    out = tmp_path / "out.json"
    assert main(["evaluate", "--paalm", str(shared_data / "leap"), "--json", str(out)]) == 0
    found = json.loads(out.read_text())
    assert found["pip_deg"] is None and found["dip_deg"] is None
    assert found["identity_percent"]["tracked"] >= 99.5 > found["identity_percent"]["paper"]


def test_a_capture_becomes_leap_recordings(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    import numpy as np

    from encoders.capture import save_capture
    from encoders.regression.trained import builtin_capture

    whole = builtin_capture()
    trials = np.unique(whole.trial)[:2]
    save_capture(whole.select(np.isin(whole.trial, trials)), tmp_path / "touches.npz")
    made_of = ["--capture", str(tmp_path / "touches.npz"), "--takes", "2"]
    args = ["devices", "leap", "simulate", *made_of]
    assert main([*args, "--out", str(tmp_path / "made")]) == 0
    made = sorted((tmp_path / "made").iterdir())
    assert len(made) == 2
    for path, trial in zip(made, trials, strict=True):
        assert len(read_leap(path).frames) > int((whole.trial == trial).sum())
    # The hand is held open first, so that it can be measured and judged.
    out = tmp_path / "out.json"
    assert main(["evaluate", "--paalm", str(tmp_path / "made"), "--json", str(out)]) == 0
    found = json.loads(out.read_text())
    assert found["recordings"] == 2 and found["identity_percent"]["tracked"] > 95.0
