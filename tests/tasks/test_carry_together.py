"""Two hands in one scene: a tray is carried by two, and by no one alone."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest

from models.arithmetic import Array
from models.errors import InputError
from models.objects import TRAY_GRIP, TRAY_HANDLE
from models.rotations import exp, matrix_to_quaternion
from models.surface import Surface, enclosing
from sandbox.cli.main import main
from sandbox.devices.hand_input import HandInput
from sandbox.recording.recording import Recording, load_recording
from sandbox.session.session import Session
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.driver import play_trial
from sandbox.trial.replay import replay
from sandbox.trial.settings import HandSettings, Settings, decoded, encoded
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.carry_together import BORDER, SEAM, SLOPE_TOLERANCE, CarryTogether
from tasks.sensing import Sensing
from tasks.simulated_user.carrier import Carrier
from tasks.simulated_user.user import IdleUser

TASK = "carry-together"
RIGHT_AND_LEFT = (HandSettings("right"), HandSettings("left"))
BOTH = Surface(15.52, 5.82).centred_at((0.0, 0.0, 0.0))


@pytest.fixture(scope="module")
def recording(tmp_path_factory: pytest.TempPathFactory) -> Recording:
    path = tmp_path_factory.mktemp("two") / "carry.jsonl"
    assert main(["run", TASK, "--seed", "3", "--record", str(path)]) == 0
    return load_recording(path)


def test_the_recording_of_two_hands_replays_to_the_bit_and_plays_as_two_devices(
    recording: Recording,
) -> None:
    assert set(recording.inputs) == {0, 1}
    session, found = replay(recording)
    assert found.exact and found.complete and session.scorer.score.held
    assert len(session.rigs) == 2
    again = trial_settings(TrialOptions(device=str(recording.path)))
    result = play_trial(again)
    assert result.state_hash == recording.end["result"]["state_hash"]


def test_settings_of_two_hands_are_read_back_as_they_were_and_damaged_ones_are_refused() -> None:
    hands = (HandSettings(), HandSettings("right", 0.9, 180, HandInput()))
    two = Settings().changed(hands=hands, shared=True)
    values = json.loads(json.dumps(encoded(two)))
    assert decoded(values) == two
    damages: tuple[dict[str, Any], ...] = (
        {"second": {"hand": "left"}},
        {"hands": [{"side": "left"}]},
        {"hands": [{**values["hands"][0], "colour": "blue"}]},
        {"hands": [*values["hands"], values["hands"][0]]},
        {"hands": []},
        {"hands": 2},
        {"seed": "one"},
    )
    for wrong in damages:
        with pytest.raises(InputError):
            decoded({**values, **wrong})


def test_one_skilled_hand_alone_only_tips_the_tray() -> None:
    """One skilled user who waits for nobody, and one who does nothing."""
    chosen = trial_settings(TrialOptions(task=TASK, seed=0, second_user="idle"))
    session = build(chosen, device_makers(chosen))
    devices: list[Any] = [rig.device for rig in session.rigs]
    user, idle = (device.user for device in devices)
    assert isinstance(user, Carrier) and isinstance(idle, IdleUser)
    user.patient = False
    slopes = []
    while session.time < 7.0:
        snapshot = session.advance()
        for rig in session.rigs:
            rig.device.show(snapshot)
        tray = snapshot.objects["tray"]
        end = tray.position[2] + abs(TRAY_GRIP * tray.rotation[2, 0]) - TRAY_HANDLE[2]
        if end > 0.03:
            slopes.append(float(np.arcsin(abs(tray.rotation[2, 0]))))
    assert len(slopes) > 30 and min(slopes) > SLOPE_TOLERANCE
    assert not session.scorer.score.instant


def test_the_mirrored_scene_has_the_same_trial_with_the_sides_swapped() -> None:
    settings = Settings(task=TASK, hands=RIGHT_AND_LEFT)
    swapped = replace(settings, hands=RIGHT_AND_LEFT[::-1])

    def places(chosen: Settings) -> tuple[list[Array], Session]:
        session = build(chosen, device_makers(trial_settings(TrialOptions(task=TASK))))
        return [
            r.reconstructor.surface.to_world(r.reconstructor.surface.size / 2)[0]
            for r in session.rigs
        ], session

    (right, left), session = places(settings)
    (first, second), other = places(swapped)
    assert right == pytest.approx(-left) and right > 0
    assert (first, second) == pytest.approx((left, right))
    assert session.task == other.task
    whole = session.whole_surface
    assert whole.width_in == pytest.approx(2 * settings.surface.size_in[0])
    np.testing.assert_allclose(whole.to_world(whole.size / 2)[:2], 0.0, atol=1e-12)


@pytest.fixture(scope="module")
def still() -> Session:
    """A session that nobody plays."""
    chosen = trial_settings(TrialOptions(task=TASK, seed=3, user="idle", second_user="idle"))
    return build(chosen, device_makers(chosen))


DEGREE = np.deg2rad(1.0)


@pytest.mark.parametrize(
    ("off", "turn", "slope", "roll", "speed", "reason"),
    [
        (0.0, 0.0, 0.0, 0.0, 0.0, ""),
        (0.0149, 7.9, 5.9, 24.9, 0.049, ""),
        (0.0151, 0.0, 0.0, 0.0, 0.0, "15 mm from the goal"),
        (0.0, 8.1, 0.0, 0.0, 0.0, "turned by 8 degrees"),
        (0.0, -8.1, 0.0, 0.0, 0.0, "turned by 8 degrees"),
        (0.0, 180.0, 0.0, 0.0, 0.0, "turned by 180 degrees"),
        (0.0, 0.0, 6.1, 0.0, 0.0, "slopes by 6 degrees"),
        (0.0, 0.0, -6.1, 0.0, 0.0, "slopes by 6 degrees"),
        (0.0, 0.0, 0.0, 25.1, 0.0, "rolled by 25 degrees"),
        (0.0, 0.0, 0.0, -25.1, 0.0, "rolled by 25 degrees"),
        (0.0, 0.0, 0.0, 180.0, 0.0, "rolled by 180 degrees"),
        (0.0, 0.0, 0.0, 0.0, 0.051, "still moving"),
    ],
)
def test_the_tray_is_in_its_place_within_what_the_task_says(
    still: Session, off: float, turn: float, slope: float, roll: float, speed: float, reason: str
) -> None:
    task, goal = still.task, still.task.goals[0]
    model, data = still.scene.model, mujoco.MjData(still.scene.model)
    joint = model.joint("tray")
    (q,), (v,) = joint.qposadr, joint.dofadr
    data.qpos[q : q + 3] = goal.position + np.array([0.6, 0.0, 0.8]) * off
    # First about the line from handle to handle, then about the other axis, the vertical last.
    turned = (
        exp([0.0, 0.0, goal.yaw + turn * DEGREE])
        @ exp([0.0, slope * DEGREE, 0.0])
        @ exp([roll * DEGREE, 0.0, 0.0])
    )
    data.qpos[q + 3 : q + 7] = matrix_to_quaternion(turned)
    data.qvel[v : v + 3] = [0.6 * speed, 0.0, 0.8 * speed]
    mujoco.mj_forward(model, data)
    found = task.measure(Sensing(still.scene, data))
    assert reason in found.reason and found.reached == (not reason)
    assert (found.progress == 1.0) == (not reason)


def test_a_tray_that_stands_on_the_table_is_not_in_its_place(still: Session) -> None:
    data = mujoco.MjData(still.scene.model)
    for _ in range(50):
        mujoco.mj_step(still.scene.model, data)
    found = still.task.measure(Sensing(still.scene, data))
    assert found.reason == "the tray is on the table" and not found.reached


def test_every_grip_is_on_its_hands_half_and_trials_follow_from_their_seeds() -> None:
    for seed in range(200):
        task = CarryTogether.draw(seed, BOTH)
        assert task == CarryTogether.draw(seed, BOTH)
        tray, goal = task.objects[0], task.goals[0]
        for place, yaw in ((tray.position, tray.yaw), (goal.position, goal.yaw)):
            for side in (1, -1):
                grip = np.array(place) + side * TRAY_GRIP * np.array(
                    [np.cos(yaw), np.sin(yaw), 0.0]
                )
                x, y = BOTH.to_surface(grip)
                assert side * (x - BOTH.size[0] / 2) >= SEAM - 1e-9
                assert min(x, BOTH.size[0] - x, y, BOTH.size[1] - y) >= BORDER - 1e-9


def test_a_tray_s_clearance_is_that_of_its_boxes() -> None:
    tray = CarryTogether.draw(0, BOTH).objects[0]
    points = np.array([[0.0, 0.0, 0.0], [TRAY_GRIP, 0.0, 0.0], [0.0, 0.2, -0.011], [0.3, 0.0, 0.0]])
    found = tray.clearance(points, np.zeros(3), np.eye(3))
    np.testing.assert_allclose(found, [0.004, -0.015, 0.14, 0.15], atol=1e-9)
    larger = tray.scaled(1.5)
    assert larger.position[2] - larger.handle[2] == pytest.approx(tray.position[2] - TRAY_HANDLE[2])


def test_the_rectangle_that_encloses_one_surface_is_that_surface() -> None:
    assert enclosing([BOTH]) is BOTH and enclosing([BOTH, BOTH]) is BOTH
    apart = [BOTH.centred_at((x, 0.1, 0.0)) for x in (0.3, -0.1)]
    around = enclosing(apart)
    assert around.size[0] == pytest.approx(BOTH.size[0] + 0.4)
    np.testing.assert_allclose(around.to_world(around.size / 2), (0.1, 0.1, 0.0), atol=1e-12)


def test_invalid_options_for_a_second_hand_are_refused() -> None:
    for options in (
        {"second_hand": "left"},
        {"task": TASK, "one_surface": True},
        {"task": TASK, "one_surface": True, "device": "mouse"},
        {"task": TASK, "one_surface": True, "device": "tuio", "second_device": "tuio"},
        {"task": TASK, "second_hand_size": 7.0},
    ):
        with pytest.raises(InputError):
            chosen = trial_settings(TrialOptions(**options))
            build(chosen, device_makers(chosen))
    for settings in (Settings(task=TASK), Settings(hands=RIGHT_AND_LEFT)):
        with pytest.raises(InputError):
            build(settings, device_makers(Settings()))


def test_two_people_with_a_right_hand_each_carry_it_from_the_command_line(tmp_path: Path) -> None:
    out = tmp_path / "result.json"
    words = ["--device", "simulated", "--device", "simulated", "--hand", "right", "--hand", "right"]
    assert main(["run", TASK, "--seed", "2", *words, "--json", str(out)]) == 0
    result = json.loads(out.read_text())
    settings = result["settings"]
    assert result["success"] and settings["second_device"]["name"] == "simulated"
    assert settings["hands"][1]["side"] == "right"
