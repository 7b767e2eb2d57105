"""Hands in the air in a session: they pick up and stack, are recorded exactly, and replay."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.paalm.calibration_file import read_calibration, write_calibration
from encoders.paalm.hand_reconstructor import HandReconstructor, HandReconstructorSettings
from encoders.paalm.joint_angles import Paalm
from encoders.reconstruction.hand_motion import Phase, RateLimit
from encoders.reconstruction.reconstructor import Reconstruction
from models.errors import InputError
from models.frames import HandFrame, TouchFrame, TrackedFinger, TrackedHand
from models.hand import Hand
from models.kinematics import Kinematics
from models.objects import HANDLE_WIDTH, Box
from models.person import Person
from models.pose import ROOT_POSITION
from models.scene import Scene, SceneSpec
from models.skeleton import ADULT
from models.surface import Surface
from sandbox.cli.main import main
from sandbox.devices.device import SILENCE, LatestFrame
from sandbox.devices.hand_input import UNDER, HandInput
from sandbox.devices.leap.leap_write import leap_message, write_take
from sandbox.devices.simulated.in_air import SimulatedLeap
from sandbox.recording.recorded_device import RecordedDevice
from sandbox.recording.recording import frame_from_json, frame_to_json, load_recording
from sandbox.session.collision_gating import CollisionGate, CollisionGatingRules
from sandbox.session.messages import Snapshot
from sandbox.trial.assembly import build
from sandbox.trial.driver import play_trial
from sandbox.trial.replay import replay
from sandbox.trial.settings import HandSettings, Settings, decoded, encoded
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.task import Task
from tasks.user import UserConfiguration
from tests.sandbox.devices.test_strange_hands import as_lines, doubled
from tests.support.leap_hands import calibrated, take
from tests.support.scripted import PlayedHands

MIDDLE = ("index_pip", "index_dip")


NUMBERS = st.floats(-1e3, 1e3)
PLACES = st.tuples(NUMBERS, NUMBERS, NUMBERS)
AXES = st.sampled_from([(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.6, 0.0, -0.8), (-0.0, 0.0, 1.0)])
TRACKED_FINGERS = st.builds(
    TrackedFinger,
    st.integers(0, 2**40),
    PLACES,
    AXES,
    st.floats(1e-6, 1.0),
    joints=st.none() | st.tuples(PLACES, PLACES, PLACES, PLACES),
    extended=st.none() | st.booleans(),
)
TRACKED_HANDS = st.builds(
    TrackedHand,
    st.integers(0, 99),
    PLACES,
    st.just((0.0, 0.0, -1.0)),
    st.just((0.0, 1.0, 0.0)),
    st.lists(TRACKED_FINGERS, max_size=5, unique_by=lambda finger: finger.id).map(tuple),
    st.sampled_from(["right", "left", None]),
    st.floats(0.0, 1.0),
    st.none() | st.floats(0.0, 1.0),
    st.none() | PLACES,
)
HAND_FRAMES = st.builds(
    HandFrame,
    st.floats(0.0, 1e6),
    st.lists(TRACKED_HANDS, max_size=3, unique_by=lambda hand: hand.id).map(tuple),
    st.sampled_from(["", "leap"]),
)


def settings(**changes: Any) -> Settings:
    return replace(Settings(hands=(HandSettings(in_air=HandInput()),)), **changes)


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A box brought to its goal through the air."""
    path = tmp_path_factory.mktemp("air") / "v1.jsonl"
    result = play_trial(trial_settings(TrialOptions(device="leap-simulated:v1")), record=path)
    assert result.success, result.reason
    return path


@given(HAND_FRAMES)
def test_a_hand_frame_is_stored_to_the_bit(frame: HandFrame) -> None:
    back = frame_from_json(json.loads(json.dumps(frame_to_json(frame))))
    # The text of a float tells all of it, and that of -0.0 is not that of 0.0.
    assert back == frame and repr(back) == repr(frame)


def test_a_box_carried_through_the_air_replays_to_the_bit(recording: Path) -> None:
    read = load_recording(recording)
    lifted = max(qpos[-5] for qpos in read.track.qpos.values())
    assert lifted > 0.035, "the box was lifted, not pushed"
    _, verification = replay(read)
    assert verification.exact and verification.complete


