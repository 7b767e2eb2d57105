"""`check_device` finds what is wrong with a device, and nothing wrong with ours."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

import pytest

from encoders.air.camera import Camera
from models.errors import DeviceError
from models.frames import Contact, TouchFrame
from models.person import Person
from models.surface import Surface
from sandbox import check_device as public_check_device
from sandbox.devices.check_device import check_device, check_frames
from sandbox.devices.device import Place, TouchDevice
from sandbox.devices.evdev.evdev_device import EvdevDevice
from sandbox.devices.files.frame_file import FramesDevice
from sandbox.devices.leap.leap import LeapDevice, LeapFileDevice
from sandbox.devices.leap.leap_fake import FakeLeapd
from sandbox.devices.leap.leap_file import LeapRecording
from sandbox.devices.leap.leap_write import leap_message
from sandbox.devices.leap.two_hands import MergedLeaps as MergedLeap
from sandbox.devices.leap.two_hands import SplitBySide
from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.devices.registry import DeviceSettings, find_device
from sandbox.devices.simulated.in_air import SimulatedHeadset, SimulatedLeap
from sandbox.devices.simulated.simulated import SimulatedDevice
from sandbox.devices.simulated.spreads import SimulatedSpreads
from sandbox.devices.tuio.touch_capture import CaptureDevice, CapturedPacket, TouchCapture
from sandbox.devices.tuio.tuio import TuioDevice
from sandbox.devices.webcam.landmarks import LandmarkFileDevice, LandmarkRecording
from sandbox.devices.webcam.webcam import WebcamDevice
from sandbox.devices.webxr.webxr import HeadsetDevice
from sandbox.devices.wrappers.degraded import DegradedDevice
from sandbox.devices.wrappers.playing import LiftKeys, MergedDevice
from sandbox.devices.wrappers.shared import SharedDevice, Split, SplitByPlace
from sandbox.recording.recorded_device import RecordedDevice
from sandbox.recording.recording import load_recording
from sandbox.server.protocol import PageHands, PageScreen, PageTouches
from sandbox.server.web import WebDevice
from sandbox.trial.trial_options import parse_variation
from tasks.guarded import draw_task
from tasks.registry import find_task
from tasks.task import place_surface
from tasks.user import UserConfiguration
from tests.encoders.air.seen_hands import film, held_up
from tests.sandbox.devices.kernel_slots import KernelSlots
from tests.support.leap_hands import take
from tests.support.processes import ROOT, Sender
from tests.support.tuio_packets import frame, frame20

SCREEN = PageScreen(px_per_in=100.0, width_px=1000.0, height_px=500.0, calibrated=True)
SURFACE = Surface(10.0, 5.0)
TABLET = Surface()
BOX = find_task("box-to-goal")
TABLE = place_surface(TABLET, BOX)


def circle(step: int) -> dict[int, tuple[float, float]]:
    """Two fingers that come, move and go, in 0..1; each has a new id when it comes again."""
    if step % 20 > 15:
        return {}
    turn = 0.1 * step
    far = {1000 + step // 10: (0.5 + 0.4 * math.cos(turn), 0.5)} if step % 10 < 7 else {}
    return {1 + step // 20: (0.5, 0.5 + 0.5 * math.sin(turn)), **far}


def touches(surface: Surface) -> FramesDevice:
    size = surface.size
    frames = [
        TouchFrame(n / 60, tuple(Contact(i, x * size[0], y * size[1]) for i, (x, y) in c.items()))
        for n, c in enumerate(map(circle, range(40)))
    ]
    return FramesDevice(frames)


def move_mouse(device: MouseDevice, step: int) -> None:
    size = SURFACE.size
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
            device.lift_fingers()
        case _:
            device.move((step / 12 * size[0], 2.0 * size[1]))


def send_tuio(device: TuioDevice, step: int) -> None:
    with Sender(device.port) as send:
        send(frame(step + 1, circle(step), source="a"), frame20(step + 1, circle(step + 9)))


def send_touches(device: WebDevice, step: int) -> None:
    contacts = [(i, 1200.0 * x, 500.0 * y, 8.0, 8.0) for i, (x, y) in circle(step).items()]
    device.receive(PageTouches(step + 1, 0.0, contacts, [] if step % 3 else [1, 2, 77]), SCREEN)


def hold_keys(device: LiftKeys, step: int) -> None:
    device.hold((step // 10) % 3 - 1)


def send_hands(device: HeadsetDevice, step: int) -> None:
    device.receive(PageHands(step + 1, 0.0, []), SCREEN)


def capture(surface: Surface) -> CaptureDevice:
    packets = [CapturedPacket(n / 60, frame(n + 1, circle(n))) for n in range(40)]
    return CaptureDevice(TouchCapture(tuple(packets)), surface)


def degraded(surface: Surface) -> DegradedDevice:
    variation, _ = parse_variation("noise=1,dropped=5,ghosts=5,latency=40")
    return DegradedDevice(touches(surface), variation, surface, 3)


def simulated(surface: Surface) -> SimulatedDevice:
    task = draw_task(BOX, 3, surface)
    return SimulatedDevice(task, UserConfiguration(), surface, 3, False, 0.5, Person())


def simulated_leap(hand: int = 0) -> SimulatedLeap:
    task = draw_task(BOX, 3, TABLE)
    return SimulatedLeap(task, UserConfiguration(), 3, (0.0, 0.0, 0.0), hand=hand)


def recorded_leap() -> LeapFileDevice:
    return LeapFileDevice(LeapRecording(tuple(take(0).frames), (), "v1"))


def camera() -> LandmarkFileDevice:
    frames = film([held_up(10.0 * i) for i in range(20)], Camera())
    return LandmarkFileDevice(LandmarkRecording(tuple(frames), Camera()))


OF_TOUCHES: dict[str, tuple[Callable[[Surface], Any], Callable[[Any, int], None] | None]] = {
    "mouse": (MouseDevice, move_mouse),
    "tuio": (
        lambda s: TuioDevice(s, port=0, transport="all", websocket_port=0),
        send_tuio,
    ),
    "capture of tuio": (capture, None),
    "frames of a file": (touches, None),
    "web": (WebDevice, send_touches),
    "simulated": (simulated, None),
    "simulated, spreading": (lambda s: SimulatedSpreads(Person(), s, 3), None),
    "degraded": (degraded, None),
    "lift keys": (lambda s: LiftKeys(touches(s)), hold_keys),
    "screen of two hands": (
        lambda s: SharedDevice(touches(s), SplitByPlace([[0.06, 0.06], [0.19, 0.06]])).parts[0],
        None,
    ),
    "merged": (lambda s: MergedDevice([touches(s), MouseDevice(s)]), None),
    "recorded": (
        lambda s: RecordedDevice(load_recording(ROOT / "sandbox" / "data" / "demo.jsonl")),
        None,
    ),
}
"""How each is opened, and what makes touches on it."""


@pytest.mark.parametrize("name", OF_TOUCHES)
def test_every_touch_device_of_ours_keeps_to_the_rules(name: str) -> None:
    open_device, make_touches = OF_TOUCHES[name]
    # No class, which would be called with an argument, too.
    surface = TABLE if name.startswith(("simulated", "recorded")) else SURFACE
    check_device(partial(open_device), make_touches, surface)


def test_a_touch_screen_of_linux_keeps_to_the_rules() -> None:
    kernels = []

    def open_screen(surface: Surface) -> EvdevDevice:
        kernels.append(KernelSlots())
        return EvdevDevice(kernels[-1], surface)

    def touch(device: EvdevDevice, step: int) -> None:
        places = {i: (round(4000 * x), round(3000 * y)) for i, (x, y) in circle(step).items()}
        kernels[-1].show(places)
        if step % 7 == 6:
            kernels[-1].overflow(step % 3)

    check_device(open_screen, touch)


IN_THE_AIR: dict[str, tuple[Callable[[], Any], Callable[[Any, int], None] | None]] = {
    "recorded leap": (recorded_leap, None),
    "simulated leap": (simulated_leap, None),
    "leap of two hands": (
        lambda: SharedDevice(recorded_leap(), SplitBySide(("right", "left"))).parts[0],
        None,
    ),
    "two people over one leap": (
        lambda: MergedLeap([simulated_leap(), simulated_leap(hand=1)]),
        None,
    ),
    "headset": (HeadsetDevice, send_hands),
    "second hand of a headset": (lambda: SharedDevice(HeadsetDevice(), Split()).parts[1], None),
    "simulated headset": (
        lambda: SimulatedHeadset(draw_task(BOX, 3, TABLE), UserConfiguration(), 3),
        None,
    ),
    "recorded camera": (camera, None),
    "camera of two hands": (lambda: SharedDevice(camera(), Split()).parts[0], None),
}


@pytest.mark.parametrize("name", IN_THE_AIR)
def test_every_device_of_ours_for_hands_in_the_air_keeps_to_the_rules(name: str) -> None:
    open_device, act = IN_THE_AIR[name]
    check_device(lambda surface: open_device(), act)


def test_a_leap_keeps_to_the_rules_while_its_service_sends() -> None:
    messages = [leap_message(f, n) for n, f in enumerate(take(0).frames[:300])]
    server = FakeLeapd(messages, port=0, rate=290.0)
    try:
        check_device(lambda surface: LeapDevice(server.address))
    finally:
        server.close()


def test_a_camera_keeps_to_the_rules_without_a_page(tmp_path: Path) -> None:
    (tmp_path / "wasm").mkdir()
    check_device(lambda surface: WebcamDevice(tmp_path))


def test_the_device_of_the_page_on_devices_keeps_to_the_rules_by_its_place() -> None:
    public_check_device(f"{ROOT / 'examples' / 'circling_finger.py'}:CirclingFinger:2")


ONE = Contact(1, 0.1, 0.1)


@pytest.mark.parametrize(
    ("frames", "says"),
    [
        ([TouchFrame(1.0), TouchFrame(0.5)], "backwards"),
        ([TouchFrame(0.0, (Contact(1, 3.0, 2.0),))], "far off the surface.*metres"),
        ([TouchFrame(0.0, (Contact(1, 0.1, -0.01),))], "a contact is off the surface.*border"),
        ([TouchFrame(0.0, (Contact(1, 0.1, 0.1, 0.3),))], "larger than the surface"),
        ([TouchFrame(0.0, (ONE,), None, frozenset({1}))], "among the contacts"),
        (
            [TouchFrame(0.0, (ONE,)), TouchFrame(0.1, (), None, frozenset({2}))],
            "was no contact before",
        ),
        (["frame"], "something else than frames"),
    ],
)
def test_a_frame_that_breaks_a_rule_is_named(frames: list[Any], says: str) -> None:
    with pytest.raises(DeviceError, match=says):
        check_frames(frames, SURFACE)


class Sound(TouchDevice):
    """A device that follows all rules; each of those below breaks one."""

    def poll(self, now: float) -> Sequence[TouchFrame]:
        return []


def but(**members: Any) -> type[Sound]:
    """Makes a device that is not sound in these members."""
    return type("Odd", (Sound,), members)


def finishes_early(device: Any, now: float) -> Sequence[TouchFrame]:
    device.finished = now > 0.5
    return [TouchFrame(now)]


def closes_once(device: Any) -> None:
    if device.finished:
        raise RuntimeError("closed already")
    device.finished = True


def uses_ids_again(device: Any, now: float) -> Sequence[TouchFrame]:
    return [] if device.finished else [TouchFrame(now, (ONE,) if round(60 * now) % 9 else ())]


class OpensOnce(Sound):
    opened: ClassVar[list[int]] = []

    def __init__(self, surface: Surface, argument: str) -> None:
        super().__init__(surface, argument)
        self.opened.append(1)
        assert len(self.opened) < 2, "the port is in use"


LAST = TouchFrame(0.0, (ONE,))


@pytest.mark.parametrize(
    ("kind", "says"),
    [
        (but(name=""), "no name"),
        (but(finished=False, close=lambda self: None), "a closed device has not finished .*super"),
        (but(finished="perhaps"), "`finished` is neither true nor false"),
        (but(poll=lambda self, now: [TouchFrame(now)]), "a frame comes after|still has frames"),
        (but(poll=finishes_early), "a frame comes after the device had finished"),
        (but(poll=lambda self, now: [LAST]), "a frame comes twice"),
        (but(close=closes_once), "the second close fails .*closed already.*test_check_device.py:"),
        (OpensOnce, "opening fails .*in use"),
        (
            but(poll=lambda self, now: [] if self.finished else [TouchFrame(-now)]),
            "time runs backwards",
        ),
        (but(poll=uses_ids_again), "the id of a lifted finger comes again .*1"),
        (but(poll=lambda self, now: 1 / 0), "poll fails .*division.*test_check_device.py:"),
        (but(poll=lambda self, now: None), "something else than frames .*'None'"),
        # As a serial port with that timeout does.
        (but(poll=lambda self, now: time.sleep(0.02) or []), "waits, so that sessions fall behind"),
        (lambda surface: object(), "the object is not a device"),
        ("no-such-device", "no such device"),
    ],
)
def test_a_device_that_breaks_a_rule_is_refused_in_one_line(
    kind: Any, says: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sandbox.devices.check_device.STEPS", 40)
    monkeypatch.setattr(OpensOnce, "opened", [])
    with pytest.raises(DeviceError, match=says) as error:
        check_device(kind)
    assert "\n" not in str(error.value)


def test_a_device_that_blocks_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sandbox.devices.check_device.PATIENCE", 0.2)
    release = threading.Event()

    class Blocks(Sound):
        def poll(self, now: float) -> Sequence[TouchFrame]:
            release.wait(60.0)
            return []

    with pytest.raises(DeviceError, match="has not returned"):
        check_device(Blocks)
    release.set()


def test_a_place_that_holds_no_device_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "odd.py"
    file.write_text(
        "class Odd:\n    def __init__(self, surface, argument):\n        1 / len(argument)\n"
    )
    assert find_device("tuio:1") is None
    assert find_device("run.jsonl") is None
    for text, said in (
        (f"{file}:Missing", "Missing"),
        (f"{file}:Odd", "ZeroDivisionError"),
        (f"{file}:Odd:x", "without poll"),
        (f"{tmp_path}/none.py:Odd", "no such file"),
        ("no.such.module:Odd", "cannot be opened"),
    ):
        with pytest.raises(DeviceError, match=said):
            DeviceSettings.of(text).open(Place(SURFACE))


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
    (frame_, *_) = DeviceSettings.of("lab-pad:4").open(Place(SURFACE)).poll(0.1)
    assert isinstance(frame_, TouchFrame)
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
