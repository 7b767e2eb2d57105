"""Devices have all members of the contract, also wrapped ones and those of other people."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.errors import DeviceError
from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox import run_trial
from sandbox.cli.main import main
from sandbox.devices.device import AnyDevice, Device, DeviceWrapper
from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.devices.own_device import AdaptedDevice, adapted
from sandbox.devices.wrappers.playing import LiftKeys, MergedDevice
from sandbox.recording.recording import load_recording


class Bare(Device):
    def poll(self, now: float) -> Sequence[TouchFrame]:
        return []


class Minimal:
    """A device that knows nothing of our base class."""

    name, finished = "minimal", False

    def poll(self, now: float) -> list[TouchFrame]:
        return [TouchFrame(now, (Contact(1, 0.01, 0.02),))]

    def close(self) -> None:
        self.finished = True


def public(kind: type) -> set[str]:
    return {name for name in vars(kind) if not name.startswith("_")}


def test_a_wrapper_forwards_every_member_of_the_contract() -> None:
    assert public(DeviceWrapper) == public(AnyDevice) - {"within", "find"}


def test_a_device_is_found_inside_wrappers_and_merged_devices() -> None:
    mouse = MouseDevice(Surface())
    both = DeviceWrapper(MergedDevice([LiftKeys(mouse), Bare()]))
    assert both.find(MouseDevice) is mouse
    assert isinstance(both.find(LiftKeys), LiftKeys)
    assert both.find(Minimal) is None
    assert mouse.frame_ready is both.frame_ready


def test_a_device_with_the_four_required_members_is_completed() -> None:
    device = adapted(Minimal(), "test")
    assert isinstance(device, AdaptedDevice) and device.name == device.title == "minimal"
    assert device.poll(0.5)[0].contacts[0].id == 1
    assert (
        not (device.finished or device.lift or device.takes_snapshots)
        and device.frame_ready is None
    )
    device.close()
    assert device.finished


def test_optional_members_of_an_adapted_device_are_used() -> None:
    outside: Any = Minimal()
    seen: list[Any] = []
    outside.address, outside.lift, outside.frame_ready = "host:1", True, threading.Event()
    outside.show, outside.wait = seen.append, lambda seconds: False
    device: Any = adapted(outside, "test")
    assert (device.address, device.lift, device.takes_snapshots) == ("host:1", True, True)
    assert device.frame_ready is outside.frame_ready and not device.wait(9.0)
    device.show("snapshot")
    assert seen == ["snapshot"]
    MergedDevice([device]).frame_ready.set()
    assert outside.frame_ready.is_set()
    # Members that change while the device plays.
    assert (device.damage, dict(device.true_labels), device.clock_origin) == (None, {}, 0.0)
    changed = ["nothing moves"], DeviceError("cut short"), {7: 1}, 12.5
    outside.notices, outside.damage, outside.true_labels, outside.clock_origin = changed
    assert (device.notices, device.damage, device.true_labels, device.clock_origin) == changed


@pytest.mark.parametrize(
    ("frames", "said"),
    [
        ("None", "`poll` of this device fails"),
        ("1 / 0", "ZeroDivisionError"),
        ("sys.exit(0)", "SystemExit"),
        ("[(0, 0.1, 0.1)]", "something else than frames"),
        ("[TouchFrame(now, (Contact(0, float('nan'), 0.1),))]", "must be finite"),
        ("[TouchFrame(now, (Contact(0, 3.0, 2.0),))]", "far off the surface"),
        ("[TouchFrame(now, (Contact(2**70, 0.1, 0.1),))]", "more than 64 bits"),
        ("[TouchFrame(now, (Contact(0.5, 0.1, 0.1),))]", "value that is not a number"),
        ("[TouchFrame(now, (Contact('a', 0.1, 0.1),))]", "value that is not a number"),
    ],
)
def test_an_error_in_the_poll_of_a_device_of_ones_own_is_one_line_with_its_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], frames: str, said: str
) -> None:
    file = tmp_path / "odd.py"
    file.write_text(
        "import sys\nfrom models import Contact, TouchFrame\n"
        "from sandbox import TouchDevice\n"
        "class Odd(TouchDevice):\n"
        f"    def poll(self, now):\n        return {frames}\n"
    )
    assert main(["run", "box-to-goal", "--device", f"{file}:Odd"]) != 0
    lines = [line for line in capsys.readouterr().err.splitlines() if said in line]
    assert len(lines) == 1 and "odd.py:Odd" in lines[0]


def test_numbers_of_numpy_are_recorded_as_any_others(tmp_path: Path) -> None:
    file, record = tmp_path / "pad.py", tmp_path / "run.jsonl"
    file.write_text(
        "import numpy as np\n"
        "from models import Contact, TouchFrame\n"
        "from sandbox import TouchDevice\n"
        "class Pad(TouchDevice):\n"
        "    def poll(self, now):\n"
        "        self.finished = now > 0.1\n"
        "        x, y, size = np.array([0.08, 0.06, 0.01], np.float32)\n"
        "        one = Contact(np.int64(3), x, y, size, np.uint8(1), (size, size))\n"
        "        gone = frozenset({np.int32(2)})\n"
        "        return [TouchFrame(np.float32(now), (one,), np.float32(0.5), gone)]\n"
    )
    run_trial("box-to-goal", seed=1, device=f"{file}:Pad", record=record, real_time=False)
    touches = load_recording(record).touches()
    assert touches and {type(c.x) for frame in touches for c in frame.contacts} == {float}
    assert touches[0].contacts[0].x == float(np.float32(0.08))
