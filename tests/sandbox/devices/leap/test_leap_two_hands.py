"""Two hands over one Leap: who sees which, and what people read while hands are hidden."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from encoders.evaluation.paalm_errors import moved, side_by_side
from encoders.paalm.hand_reconstructor import NOTICE_LASTS
from models.frames import HandFrame
from sandbox.cli.run import main
from sandbox.devices.device import Sees
from sandbox.devices.hand_input import HandInput
from sandbox.devices.leap.leap_write import write_take
from sandbox.devices.leap.two_hands import SplitBySide
from sandbox.devices.registry import kind_of
from sandbox.devices.wrappers.shared import SharedDevice
from sandbox.play.pages import show_session
from sandbox.recording.recorded_device import RecordedDevice
from sandbox.recording.recording import load_recording
from sandbox.server.page_server import PageServer
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.driver import play_trial
from sandbox.trial.replay import replay
from sandbox.trial.settings import HandSettings, Settings
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.support.leap_hands import take
from tests.support.page_client import Page
from tests.support.scripted import Played, PlayedHands


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


STACKED = "one hand is above the other: hold them apart"


def stacked_for_a_while() -> list[HandFrame]:
    """Two hands beside each other, one above the other from 0.5 to 1 s, then beside again."""
    found = []
    for frame in side_by_side(take(1), take(2, side="left")):
        left, right = frame.hands
        if 0.5 <= frame.time < 1.0:
            x, y, z = (r - p for r, p in zip(right.palm, left.palm, strict=True))
            left = moved(left, (x, y, z + 0.12))
        found.append(replace(frame, hands=(left, right)))
    return found


def said(settings: Settings, makers: object, until: float) -> dict[float, tuple[str, ...]]:
    """What is said at every moment of a session."""
    session = build(settings, makers)  # type: ignore[arg-type]
    try:
        found = {}
        while session.time < until:
            snapshot = session.advance()
            found[round(snapshot.time, 3)] = snapshot.notices
        return found
    finally:
        session.close()


@pytest.mark.parametrize("task", ["box-to-goal", "carry-together"])
def test_hands_above_each_other_are_said_to_be_until_a_moment_after_they_are_not(task: str) -> None:
    frames, two = stacked_for_a_while(), task == "carry-together"
    sides = ("right", "left") if two else ("right",)
    hands = tuple(HandSettings(side, in_air=HandInput()) for side in sides)
    settings = Settings(task=task, hands=hands)
    shared = SharedDevice(PlayedHands(frames), SplitBySide(("right", "left")))
    parts: Any = tuple(lambda drawn, surface, i=i: shared.parts[i] for i in (0, 1))
    makers: Any = parts if two else (lambda drawn, surface: Played(frames),)
    told = said(settings, makers, 2.5)
    when = [t for t, words in told.items() if STACKED in words]
    assert when == [t for t in told if when[0] <= t <= when[-1]]
    assert when[0] == pytest.approx(0.5, abs=0.03)
    assert when[-1] == pytest.approx(1.0 + NOTICE_LASTS, abs=0.03)
    assert all(words.count(STACKED) <= 1 for words in told.values())


def test_a_hand_that_stays_away_is_missed_and_one_that_is_lost_for_a_moment_is_not() -> None:
    frames = [replace(f, hands=f.hands if not 1.0 <= f.time < 4.0 else ()) for f in take(1).frames]
    blink = [replace(f, hands=() if 0.4 <= f.time < 0.9 else f.hands) for f in frames]
    settings = Settings(hands=(HandSettings(in_air=HandInput()),))
    told = said(settings, (lambda drawn, surface: Played(blink),), 4.5)
    missed = [t for t, words in told.items() if any("is not seen" in w for w in words)]
    assert 2.2 < missed[0] < 2.5 and 3.9 < missed[-1] < 4.1
    assert not any("left" in w for words in told.values() for w in words)
