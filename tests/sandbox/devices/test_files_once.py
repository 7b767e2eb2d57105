"""A file that plays as a device is read once, however often it is checked and opened."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.cli.main import main
from sandbox.devices.files.frame_file import frame_record, header_record, read_frame_file
from sandbox.devices.leap.leap_file import read_leap
from sandbox.devices.leap.leap_write import write_take
from sandbox.recording.recording import load_recording
from sandbox.trial.assembly import device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tasks.guarded import draw_task
from tasks.registry import find_task
from tests.support.leap_hands import take


class Reads:
    """A reader that counts how often it reads."""

    def __init__(self, read: Callable[[Path], Any]) -> None:
        self.read, self.count = read, 0

    def __call__(self, path: Path) -> Any:
        self.count += 1
        return self.read(path)


def opened(device: str, trials: int = 3) -> None:
    """Makes settings of a device, and opens it for several trials."""
    task = draw_task(find_task("box-to-goal"), 1, Surface())
    for _ in range(trials):
        chosen = trial_settings(TrialOptions(device=device))
        for make in device_makers(chosen):
            make(task, Surface()).close()


def touches(path: Path, count: int) -> Path:
    frames = [TouchFrame(n / 60, (Contact(1, 0.05, 0.05),)) for n in range(count)]
    lines = [header_record(Surface(), "a pad"), *map(frame_record, frames)]
    path.write_text("\n".join(map(json.dumps, lines)) + "\n")
    return path


def test_touches_are_read_once_and_again_when_the_file_has_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reads = Reads(read_frame_file)
    monkeypatch.setattr("sandbox.devices.files.touch_files.read_frame_file", reads)
    file = touches(tmp_path / "pad.jsonl", 3)
    opened(str(file))
    assert reads.count == 1
    touches(file, 5)
    opened(str(file))
    assert reads.count == 2


def test_a_leap_recording_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    reads = Reads(read_leap)
    monkeypatch.setattr("sandbox.devices.leap.leap_file.read_leap", reads)
    write_take(take(1), tmp_path / "hand.json", {})
    opened(str(tmp_path / "hand.json"))
    assert reads.count == 1


def test_a_recording_of_two_hands_is_read_once_for_both(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "two.jsonl"
    task = ["carry-together", "--user", "idle", "--seed", "3"]
    monkeypatch.setattr("tasks.carry_together.CarryTogether.time_limit", 0.5)
    assert main(["run", *task, "--record", str(path)]) == 0
    reads = Reads(load_recording)
    monkeypatch.setattr("sandbox.recording.recording.load_recording", reads)
    monkeypatch.setattr("sandbox.trial.trial_options.load_recording", reads)
    opened(str(path))
    assert reads.count == 1