def test_a_recording_is_the_device_of_another_hand_in_another_scene(recording: Path) -> None:
    read = load_recording(recording)
    of = settings(
        task="stack",
        hands=(
            HandSettings(in_air=HandInput()),
            HandSettings(in_air=HandInput((0.3, 0.0, -0.1))),
        ),
    )
    recorded = RecordedDevice(read, 0)
    makers: Any = (lambda task, surface: PlayedHands(take(1).frames), lambda *_: recorded)
    session = build(of, makers)
    for _ in range(100):
        session.advance()
    own, other = (session.reconstructions[i].q[ROOT_POSITION] for i in (1, 0))
    assert session.reconstructions[1].down and own[0] > 0.2 > other[0]


def test_settings_with_a_calibration_are_read_back_as_they_were(tmp_path: Path) -> None:
    paalm = calibrated(take(3))
    write_calibration(paalm.calibration, tmp_path / "me.json")
    mine = read_calibration(tmp_path / "me.json")["right"]
    of = settings(hands=(HandSettings(in_air=HandInput.of((0.01, 0.2, -0.3), mine)),))
    again = decoded(json.loads(json.dumps(encoded(of))))
    assert again == of
    rebuilt = again.hands[0].in_air.reconstructor(Person(), Surface(), RateLimit())
    direct = HandReconstructor(
        paalm, settings=HandReconstructorSettings(device=(0.01, 0.2, -0.3)), surface=Surface()
    )
    for frame in take(3).frames[:40]:
        np.testing.assert_array_equal(rebuilt.step(frame).q, direct.step(frame).q)


def test_the_position_of_the_device_moves_the_hand_and_changes_nothing_else() -> None:
    poses = []
    for at in (UNDER, (0.1, -0.2, 0.3)):
        found = HandInput(at).reconstructor(Person(), Surface(), RateLimit())
        poses.append(np.array([found.step(frame).q for frame in take(2).frames[:60]]))
    one, other = poses
    shift = np.tile(np.subtract((0.1, -0.2, 0.3), UNDER), (60, 1))
    np.testing.assert_allclose(other[:, :3] - one[:, :3], shift, atol=1e-12)
    np.testing.assert_array_equal(other[:, 3:], one[:, 3:])


def test_no_fingertip_is_commanded_below_the_table() -> None:
    low = HandInput((0.0, 0.0, -0.25)).reconstructor(Person(), Surface(), RateLimit(1e9, 1e9))
    kinematics = Kinematics(ADULT)
    for frame in take(4).frames[:200]:
        tips = kinematics.tips(low.step(frame).q)
        assert (tips[:, 2] - ADULT.tip_radius).min() > -1e-9


def test_a_hand_that_is_lost_stays_solid_for_a_moment_then_rises_as_a_ghost_and_comes_back() -> (
    None
):
    followed = HandInput().reconstructor(Person(), Surface(), RateLimit())
    s, seen = followed.settings, take(1).frames
    for frame in seen[:50]:
        last = followed.step(frame)
    now, found = seen[49].time, []
    for i in range(1, 100):
        found.append(followed.step(HandFrame(now + 0.016 * i)))
    kept = [r for i, r in enumerate(found, 1) if 0.016 * i <= s.patience]
    assert all(r.down for r in kept)
    np.testing.assert_array_equal([r.q for r in kept], [last.q] * len(kept))
    assert found[-1].phase is Phase.AWAY and not found[-1].fingers
    for i, r in enumerate(found, 1):
        away = 0.016 * i - s.patience
        if 0.0 < away < s.rise / s.rise_speed:
            assert r.q[2] - last.q[2] == pytest.approx(s.rise_speed * away, abs=1e-6)
    risen = found[-1].q - last.q
    assert s.rise - 0.01 < risen[2] < s.rise + 0.01 and not risen[3:].any()
    # It is back far away, and no finger is solid before the drawn hand has got there.
    shifted = [
        replace(f, time=now + 1.1 + f.time, hands=tuple(_moved(h, 0.3) for h in f.hands))
        for f in seen[50:150]
    ]
    back = [followed.step(f) for f in shifted]
    first = next(i for i, r in enumerate(back) if r.down)
    assert first > 5 and all(r.phase is Phase.COMING_DOWN for r in back[:first])
    assert all(r.down for r in back[first:])


def _moved(hand: TrackedHand, x: float) -> TrackedHand:
    a, b, c = hand.palm
    return replace(hand, palm=(a + x, b, c))


def test_a_device_that_falls_silent_sees_no_hand() -> None:
    newest: Any = LatestFrame(HandReconstructor.empty)
    frame = take(0).frames[0]
    assert newest.take([frame], 1.0) and newest.frame.hands == frame.hands
    assert not newest.take([], 1.0 + SILENCE) and newest.frame.hands
    newest.take([], 1.01 + SILENCE)
    assert not newest.frame.hands and newest.frame.time == 1.01 + SILENCE
    touches = LatestFrame(TouchFrame(0.0))
    touches.take([TouchFrame(0.0, lift=0.5)], 0.0)
    touches.take([], 9.0)
    assert touches.frame == TouchFrame(9.0, lift=0.5)


