"""Every device has all members of the contract, also wrapped, and also one written elsewhere."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from models.errors import DeviceError
from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.devices.device import AnyDevice, Device, DeviceWrapper, Place, TouchDevice
from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.devices.own_device import AdaptedDevice, adapted
from sandbox.devices.registry import DeviceSettings
from sandbox.devices.wrappers.playing import LiftKeys, MergedDevice


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
    outside.notices = ["nothing moves"]
    assert device.notices == ["nothing moves"]


def test_what_an_adapted_device_comes_to_know_as_it_plays_is_heard() -> None:
    outside: Any = Minimal()
    device = adapted(outside, "test")
    assert (device.damage, dict(device.true_labels), device.clock_origin) == (None, {}, 0.0)
    outside.damage, outside.true_labels, outside.clock_origin = (
        DeviceError("cut short"),
        {7: 1},
        12.5,
    )
    assert device.damage is outside.damage
    assert (device.true_labels, device.clock_origin) == ({7: 1}, 12.5)


def test_what_is_missing_of_the_required_members_is_said() -> None:
    with pytest.raises(DeviceError, match="without close, finished"):
        adapted(type("Half", (), {"name": "half", "poll": lambda self, now: []})(), "test")


def test_our_base_class_is_opened_as_it_is(tmp_path: Path) -> None:
    file = tmp_path / "pad.py"
    file.write_text(
        "from sandbox.devices.device import TouchDevice\n"
        "class Pad(TouchDevice):\n"
        "    def poll(self, now):\n"
        "        return []\n"
    )
    # No adapter, only the guard.
    (pad,) = DeviceSettings.of(f"{file}:Pad:three").open(Place(Surface())).parts
    assert isinstance(pad, TouchDevice) and pad.argument == "three"
