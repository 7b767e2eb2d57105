"""Damaged Leap recordings through the whole command: one clear line, or counted skips and on."""

import json
from pathlib import Path
from typing import Any

import pytest

from sandbox.cli.main import main
from sandbox.devices.leap.leap_write import write_take
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.leap_hands import take


@pytest.fixture(scope="module")
def sound(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    path = tmp_path_factory.mktemp("leap") / "sound.json"
    write_take(take(1), path, {})
    recording = json.loads(path.read_text())
    # The open hand, which is measured, and a little more.
    recording["frames"] = recording["frames"][:200]
    return recording


def played(path: Path) -> int:
    return main(["run", "stack", "--device", str(path)])


def test_hands_that_swap_their_ids_all_the_time_do_not_stop_a_session(
    sound: dict[str, Any], tmp_path: Path
) -> None:
    recording = json.loads(json.dumps(sound))
    for i, frame in enumerate(recording["frames"]):
        (hand,), fingers = frame["hands"], frame["pointables"]
        x, y, z = hand["palmPosition"]
        other = {**hand, "id": 2, "palmPosition": [x + 300.0, y, z]}
        beside = []
        for f in fingers:
            x, y, z = f["tipPosition"]
            beside.append({**f, "id": f["id"] + 50, "handId": 2, "tipPosition": [x + 300.0, y, z]})
        frame["hands"], frame["pointables"] = [hand, other], fingers + beside
        if i // 10 % 2:
            for each in frame["hands"]:
                each["id"] = 3 - each["id"]
            for each in frame["pointables"]:
                each["handId"] = 3 - each["handId"]
    path = tmp_path / "swapping.json"
    path.write_text(json.dumps(recording))
    assert played(path) == 0


def test_a_profile_may_be_a_measured_hand_and_is_refused_for_touches(
    sound: dict[str, Any], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, hand = tmp_path / "hand.json", tmp_path / "me.json"
    path.write_text(json.dumps(sound))
    paalm = ["paalm", "calibrate", str(path), "--hands", "right", "--frames", "40"]
    assert main([*paalm, "--out", str(hand)]) == 0
    named, as_profile = (
        trial_settings(options).hands[0].in_air
        for options in (
            TrialOptions(device="leap", device_options={"calibration": hand}),
            TrialOptions(device="leap", profile=str(hand)),
        )
    )
    assert named is not None and named == as_profile and named.calibration is not None
    assert named.calibration["frames"] == 40
    capsys.readouterr()
    for wrong in (
        ["--device", "simulated", "--profile", str(hand)],
        ["--device", str(path), "--profile", str(hand), "--calibration", str(hand)],
        ["--device", str(path), "--profile", str(path)],
        ["--device", str(path), "--profile", str(hand), "--hand", "left"],
    ):
        assert main(["run", "stack", *wrong]) == 2
        assert capsys.readouterr().err.count("\n") == 1
