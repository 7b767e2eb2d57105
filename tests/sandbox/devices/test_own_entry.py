"""A device of one's own that declares options: the gamepad of the page on devices."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from sandbox import check_device, load_recording, run_trial
from sandbox.cli.main import main
from sandbox.trial.settings import recorded_settings
from tests.support.processes import ROOT

GAMEPAD = f"{ROOT / 'examples' / 'gamepad.py'}:GAMEPAD"


EVENT = struct.Struct("IhBB")


BUTTON, AXIS = 1, 2


class Sticks:
    """A gamepad's node, into which a test writes events."""

    def __init__(self, path: Path) -> None:
        os.mkfifo(path)
        self.path = path
        # It is open for reading, too, so that writing does not wait for the device.
        self._file = os.open(path, os.O_RDWR)

    def set(self, kind: int, number: int, value: int) -> None:
        """Writes an event."""
        self.write(EVENT.pack(0, value, kind, number))

    def write(self, data: bytes) -> None:
        """Writes bytes."""
        os.write(self._file, data)

    def close(self) -> None:
        """Removes the gamepad."""
        os.close(self._file)


@pytest.fixture
def sticks(tmp_path: Path) -> Iterator[Sticks]:
    made = Sticks(tmp_path / "js0")
    yield made
    made.close()


def test_the_example_keeps_to_the_rules_for_devices(sticks: Sticks) -> None:
    def touch(device: Any, step: int) -> None:
        sticks.set(BUTTON, 4 + step % 2, int(step % 7 < 4))
        sticks.set(AXIS, step % 5, 32767 - 1000 * step)

    check_device(f"{GAMEPAD}:{sticks.path}", touch)


def test_its_option_moves_its_fingers_and_is_in_the_header(sticks: Sticks, tmp_path: Path) -> None:
    found = []
    for dead_zone in (0.2, 0.8):
        record = tmp_path / f"{dead_zone}.jsonl"
        sticks.set(BUTTON, 4, 1)
        sticks.set(AXIS, 0, 16384)
        run_trial(
            "tests/support/regress_tasks.py:Quick",
            device=f"{GAMEPAD}:{sticks.path}",
            dead_zone=dead_zone,
            record=record,
            real_time=False,
        )
        recording = load_recording(record)
        options = recorded_settings(recording.header).device.options
        assert options.own == {"dead_zone": dead_zone}
        xs = [frame.contacts[0].x for frame in recording.touches()]
        found.append(xs[-1] - xs[0])
    assert found[0] > 0.001 and found[1] == 0.0


@pytest.mark.parametrize(
    ("argv", "words"),
    [
        (["--device", GAMEPAD, "--dead-zone", "x"], ["--dead-zone: not a number", "'x'"]),
        (["--dead-zone", "1"], ["no such option", "--dead-zone"]),
        (["--leap-at", "0,0,0"], ["belongs to another device", "--leap-at", "--device leap"]),
        (["--device", "tuio", "--grab"], ["belongs to another device", "--device evdev"]),
        (["--device", "web", "--port", "3"], ["belongs to another device", "--device tuio"]),
        (["--device", "tuio", "--fingers", "3"], ["for simulated users only", "--fingers"]),
    ],
    ids=lambda words: " ".join(words[-2:]),
)
def test_an_option_of_a_device_is_refused_where_that_device_is_not(
    argv: list[str], words: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["run", "box-to-goal", *argv]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert all(word in line for word in words), line


NOT_FROZEN = ["pad.py:PAD", "@dataclass(frozen=True)"]


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (
            "@dataclass(frozen=True)\nclass Options:\n    seed: int = 3",
            ["the name of another option", "--seed"],
        ),
        (
            "@dataclass\nclass Options:\n    reach: int = 3",
            NOT_FROZEN,
        ),
        ("class Options:\n    reach = 3", NOT_FROZEN),
    ],
)
def test_options_that_share_a_name_or_are_no_frozen_dataclass_are_refused(
    options: str, said: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "pad.py"
    file.write_text(
        "from dataclasses import dataclass\n"
        "from sandbox import DeviceEntry\n"
        f"{options}\n"
        "PAD = DeviceEntry('a pad', lambda options, place: None, Options)\n"
    )
    assert main(["run", "box-to-goal", "--device", f"{file}:PAD"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert all(words in line for words in said)
