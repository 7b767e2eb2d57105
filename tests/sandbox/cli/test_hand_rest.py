"""`sandbox hand rest`: one second of seeing a hand becomes a file for --rest, or one clear line."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from encoders.air.camera import Camera
from encoders.paalm.hand_pose import PALM_CENTRE
from encoders.paalm.simulated.forward import ForwardLeap
from encoders.person.rest_posture import load_rest
from models.arithmetic import Array
from models.frames import HandFrame
from models.kinematics import Kinematics
from models.pose import JOINTS, ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp, log
from models.skeleton import ADULT
from sandbox.cli.main import main
from sandbox.devices.leap.leap_write import leap_message
from sandbox.devices.webcam.landmarks import header_record, message_of
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.encoders.air.seen_hands import film, mirror
from tests.encoders.person.resting_hand import resting

ABOVE = Camera(60.0, (0.0, -0.05, 0.55), tilt=90.0, roll=180.0)
"""A camera straight above the hand."""


def over_the_table() -> Array:
    """(48,) pose in the world of a hand that rests 12 cm over the table's top."""
    q = resting()
    q[ROOT_POSITION] += np.array([0.0, -0.02, 0.12]) - [q[0], q[1] + 0.1, 0.0]
    return q


def before(camera: Camera, q: Array) -> Array:
    """A pose (48,) of the world in the camera's frame."""
    own = q.copy()
    own[ROOT_POSITION] = camera.seen(q[None, ROOT_POSITION])[0]
    own[ROOT_ROTATION] = log(camera.axes @ exp(q[ROOT_ROTATION]))
    return own


def landmark_file(path: Path, left: bool = False) -> Path:
    """Two seconds of a hand that rests, as a camera above it sees it."""
    frames = film([before(ABOVE, over_the_table())] * 30, ABOVE, 15.0)
    lines = [header_record(ABOVE)]
    for frame in frames:
        message = message_of(frame)
        if left:
            (hand,) = map(mirror, frame.hands)
            message["seen"] = [
                {"side": hand.side, "score": hand.score, "image": hand.image, "world": hand.world}
            ]
        lines.append(message)
    path.write_text("".join(json.dumps(line) + "\n" for line in lines))
    return path


def leap_file(path: Path) -> Path:
    """Two seconds of a hand that rests over a simulated Leap of the later software."""
    q, leap = over_the_table(), ForwardLeap(5)
    placed, turn = Kinematics(ADULT).place(q), exp(q[ROOT_ROTATION])
    origin = q[ROOT_POSITION] + turn @ PALM_CENTRE
    first = [2, 5, 8, 11]
    thumb = [placed.joints[0], placed.joints[1], placed.tips[0], placed.tips[0]]
    rows = [thumb, *([*placed.joints[i : i + 3], placed.tips[n + 1]] for n, i in enumerate(first))]
    joints = (np.array(rows) - origin) @ turn
    device = origin + np.array([0.0, 0.0, 0.10])
    frames: list[HandFrame] = [leap.see(0.01 * i, device, turn, joints)[0] for i in range(200)]
    messages = [leap_message(frame, i) for i, frame in enumerate(frames)]
    path.write_text(json.dumps({"metadata": {}, "frames": messages}))
    return path


def rest(*words: str) -> int:
    return main(["hand", "rest", *words])


@pytest.mark.parametrize("device", ["webcam", "leap"])
def test_a_second_of_seeing_the_hand_is_a_rest_posture(device: str, tmp_path: Path) -> None:
    source = (landmark_file if device == "webcam" else leap_file)(tmp_path / "hand.json")
    out = tmp_path / "rest.json"
    assert rest("--device", str(source), "--out", str(out)) == 0
    (look,) = load_rest(out, "right", 1.0)
    pose, true = np.array(look.pose), over_the_table()
    tips = Kinematics(ADULT).tips(true)
    height = pose[2] - (true[2] - np.median(tips[:, 2]))
    assert abs(height) < 0.025
    bent = np.abs(pose[JOINTS] - true[JOINTS])[6:]
    assert np.degrees(np.median(bent)) < 8.0
    assert trial_settings(TrialOptions(device="simulated", rest=out)).hands[0].rest == (look,)


def test_a_left_hand_is_kept_as_one(tmp_path: Path) -> None:
    source, out = landmark_file(tmp_path / "hand.json", left=True), tmp_path / "rest.json"
    assert rest("--device", str(source), "--out", str(out), "--hand", "left") == 0
    assert json.loads(out.read_text())["hand"] == "left"
    assert len(load_rest(out, "left", 1.0)) == 1


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--device", "tuio"), "does not see a person's hand"),
        (("--device", "webxr"), "--record"),
        (("--device", "leap-simulated"), "does not see a person's hand"),
        (("--device", "HAND", "--samples", "0"), "out of range"),
        (("--device", "HAND", "--samples", "2"), "1 of 2 samples"),
        (("--device", "HAND", "--seconds", "0"), "not positive"),
        (("--device", "HAND", "--out", "nowhere/rest.json"), "no such folder"),
        (("--device", "HAND", "--out", "FOLDER"), "this is a folder"),
        (("--device", "HAND", "--out", "HAND"), "would replace a file from which it is made"),
        (("--device", "nobody.json"), "nobody.json"),
    ],
)
def test_what_cannot_be_used_is_one_line(
    words: tuple[str, ...], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = landmark_file(tmp_path / "hand.json")
    kept = source.read_bytes()
    named = {"HAND": str(source), "FOLDER": str(tmp_path)}
    line = [named.get(word, word) for word in words]
    line += [] if "--out" in line else ["--out", str(tmp_path / "rest.json")]
    assert rest(*line) == 2
    errors = [text for text in capsys.readouterr().err.splitlines() if text.startswith("sandbox")]
    assert len(errors) == 1 and said in errors[0]
    assert not (tmp_path / "rest.json").exists() and source.read_bytes() == kept
