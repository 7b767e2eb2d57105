"""`sandbox stream` of hands over a Leap: PAALM's hands, in the frame of the device, no table."""

from __future__ import annotations

import json
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from models.motion.sampling import Poses
from models.rotations import quaternion_to_matrix
from sandbox.cli.main import main
from sandbox.devices.leap.leap import LeapDevice
from sandbox.devices.leap.leap_fake import FakeLeapd
from sandbox.devices.leap.leap_write import leap_message
from sandbox.stream.guest import Line
from sandbox.stream.hand_sources import source_of_leap
from tests.sandbox.export.test_export_leap import alone, together, write


def moments(text: str) -> list[Line]:
    lines = [Line(command.split("'")[1]) for command in text.strip().splitlines()]
    return [line for line in lines if line.kind == "moment"]


def test_both_hands_are_streamed_each_as_its_own(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = write(tmp_path / "both.json", together()[:150])
    assert main(["stream", str(path), "--print", "--speed", "100"]) == 0
    told = moments(capsys.readouterr().out)
    right, left = ([line.place[0] for line in told if line.side == s] for s in ("right", "left"))
    assert len(right) == len(left) > 80 and min(right) > 0.0 > max(left)


@pytest.mark.parametrize("sides", [("right",), ("left",), ("right", "left")])
def test_hands_over_a_live_leap_are_where_the_device_sees_them(sides: tuple[str, ...]) -> None:
    still = together() if len(sides) == 2 else alone(sides[0])
    still = [replace(still[0], time=0.01 * i) for i in range(100)]
    messages = [leap_message(frame, i) for i, frame in enumerate(still)]
    server = FakeLeapd(messages, port=0, rate=100.0, loop=True)
    device, stop, seen = LeapDevice(server.address), threading.Event(), []

    def take(poses: Poses) -> None:
        seen.append(poses)
        if len(seen) == 150:
            stop.set()

    try:
        assert device.wait(10.0)
        source = source_of_leap(device, sides, {}, stop)
        assert source.names == sides and len(source.remarks) == len(sides)
        assert source.play(take) == ""
    finally:
        device.close()
        server.close()
    for i, armature in enumerate(source.armatures):
        keys = armature.of_turns(seen[-1].root[:, i], quaternion_to_matrix(seen[-1].turns[:, i]))
        tips = armature.place(keys)[1][0]
        hand = next(h for h in still[0].hands if (h.palm[0] > 0.0) == (sides[i] == "right"))
        # An average hand, whose palm is found from what its fingers show.
        for tip in tips[1:]:
            assert min(np.linalg.norm(tip - f.tip) for f in hand.fingers) < 0.006


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["{leap}", "--task", "stack"], "its own task or none"),
        (["{leap}", "--leap-at", "0,0,0.3"], "in the frame of the Leap"),
        (["{leap}", "--hand", "both"], "never shows two hands"),
        (["--device", "tuio", "--hand", "both"], "both hands can be streamed from a Leap"),
        (["--device", "{leap}", "--task", "stack", "--hand", "both"], "without a task"),
        (["{none}"], "this recording has no hand"),
    ],
)
def test_what_cannot_be_streamed_is_refused_in_one_line(
    words: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    leap = write(tmp_path / "leap.json", alone("right")[:60])
    none = tmp_path / "none.json"
    none.write_text(
        json.dumps([{"timestamp": 10_000 * i, "hands": [], "pointables": []} for i in range(9)])
    )
    words = [word.format(leap=leap, none=none) for word in words]
    assert main(["stream", *words, "--print"]) == 2
    lines = [t for t in capsys.readouterr().err.splitlines() if t.startswith("sandbox: ")]
    assert len(lines) == 1 and said in lines[0]
