"""Every device of ours keeps to what `sandbox.devices.conformance` asks; and it asks something."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from models.errors import DeviceError
from models.frames import Contact, TouchFrame
from models.person import Person
from models.surface import Surface
from sandbox.devices.conformance import DeviceConformance, check_frames
from sandbox.devices.evdev.evdev_device import EvdevDevice
from sandbox.devices.files.frame_file import FramesDevice
from sandbox.devices.mouse import MouseDevice
from sandbox.devices.registry import find_device
from sandbox.devices.simulated.simulated import SimulatedDevice
from sandbox.devices.simulated.spreads import SimulatedSpreads
from sandbox.devices.tuio.touch_capture import CaptureDevice, CapturedPacket, TouchCapture
from sandbox.devices.tuio.tuio import TuioDevice
from sandbox.devices.wrappers.degraded import DegradedDevice
from sandbox.devices.wrappers.lift_keys import LiftKeys
from sandbox.options.variations import parse_variation
from sandbox.recording.recorded_device import RecordedDevice
from sandbox.recording.recording import load_recording
from sandbox.server.protocol.protocol import PageScreen, PageTouches
from sandbox.server.web import WebDevice
from sandbox.session.device import Device
from tasks.guarded import draw_task
from tasks.registry import find_task
from tasks.user import UserConfiguration
from tests.sandbox.devices.kernel_slots import KernelSlots
from tests.support.processes import ROOT, Sender
from tests.support.tuio_packets import frame, frame20

SCREEN = PageScreen(px_per_in=100.0, width_px=1000.0, height_px=500.0, calibrated=True)


def circle(step: int) -> dict[int, tuple[float, float]]:
    """Two fingers that come, move and go, in 0..1."""
    if step % 20 > 15:
        return {}
    turn = 0.1 * step
    far = {2: (0.5 + 0.4 * math.cos(turn), 0.5)} if step % 10 < 7 else {}
    return {1: (0.5, 0.5 + 0.5 * math.sin(turn)), **far}


class TestMouse(DeviceConformance):
    def open(self, surface: Surface) -> Device:
        return MouseDevice(surface)

    def stir(self, device: Any, step: int) -> None:
        size = self.surface.size
        match step % 12:
            case 0:
                device.press((0.5 * size[0], 0.5 * size[1]))
            case 5:
                device.release()
            case 6:
                device.hand(5, 0.5 * size)
            case 8:
                device.wheel(3.0)
            case 11:
                device.lift()
            case _:
                device.move((step / 12 * size[0], 2.0 * size[1]))


class TestTuio(DeviceConformance):
    def open(self, surface: Surface) -> Device:
        return TuioDevice(surface, port=0, transport="all", websocket_port=0)

    def stir(self, device: Any, step: int) -> None:
        with Sender(device.port) as send:
            send(frame(step + 1, circle(step), source="a"), frame20(step + 1, circle(step + 9)))


class TestCapture(DeviceConformance):
    def open(self, surface: Surface) -> Device:
        packets = [CapturedPacket(n / 60, frame(n + 1, circle(n))) for n in range(40)]
        return CaptureDevice(TouchCapture(tuple(packets)), surface)


class TestFrames(DeviceConformance):
    def open(self, surface: Surface) -> Device:
        size = surface.size
        return FramesDevice(
            [
                TouchFrame(
                    n / 60, tuple(Contact(i, x * size[0], y * size[1]) for i, (x, y) in c.items())
                )
                for n, c in enumerate(map(circle, range(40)))
            ]
        )


class TestWeb(DeviceConformance):
    def open(self, surface: Surface) -> Device:
        return WebDevice(surface)

    def stir(self, device: Any, step: int) -> None:
        contacts = [(i, 1200.0 * x, 500.0 * y, 8.0, 8.0) for i, (x, y) in circle(step).items()]
        device.push(PageTouches(step + 1, 0.0, contacts, [] if step % 3 else [1, 2, 77]), SCREEN)
        if step % 25 == 24:
            device.cancel_all()


class TestEvdev(DeviceConformance):
    def open(self, surface: Surface) -> Device:
        self.kernel = KernelSlots()
        return EvdevDevice(self.kernel, surface)

    def stir(self, device: Device, step: int) -> None:
        places = {i: (round(4000 * x), round(3000 * y)) for i, (x, y) in circle(step).items()}
        self.kernel.show(places)
        if step % 7 == 6:
            self.kernel.overflow(step % 3)


class TestSimulated(DeviceConformance):
    surface = Surface()

    def open(self, surface: Surface) -> Device:
        task = draw_task(find_task("box-to-goal"), 3, surface)
        return SimulatedDevice(task, UserConfiguration(), surface, 3, False, 0.5, Person())


class TestSpreads(DeviceConformance):
    surface = Surface()

    def open(self, surface: Surface) -> Device:
        return SimulatedSpreads(Person(), surface, 3)


class TestSpoiled(DeviceConformance):
    def open(self, surface: Surface) -> Device:
        variation, _ = parse_variation("noise=1,dropped=5,ghosts=5,latency=40")
        return DegradedDevice(TestFrames().open(surface), variation, surface, 3)


class TestLiftKeys(DeviceConformance):
    def open(self, surface: Surface) -> Device:
        return LiftKeys(TestFrames().open(surface))

    def stir(self, device: Any, step: int) -> None:
        device.hold((step // 10) % 3 - 1)


class TestRecorded(DeviceConformance):
    surface = Surface()

    def open(self, surface: Surface) -> Device:
        return RecordedDevice(load_recording(ROOT / "sandbox" / "data" / "demo.jsonl"))


class TestExample(DeviceConformance):
    """The device that docs/write-a-device.md shows."""

    def open(self, surface: Surface) -> Device:
        maker = find_device(f"{ROOT / 'examples' / 'circling_finger.py'}:CirclingFinger:2")
        assert maker is not None
        return maker(surface)


SURFACE = Surface(10.0, 5.0)
ONE = Contact(1, 0.1, 0.1)


@pytest.mark.parametrize(
    ("frames", "said"),
    [
        ([TouchFrame(1.0), TouchFrame(0.5)], "backwards"),
        ([TouchFrame(0.0, (Contact(1, 0.5, 0.1),))], "off the surface"),
        ([TouchFrame(0.0, (Contact(1, 0.1, -0.01),))], "off the surface"),
        ([TouchFrame(0.0, (Contact(1, 0.1, 0.1, 0.3),))], "has a size of"),
        ([TouchFrame(0.0, (ONE,), None, frozenset({1}))], "among the contacts"),
        ([TouchFrame(0.0, (ONE,)), TouchFrame(0.1, (), None, frozenset({2}))], "was not a contact"),
        (["frame"], "not a TouchFrame"),
    ],
)
def test_what_is_wrong_with_frames_is_said(frames: list[Any], said: str) -> None:
    with pytest.raises(AssertionError, match=said):
        check_frames(frames, SURFACE)


class Bad(Device):
    """A device with everything; each of those below lacks one thing."""

    name = "bad"
    finished = False

    def __init__(self) -> None:
        self.frame = TouchFrame(0.0, (ONE,))
        self.closed = False

    def poll(self, now: float) -> Sequence[TouchFrame]:
        return []

    def close(self) -> None:
        self.closed = True


class SaysTwice(Bad):
    def poll(self, now: float) -> Sequence[TouchFrame]:
        return [self.frame]


class ClosesOnce(Bad):
    def close(self) -> None:
        if self.closed:
            raise RuntimeError("closed already")
        self.closed = True


class NeverEnds(Bad):
    def poll(self, now: float) -> Sequence[TouchFrame]:
        return [TouchFrame(now)]


class Nameless(Bad):
    name = ""


@pytest.mark.parametrize(
    ("kind", "rule"),
    [
        (SaysTwice, "test_what_was_polled_does_not_come_again"),
        (ClosesOnce, "test_it_may_be_closed_twice_and_polled_afterwards"),
        (NeverEnds, "test_it_may_be_closed_twice_and_polled_afterwards"),
        (Nameless, "test_it_has_a_name_and_says_whether_it_has_ended"),
    ],
)
def test_a_device_that_breaks_a_rule_fails_it(kind: type[Bad], rule: str) -> None:
    class Suite(DeviceConformance):
        def open(self, surface: Surface) -> Device:
            return kind()

    with pytest.raises((AssertionError, RuntimeError)):
        getattr(Suite(), rule)()


def test_a_device_that_waits_in_every_poll_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sandbox.devices.conformance.STEPS", 5)

    class Waits(Bad):
        def poll(self, now: float) -> Sequence[TouchFrame]:
            time.sleep(0.02)  # as a serial port with that timeout does
            return []

    class Suite(DeviceConformance):
        def open(self, surface: Surface) -> Device:
            return Waits()

    with pytest.raises(AssertionError, match="poll waits"):
        Suite().test_poll_comes_back_at_once_also_when_nothing_happens()


def test_a_device_that_blocks_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sandbox.devices.conformance.PATIENCE", 0.2)
    release = threading.Event()

    class Blocks(Bad):
        def poll(self, now: float) -> Sequence[TouchFrame]:
            release.wait(60.0)
            return []

    class Suite(DeviceConformance):
        def open(self, surface: Surface) -> Device:
            return Blocks()

    with pytest.raises(AssertionError, match="has not returned"):
        Suite().test_poll_comes_back_at_once_also_when_nothing_happens()
    release.set()


def test_a_place_that_holds_no_device_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "odd.py"
    file.write_text(
        "class Odd:\n    def __init__(self, surface, argument):\n        1 / len(argument)\n"
    )
    assert find_device("tuio") is None
    assert find_device("run.jsonl") is None
    for text, said in (
        (f"{file}:Missing", "Missing"),
        (f"{file}:Odd", "ZeroDivisionError"),
        (f"{file}:Odd:x", "without poll"),
        (f"{tmp_path}/none.py:Odd", "no such file"),
        ("no.such.module:Odd", "cannot be opened"),
    ):
        with pytest.raises(DeviceError, match=said):
            maker = find_device(text)
            assert maker is not None
            maker(SURFACE)


def test_a_device_of_an_installed_package_is_found_by_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    example = (ROOT / "examples" / "circling_finger.py").read_text()
    (tmp_path / "lab_pads.py").write_text(example)
    info = tmp_path / "lab_pads-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: lab-pads\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(
        "[hand_sandbox.devices]\nlab-pad = lab_pads:CirclingFinger\nlab-odd = lab_pads:Missing\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    maker = find_device("lab-pad:4")
    assert maker is not None
    (frame_, *_) = maker(SURFACE).poll(0.1)
    assert len(frame_.contacts) == 4
    with pytest.raises(DeviceError, match=r"lab-pads 1\.0"):
        find_device("lab-odd")
    again = tmp_path / "twice"
    (again / "other-2.0.dist-info").mkdir(parents=True)
    (again / "other-2.0.dist-info" / "METADATA").write_text("Name: other\nVersion: 2.0\n")
    (again / "other-2.0.dist-info" / "entry_points.txt").write_text(
        "[hand_sandbox.devices]\nlab-pad = other:Pad\n"
    )
    monkeypatch.syspath_prepend(again)
    with pytest.raises(DeviceError, match="several packages"):
        find_device("lab-pad")
