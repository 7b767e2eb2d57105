"""Files of landmarks, and the messages that they are made of."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from encoders.air.camera import Camera
from models.errors import DeviceError, FrameError, InputError
from models.frames import LandmarkFrame
from models.motion.sampling import Poses
from sandbox.devices.device import Sees
from sandbox.devices.registry import kind_of
from sandbox.devices.webcam.landmarks import (
    LandmarkFileDevice,
    frame_of,
    header_record,
    is_landmark_file,
    message_of,
    picture_message,
    read_landmarks,
)
from sandbox.export.sources import open_landmarks
from sandbox.recording.recording import frame_from_json, frame_to_json
from tests.encoders.air.seen_hands import film, held_up

CAMERA = Camera(70.0, (0.0, 0.5, 0.2), 10.0)


def written(path: Path, frames: list[LandmarkFrame], *more: str) -> Path:
    lines = [header_record(CAMERA), *map(message_of, frames)]
    path.write_text("\n".join([*map(json.dumps, lines), *more]) + "\n")
    return path


def pictures(count: int = 5) -> list[LandmarkFrame]:
    return film([held_up(10.0 * i) for i in range(count)], CAMERA)


def test_a_file_gives_back_its_pictures_and_its_camera(tmp_path: Path) -> None:
    frames = pictures()
    recording = read_landmarks(written(tmp_path / "hands.jsonl", frames))
    assert [replace(f, source="simulated") for f in recording.frames] == frames
    assert recording.camera == CAMERA
    assert recording.damage is None


def test_a_picture_that_cannot_be_used_costs_itself_alone(tmp_path: Path) -> None:
    lines = written(tmp_path / "hands.jsonl", pictures()).read_text().splitlines()
    for spoiled in ('{"time": 9, "seen": [{"side": "up"}]}', '{"time": NaN}'):
        path = tmp_path / "spoiled.jsonl"
        path.write_text("\n".join([*lines[:3], spoiled, *lines[3:]]))
        recording = read_landmarks(path)
        assert recording.frames == read_landmarks(tmp_path / "hands.jsonl").frames
        assert recording.damage is None and sum(recording.report.left_out.values()) == 1
        assert recording.lines == (2, 3, 5, 6, 7)


def test_a_line_that_is_cut_short_ends_the_file_and_is_named(tmp_path: Path) -> None:
    path = written(tmp_path / "hands.jsonl", pictures(), '{"time": 9, "seen": [{"side": "r')
    recording = read_landmarks(path)
    assert len(recording.frames) == 5
    assert "line 7" in str(recording.damage)


def test_two_pictures_of_one_moment_are_one_in_an_export(tmp_path: Path) -> None:
    frames = pictures()
    again = replace(frames[2], time=frames[2].time + 0.01)
    file = written(tmp_path / "hands.jsonl", [*frames[:3], again, *frames[3:]])
    shown: list[Poses] = []
    assert open_landmarks(file).play(shown.append) == ""
    times = [frame.taken - frames[0].taken for frame in frames]
    assert [t for poses in shown for t in poses.time] == pytest.approx(times)


@pytest.mark.parametrize("suffix", [".jsonl", ".json", ""])
def test_a_file_is_a_camera_s_by_its_content_and_no_leap_s(tmp_path: Path, suffix: str) -> None:
    path = written(tmp_path / f"hands{suffix}", pictures())
    assert is_landmark_file(path) and kind_of(str(path)).sees is Sees.CAMERA


@pytest.mark.parametrize("content", [b"", b"\xff\xfe", b"[1]\n", b'{"hands": []}\n', b"1e9"])
def test_other_files_are_none(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "other"
    path.write_bytes(content)
    assert not is_landmark_file(path)


def test_a_file_plays_from_its_first_picture_at_its_own_speed(tmp_path: Path) -> None:
    frames = [replace(f, taken=f.taken + 100.0) for f in pictures(10)]
    device = LandmarkFileDevice(read_landmarks(written(tmp_path / "hands.jsonl", frames)))
    assert [f.taken for f in device.poll(0.0)] == [0.0]
    assert len(device.poll(0.1)) == 3
    assert not device.finished
    assert len(device.poll(1.0)) == 6
    assert device.finished


def test_a_frame_survives_a_recording_to_the_bit() -> None:
    for frame in pictures():
        line = json.loads(json.dumps(frame_to_json(frame)))
        assert frame_from_json(line) == frame


@given(st.binary(max_size=200))
def test_no_bytes_of_a_page_raise_anything_but_our_errors(data: bytes) -> None:
    try:
        frame_of(picture_message(data))
    except InputError:
        return
    raise AssertionError(f"{data!r} was taken for a picture")


BROKEN: dict[str, Callable[[dict[str, Any]], object]] = {
    "five hands": lambda good: good.update(seen=5 * good["seen"]),
    "a landmark missing": lambda good: good["seen"][0]["image"].pop(),
    "a landmark far away": lambda good: good["seen"][0].update(image=[[1e9, 0.0]] * 21),
    "a score of two": lambda good: good["seen"][0].update(score=2.0),
    "no such side": lambda good: good["seen"][0].update(side="both"),
    "no width": lambda good: good.update(size=[0, 480]),
    "a huge picture": lambda good: good.update(size=[10**7, 480]),
    "no time": lambda good: good.update(time=None),
    "a word for a time": lambda good: good.update(time="now"),
}


@pytest.mark.parametrize("change", BROKEN.values(), ids=BROKEN)
def test_a_picture_that_cannot_be_is_refused(change: Callable[[dict[str, Any]], Any]) -> None:
    good = json.loads(json.dumps(message_of(pictures(1)[0])))
    frame_of(picture_message(json.dumps(good)))
    change(good)
    with pytest.raises((FrameError, DeviceError)):
        frame_of(picture_message(json.dumps(good)))
