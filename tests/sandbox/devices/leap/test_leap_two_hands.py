"""Two hands over one Leap, and hands in the air on the command line."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from encoders.evaluation.paalm_errors import side_by_side
from models.errors import InputError
from sandbox.cli.main import main as command
from sandbox.cli.run import main
from sandbox.devices.device import Sees
from sandbox.devices.leap import OverLeapOptions, over_leap
from sandbox.devices.leap.leap_write import write_take
from sandbox.devices.leap.two_hands import SplitBySide
from sandbox.devices.registry import kind_of
from sandbox.devices.simulated.in_air import SimulatedLeap
from sandbox.devices.wrappers.shared import SharedDevice
from sandbox.play.pages import show_session
from sandbox.recording.recorded_device import RecordedDevice
from sandbox.recording.recording import load_recording
from sandbox.server.page_server import PageServer
from sandbox.study.design.conditions import run_settings
from sandbox.study.design.session_plan import TrialStep
from sandbox.study.record.folder import Participant
from sandbox.study.run.simulated_study import simulated_devices
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.driver import play_trial
from sandbox.trial.replay import replay
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.user import UserConfiguration
from tests.support.leap_hands import take
from tests.support.page_client import Page
from tests.support.scripted import PlayedHands


def test_each_hand_gets_the_frames_of_its_own_side_and_no_other() -> None:
    both = side_by_side(take(1), take(2, side="left"))[:50]
    right, left = SharedDevice(PlayedHands(both), SplitBySide(("right", "left"))).parts
    for now in (0.1, 0.2, 0.5):
        # Who asks first fetches for both, and nothing is lost for the other.
        mine, other = right.poll(now), left.poll(now)
        assert [f.time for f in mine] == [f.time for f in other] != []
        for a, b in zip(mine, other, strict=True):
            (a_hand,), (b_hand,) = a.hands, b.hands
            assert (a_hand.side, b_hand.side) == ("right", "left")
            assert a_hand.palm[0] > 0.0 > b_hand.palm[0]
    assert right.finished and left.finished


def test_a_hand_over_the_other_hides_both() -> None:
    both = []
    for frame in side_by_side(take(1), take(2, side="left"))[:5]:
        left, right = frame.hands
        x, y, z = right.palm
        both.append(replace(frame, hands=(replace(left, palm=(x + 0.05, y, z - 0.1)), right)))
    shared = SharedDevice(PlayedHands(both), split := SplitBySide(("right", "left")))
    frames = shared.parts[0].poll(1.0)
    assert len(frames) == 5 and not any(f.hands for f in frames)
    assert split.counts["one hand above the other"] == 5


def chosen(task: str, **options: Any) -> Settings:
    return trial_settings(replace(TrialOptions(task=task), **options))


@pytest.mark.slow
def test_two_hands_over_one_leap_carry_a_tray_and_replay_to_the_bit(tmp_path: Path) -> None:
    made = chosen("carry-together", device="leap-simulated:v1", seed=1)
    assert [hand.in_air is not None for hand in made.hands] == [True, True]
    path = tmp_path / "two.jsonl"
    result = play_trial(made, record=path)
    assert result.success, result.reason
    read = load_recording(path)
    inputs: Any = read.inputs
    sides = [{h.side for e in inputs[i] for h in e.frame.hands} for i in (0, 1)]
    assert sides == [{"right"}, {"left"}]
    assert replay(read)[1].exact
    # One hand's half of it is a device like any other.
    frames = RecordedDevice(read, 1).poll(1.0)
    assert frames and all(h.side == "left" for f in frames for h in f.hands)


@pytest.mark.parametrize("at", ["", "1,2", "a,b,c", "0,0,9", "nan,0,0"])
def test_a_device_that_is_nowhere_is_refused(at: str) -> None:
    with pytest.raises(InputError, match="--leap-at"):
        over_leap(OverLeapOptions(leap_at=at), "right")


def test_a_leap_recording_drives_the_hand_with_its_own_calibration(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "hand.json"
    write_take(take(1), path, {})
    assert kind_of(str(path)).sees is Sees.LEAP
    assert kind_of(str(tmp_path / "missing.json")).sees is Sees.TOUCHES
    made = chosen("box-to-goal", device=str(path))
    (hand,) = made.hands
    assert hand.in_air is not None
    calibration = hand.in_air.calibration
    assert calibration is not None and calibration["by_tip"]
    whole = sum(len(f.hands[0].fingers) == 5 for f in take(1).frames)
    assert calibration["frames"] == whole > 100
    assert main(["box-to-goal", "--device", str(path), "--json", str(tmp_path / "out.json")]) == 0
    result = json.loads((tmp_path / "out.json").read_text())
    assert result["status"] == "input_ended"
    assert result["settings"]["hands"][0]["in_air"]["at"] == [0.0, 0.0, -0.1]


def test_a_service_that_is_not_there_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    nobody = ["--device", "leap", "--leap", "ws://127.0.0.1:1/v6.json"]
    assert command(["run", "stack", *nobody]) == 2
    assert "is silent" in capsys.readouterr().err


@pytest.mark.parametrize("wrong", ["v9", "noise", "noise=loud", "noise=nan", "lose=-1", "v1=2"])
def test_a_simulated_leap_that_is_none_is_refused(wrong: str) -> None:
    with pytest.raises(InputError):
        chosen("stack", device=f"leap-simulated:{wrong}")


def test_a_hand_that_is_lost_while_it_carries_a_box_takes_it_up_again(tmp_path: Path) -> None:
    made = chosen("box-to-goal", device="leap-simulated:lose=1")
    path = tmp_path / "lost.jsonl"
    assert play_trial(made, record=path).success
    frames: list[Any] = [entry.frame for entry in load_recording(path).inputs[0]]
    gone = [f.time for f in frames if not f.hands]
    assert 0.9 < gone[-1] - gone[0] < 1.1, "once, for a second"
    before, after = (
        {h.id for f in part for h in f.hands}
        for part in (
            [f for f in frames if f.time < gone[0]],
            [f for f in frames if f.time > gone[-1]],
        )
    )
    assert before and after and not before & after, "it is another hand to the device"


def test_the_hand_that_a_simulated_person_moves_is_theirs_alone() -> None:
    first, again, other = (
        chosen("stack", device="leap-simulated", seed=seed) for seed in (1, 1, 2)
    )
    palms = []
    for made in (first, again, other):
        session = build(made, device_makers(made))
        for _ in range(20):
            session.advance()
        palms.append(session.reconstructions[0].q)
    np.testing.assert_array_equal(palms[0], palms[1])
    assert np.abs(palms[0] - palms[2]).max() > 1e-3


@pytest.mark.parametrize("device", ["leap-simulated", "simulated"])
def test_who_looks_at_a_hand_in_the_air_on_the_page_has_no_lift_control(device: str) -> None:
    made = chosen("stack", device=device)
    session = build(made, device_makers(made))
    server = PageServer()
    try:
        show_session(server, session, "right", "simulated user")
        with Page(server.url) as page:
            told = page.until("scene")
    finally:
        server.close()
        session.close()
    assert told.get("in_air", False) == (device == "leap-simulated")
    assert (told["lift"] == 0.0) == (device == "leap-simulated")


def test_a_study_compares_touch_and_air() -> None:
    touch, air = (
        run_settings({"task": "stack", "device": device}, 3, "left", 0.9)
        for device in ("touch", "leap")
    )
    assert air.in_air and not touch.in_air
    on_screen = (replace(air.hands[0], in_air=None),)
    assert replace(air, hands=on_screen, device=touch.device) == touch
    user = {**UserConfiguration().as_json(), "reaction": [0.15, 0.25]}
    of_trial = simulated_devices(Participant("TEST", 1, "left", 0.9, user=user))
    trial = TrialStep("trial:1", 1, 1, 1, 1, False, {"device": "leap"}, {"device": "leap"}, 3)
    made = of_trial(trial, air)
    session = build(air, made)
    assert isinstance(session.rigs[0].device, SimulatedLeap)