def test_who_was_not_measured_is_assumed_and_assumed_anew_after_a_reset() -> None:
    followed = HandReconstructor(Paalm(), assume=True)
    empty = followed.step(HandFrame(0.0))
    assert not empty.down and not followed.paalm.calibration
    first = [followed.step(f).q for f in take(5, "v3").frames[:30]]
    assert followed.paalm.calibration["right"].bones is not None, "a device that knows bones"
    followed.reset()
    followed.step(HandFrame(0.0))
    np.testing.assert_array_equal([followed.step(f).q for f in take(5, "v3").frames[:30]], first)


def test_a_hand_in_the_air_stays_at_the_lower_edge_of_a_flat_table() -> None:
    with pytest.raises(InputError, match="flat table"):
        play_trial(settings(task="stack-vertical"), (lambda *_: PlayedHands([]),))
    with pytest.raises(InputError, match="lower edge"):
        HandInput().reconstructor(Person(turn=90), Surface(), RateLimit())


@pytest.mark.parametrize("links", [1, 2])
def test_a_finger_whose_middle_link_is_in_a_thing_is_solid_only_where_that_link_is_not(
    links: int,
) -> None:
    q = np.zeros(48)
    q[2] = 0.3
    placed = Kinematics(ADULT).place(q)
    pip, dip = (next(i for i, b in enumerate(ADULT.bones) if b.name == n) for n in MIDDLE)
    x, y, z = placed.joints[[pip, dip]].mean(axis=0).tolist()
    scene = Scene(SceneSpec((Hand(),), (Box("bead", (0.003,) * 3, 0.01, (x, y, z)),)))
    data = mujoco.MjData(scene.model)
    data.qpos[scene.qpos_slice(0)] = scene.pose_to_qpos(0, q)
    mujoco.mj_forward(scene.model, data)
    gate = CollisionGate(scene, 0, CollisionGatingRules(links=links, together=False))
    every = frozenset(range(5))
    gate.update(data, Reconstruction(q, Phase.DOWN, every, None, 1.0, 0.0))
    assert gate.fingers == (every if links == 1 else every - {1})
    solid = {scene.model.geom(i).name for i in np.flatnonzero(scene.model.geom_contype == 1)}
    assert ("right_middle_pip" in solid) == (links == 2) and "right_middle_mcp" not in solid
    assert "right_middle_dip" in solid and "right_index_pip" not in solid


@pytest.mark.parametrize("seed", [16, 33])
def test_a_wrench_is_held_so_low_that_no_fingertip_rides_over_its_handle(seed: int) -> None:
    of = settings(task="wrench-turn", seed=seed)
    made: list[SimulatedLeap] = []
    over: list[bool] = []

    def device(task: Task, surface: Surface) -> Any:
        made.append(SimulatedLeap(task, UserConfiguration(), seed, UNDER, "v1"))
        return made[-1]

    def look(snapshot: Snapshot) -> None:
        wrench = snapshot.objects["wrench"]
        along, across, up = ((snapshot.hands[0].tips - wrench.position) @ wrench.rotation)[:3].T
        if made[0].user.carrying:
            beside = (np.abs(along) < 0.1) & (np.abs(across) < HANDLE_WIDTH / 2.0)
            over.append(bool((beside & (up > 0.0)).any()))

    result = play_trial(of, (device,), lambda session: [look])
    assert over and not any(over)
    assert result.success and made[0].user.grasps == 1


def test_hands_that_swap_their_ids_all_the_time_do_not_stop_a_session(tmp_path: Path) -> None:
    # The open hand, which is measured, and a little more; another hand is beside it.
    messages = doubled([leap_message(f, n) for n, f in enumerate(take(1).frames[:200])])
    for i, message in enumerate(messages):
        if i // 10 % 2:
            for hand in message["hands"]:
                hand["id"] = 3 - hand["id"]
            for finger in message["pointables"]:
                finger["handId"] = 3 - finger["handId"]
    path = as_lines(tmp_path, messages, "swapping.jsonl")
    assert main(["run", "stack", "--device", str(path)]) == 0


def test_a_profile_may_be_a_measured_hand_and_is_refused_for_touches(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, hand = tmp_path / "hand.json", tmp_path / "me.json"
    write_take(take(1), path, {})
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
