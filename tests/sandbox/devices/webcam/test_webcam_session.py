"""Hands before a camera in a session: trials, recordings, replays, two hands, options."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from encoders.air.camera import Camera
from encoders.paalm.angles import angles_of_joints
from encoders.paalm.hand_pose import hand_pose
from encoders.paalm.palm import Palm, vector_of
from models.errors import InputError
from models.frames import LandmarkFrame, SeenHand
from models.motion.sampling import Poses
from models.surface import Surface
from sandbox.cli.main import main
from sandbox.devices.device import LandmarkDevice
from sandbox.devices.hand_input import HandInput
from sandbox.devices.simulated.in_air import SimulatedLeap
from sandbox.devices.webcam import webcam_choice
from sandbox.export.sources import open_source
from sandbox.recording.recording import load_recording
from sandbox.session.messages import Snapshot
from sandbox.trial.driver import play_trial
from sandbox.trial.settings import HandSettings, Settings
from tasks.task import Task
from tasks.user import UserConfiguration
from tests.encoders.air.seen_hands import SIZE, film_file, held_up, landmarks

CAMERA = Camera(70.0, (0.0, 0.45, 0.12))


def test_a_trial_by_a_file_of_landmarks_is_recorded_and_replays_to_the_bit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, recording = film_file(tmp_path / "hand.jsonl", CAMERA), tmp_path / "trial.jsonl"
    assert main(["run", "box-to-goal", "--device", str(file), "--record", str(recording)]) == 0
    assert main(["replay", str(recording)]) == 0
    assert "equal to the bit" in capsys.readouterr().out
    inputs = load_recording(recording).inputs[0]
    assert len(inputs) == 60
    assert all(isinstance(entry.frame, LandmarkFrame) for entry in inputs)


def test_a_recording_of_landmarks_is_exported_as_it_is(tmp_path: Path) -> None:
    file, out = film_file(tmp_path / "hand.jsonl", CAMERA), tmp_path / "hand.bvh"
    assert main(["export", str(file), "--to", str(out)]) == 0
    assert "MOTION" in out.read_text()
    source = open_source(file)
    taken: list[Poses] = []
    assert source.play(taken.append) == "" and source.names == ("right",)
    root = np.concatenate([poses.root[:, 0] for poses in taken])
    assert len(root) == 60 and source.duration == pytest.approx(59 / 30)
    wrist = CAMERA.unseen(held_up()[None, :3])[0]
    assert np.linalg.norm(root[30:] - wrist, axis=1).max() < 0.03


def test_both_hands_of_a_recording_of_landmarks_are_exported(tmp_path: Path) -> None:
    assert open_source(film_file(tmp_path / "two.jsonl", CAMERA, both=True)).names == (
        "right",
        "left",
    )
    with pytest.raises(InputError, match="not in the recording"):
        open_source(film_file(tmp_path / "one.jsonl", CAMERA), hand="left")


@pytest.mark.parametrize(
    "text", ["fov", "fov=wide", "zoom=2", "at=1/2", "mirrored=yes", "fov=5", "sees=1", "sees=1/0"]
)
def test_a_camera_that_cannot_be_is_one_line(text: str) -> None:
    with pytest.raises(InputError):
        webcam_choice(text)


ABOVE = webcam_choice("at=0/0.05/0.58,tilt=90,roll=180").camera
PERIOD, LATE = 0.1, 0.1
"""Time (s) between two pictures, and from a picture to its landmarks."""


class BeforeCamera(LandmarkDevice):
    """The hand of a simulated user before a camera; its landmarks are where its joints are.

    Args:
        user: The user, as a device that takes snapshots.
        off: Standard deviation (pixels) of landmarks along each axis.
    """

    takes_snapshots = True

    def __init__(self, user: SimulatedLeap, off: float) -> None:
        self._user, self._off = user, off
        self._rng = np.random.default_rng(0)
        self._next = 0.0
        self._pictures: deque[LandmarkFrame] = deque()

    def show(self, snapshot: Snapshot) -> None:
        self._user.show(snapshot)

    def poll(self, now: float) -> Sequence[LandmarkFrame]:
        # The user's hand moves at every step, also between pictures.
        origin, rotation, joints = self._user.own_hand(now)
        if now >= self._next:
            self._next = now + PERIOD
            palm = Palm(vector_of(origin), *map(vector_of, rotation.T))
            points = ABOVE.seen(landmarks(hand_pose(angles_of_joints(joints), palm)))
            image = ABOVE.pixels(points, SIZE) + self._rng.normal(0.0, self._off, (21, 2))
            space = (points - points.mean(axis=0)).tolist()
            hand = SeenHand(
                "right", 1.0, tuple(map(tuple, image.tolist())), tuple(map(tuple, space))
            )
            self._pictures.append(LandmarkFrame(now, (hand,), SIZE, now, "camera"))
        ready = []
        while self._pictures and self._pictures[0].taken + LATE <= now:
            ready.append(self._pictures.popleft())
        return ready


@pytest.mark.parametrize("off", [0.0, 2.0])
def test_a_person_before_a_camera_brings_a_box_to_its_goal(off: float) -> None:
    settings = Settings(seed=201, hands=(HandSettings(in_air=HandInput(camera=ABOVE)),))

    def before_camera(task: Task, surface: Surface) -> Any:
        user = SimulatedLeap(task, UserConfiguration(), settings.seed, (0.0, 0.0, 0.0))
        return BeforeCamera(user, off)

    assert play_trial(settings, (before_camera,)).success
