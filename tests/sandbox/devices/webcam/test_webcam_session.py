"""Hands before a camera in a session: trials, recordings, replays, two hands, options."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from encoders.air.camera import Camera
from models.errors import InputError
from models.frames import LandmarkFrame
from models.motion.sampling import Poses
from sandbox.cli.main import main
from sandbox.devices.webcam import webcam_choice
from sandbox.devices.webcam.landmarks import header_record, message_of
from sandbox.export.sources import open_source
from sandbox.recording.recording import load_recording
from tests.encoders.air.seen_hands import film, held_up, mirror

CAMERA = Camera(70.0, (0.0, 0.45, 0.12))


def hand_file(path: Path, both: bool = False) -> Path:
    """A file of a hand, or of both, that bends its fingers for 2 s."""
    poses = [held_up(30.0 + 20.0 * np.sin(i / 10), (0.1, 0.01 * i, 0.0)) for i in range(60)]
    frames = film(poses, CAMERA)
    if both:
        frames = [
            LandmarkFrame(f.time, (*f.hands, mirror(f.hands[0])), f.size, f.taken) for f in frames
        ]
    lines = [header_record(CAMERA), *map(message_of, frames)]
    path.write_text("\n".join(map(json.dumps, lines)) + "\n")
    return path


def test_a_trial_by_a_file_of_landmarks_is_recorded_and_replays_to_the_bit(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file, recording = hand_file(tmp_path / "hand.jsonl"), tmp_path / "trial.jsonl"
    assert main(["run", "box-to-goal", "--device", str(file), "--record", str(recording)]) == 0
    assert main(["replay", str(recording)]) == 0
    assert "equal to the bit" in capsys.readouterr().out
    inputs = load_recording(recording).inputs[0]
    assert len(inputs) == 60
    assert all(isinstance(entry.frame, LandmarkFrame) for entry in inputs)


def test_a_recording_of_landmarks_is_exported_as_it_is(tmp_path: Path) -> None:
    file, out = hand_file(tmp_path / "hand.jsonl"), tmp_path / "hand.bvh"
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
    assert open_source(hand_file(tmp_path / "two.jsonl", both=True)).names == ("right", "left")
    with pytest.raises(InputError, match="not in the recording"):
        open_source(hand_file(tmp_path / "one.jsonl"), hand="left")


@pytest.mark.parametrize(
    "text", ["fov", "fov=wide", "zoom=2", "at=1/2", "mirrored=yes", "fov=5", "sees=1", "sees=1/0"]
)
def test_a_camera_that_cannot_be_is_one_line(text: str) -> None:
    with pytest.raises(InputError):
        webcam_choice(text)
