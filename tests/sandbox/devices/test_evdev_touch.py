"""Linux touch screens: whatever fingers do is what comes out, and lost events leave none stuck."""

from __future__ import annotations

import os
import sys
import time
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import DeviceError
from models.frames import TouchFrame
from models.surface import Surface
from sandbox.devices.evdev.evdev_device import (
    EvdevDevice,
    LinuxNode,
    calibration,
    evdev_surface,
    open_node,
)
from sandbox.devices.evdev.evdev_touch import (
    ABS_MT_DISTANCE,
    ABS_MT_POSITION_X,
    ABS_MT_POSITION_Y,
    ABS_MT_SLOT,
    ABS_MT_TOOL_TYPE,
    ABS_MT_TOUCH_MAJOR,
    ABS_MT_TOUCH_MINOR,
    ABS_MT_TRACKING_ID,
    EV_ABS,
    EV_SYN,
    INPUT_PROP_DIRECT,
    INPUT_PROP_SEMI_MT,
    MT_TOOL_PALM,
    SYN_DROPPED,
    SYN_REPORT,
    TURNED,
    Axis,
    Matrix,
    MultiTouch,
    read_matrix,
    why_unusable,
)
from tests.sandbox.devices.kernel_slots import KernelSlots
from tests.support.processes import PATIENCE

PLACES = st.tuples(st.integers(0, 4000), st.integers(0, 3000))
FINGERS = st.dictionaries(st.integers(0, 12), PLACES, max_size=10)


def opened(node: KernelSlots | LinuxNode) -> EvdevDevice:
    surface = evdev_surface(node)
    assert surface is not None
    return EvdevDevice(node, surface)


def units(frame: TouchFrame) -> list[tuple[int, int]]:
    """Places of a frame's contacts in the units of the made-up screen, 20 per mm."""
    return sorted((round(c.x * 20_000), round(c.y * 20_000)) for c in frame.contacts)


@given(st.lists(st.tuples(FINGERS, st.booleans(), st.integers(0, 9)), min_size=1, max_size=20))
def test_after_lost_events_the_fingers_are_those_that_are_down(
    scenes: list[tuple[dict[int, tuple[int, int]], bool, int]],
) -> None:
    kernel = KernelSlots()
    device = opened(kernel)
    for scene, lost, kept in scenes:
        kernel.show(scene)
        if lost:
            kernel.overflow(kept)
        frames = device.poll()
        assert units(frames[-1]) == sorted(scene.values())
    assert device.dropped == sum(lost for _, lost, _ in scenes)


@given(st.lists(FINGERS, min_size=2, max_size=20))
def test_a_finger_keeps_its_id_for_as_long_as_it_is_down_and_no_longer(
    scenes: list[dict[int, tuple[int, int]]],
) -> None:
    kernel = KernelSlots()
    device = opened(kernel)
    before: dict[int, int] = {}
    for scene in scenes:
        kernel.show(scene)
        (frame,) = device.poll()
        values = kernel.slots().values
        now = {f: values[slot][ABS_MT_TRACKING_ID] for f, slot in kernel.fingers.items()}
        assert {c.id for c in frame.contacts} == set(now.values())
        assert all(now[f] == before[f] for f in now if f in before)
        assert not {now[f] for f in now if f not in before} & set(before.values())
        before = now


def test_a_new_finger_at_the_x_of_the_one_before_it_is_in_its_place() -> None:
    # The kernel does not repeat an x that the slot holds already.
    touch = MultiTouch(Axis(0, 100), Axis(0, 100), (1.0, 1.0))
    events = [
        *((ABS_MT_SLOT, 0), (ABS_MT_TRACKING_ID, 5), (ABS_MT_POSITION_X, 30)),
        *((ABS_MT_POSITION_Y, 40), (ABS_MT_TRACKING_ID, -1), (ABS_MT_TRACKING_ID, 6)),
        (ABS_MT_POSITION_Y, 70),
    ]
    for code, value in events:
        assert not touch.feed(EV_ABS, code, value)
    assert touch.feed(EV_SYN, SYN_REPORT, 0)
    (contact,) = touch.contacts()
    assert (contact.id, contact.x, contact.y) == (6, 0.3, 0.7)


def test_an_id_in_two_slots_is_one_finger_and_the_other_slot_is_counted() -> None:
    touch = MultiTouch(Axis(0, 100), Axis(0, 100), (1.0, 1.0))
    for slot, x in ((0, 30), (1, 60)):
        for code, value in (
            (ABS_MT_SLOT, slot),
            (ABS_MT_TRACKING_ID, 9),
            (ABS_MT_POSITION_X, x),
            (ABS_MT_POSITION_Y, 40),
        ):
            touch.feed(EV_ABS, code, value)
    assert touch.feed(EV_SYN, SYN_REPORT, 0)
    assert [(c.id, c.x) for c in touch.contacts()] == [(9, 0.3)]
    assert "touches with the id of another" in touch.report.line()


def test_fingers_that_lie_on_it_when_it_is_opened_are_seen() -> None:
    kernel = KernelSlots()
    kernel.show({1: (100, 200), 2: (300, 400)})
    list(kernel.read())  # nobody was listening
    device = opened(kernel)
    assert [units(f) for f in device.poll()] == [[(100, 200), (300, 400)]]
    assert device.poll() == []


def test_units_are_the_device_s_own_and_a_size_that_is_given_is_believed() -> None:
    kernel = KernelSlots(x=Axis(-100, 1900, 10), y=Axis(0, 1500, 10))
    surface = evdev_surface(kernel)
    assert surface is not None
    assert surface.size == pytest.approx((0.2, 0.15))
    assert evdev_surface(KernelSlots(x=Axis(0, 4000, 0))) is None
    device = EvdevDevice(kernel, Surface(10.0, 5.0))
    kernel.show({1: (900, 750)})
    (contact,) = device.poll()[0].contacts
    assert (contact.x, contact.y) == pytest.approx((0.127, 0.0635))


def test_a_palm_is_cancelled_and_what_hovers_is_no_touch() -> None:
    kernel = KernelSlots()
    device = opened(kernel)
    kernel.show({1: (100, 100), 2: (200, 200)})
    (first,) = device.poll()
    kernel.set(0, ABS_MT_TOOL_TYPE, MT_TOOL_PALM)
    kernel.show({1: (100, 100), 2: (200, 200)})
    (palm,) = device.poll()
    assert units(palm) == [(200, 200)]
    assert palm.cancelled == {c.id for c in first.contacts} - {c.id for c in palm.contacts}
    kernel.set(1, ABS_MT_DISTANCE, 3)
    kernel.show({1: (100, 100), 2: (200, 200)})
    (hovering,) = device.poll()
    assert (hovering.contacts, hovering.cancelled) == ((), frozenset())


@pytest.mark.parametrize(
    ("major", "minor", "known"),
    [
        *((160, 0, True), (2400, 0, True), (1600, 300, True), (10, 0, False), (3100, 0, False)),
        *((60_000, 160, False), (160, 1, False), (2000, 150, False), (2**31 - 1, 1, False)),
    ],
)
def test_a_size_that_no_finger_has_is_unknown_and_counted(
    major: int, minor: int, known: bool
) -> None:
    kernel = KernelSlots()
    kernel.set(0, ABS_MT_TOUCH_MAJOR, major)
    kernel.set(0, ABS_MT_TOUCH_MINOR, minor)
    kernel.show({1: (100, 100)})
    device = opened(kernel)
    (contact,) = device.poll()[0].contacts
    # Without a resolution of its own, a diameter is in units of x, here 20 per mm.
    assert contact.size == (pytest.approx(major / 20_000) if known else None)
    assert (contact.extent is None, bool(device.report.left_out)) == (not known, not known)


MOUNTED = {0: (0.1, 0.2), 90: (0.8, 0.1), 180: (0.9, 0.8), 270: (0.2, 0.9)}
"""Where a touch at 0.1, 0.2 of a panel is on the surface, by degrees clockwise."""


@pytest.mark.parametrize("degrees", MOUNTED)
def test_a_panel_that_is_mounted_turned_is_turned_back(degrees: int) -> None:
    kernel = KernelSlots(matrix=TURNED[degrees], diameter=Axis(0, 255, 10))
    kernel.set(0, ABS_MT_TOUCH_MAJOR, 120)
    kernel.set(0, ABS_MT_TOUCH_MINOR, 60)
    kernel.show({1: (400, 600)})
    surface = evdev_surface(kernel)
    assert surface is not None
    width, height = surface.size
    sides = degrees in (90, 270)
    assert (width, height) == pytest.approx((0.15, 0.2) if sides else (0.2, 0.15))
    (contact,) = opened(kernel).poll()[0].contacts
    assert (contact.x / width, contact.y / height) == pytest.approx(MOUNTED[degrees])
    assert contact.extent == pytest.approx((0.012, 0.006) if sides else (0.006, 0.012))


@pytest.mark.parametrize(
    ("text", "matrix"),
    [
        ("0 -1 1 1 0 0", TURNED[90]),
        ("-1.000000 0.0 1.0 0.0 -1.0 1.0", TURNED[180]),
        ("0 1 0 -1 0 1 0 0 1", TURNED[270]),
        ("1.1 0 -0.05 0 1.2 -0.1", (1.1, 0.0, -0.05, 0.0, 1.2, -0.1)),
        *((odd, None) for odd in ("", "1 0 0 0 1", "1 0 0 0 1 nan", "a b c d e f")),
        *((odd, None) for odd in ("0 0 0 0 0 0", "1 0 0 0 1 0 1 0 0")),
    ],
)
def test_libinput_s_matrix_is_read_where_udev_has_one(
    tmp_path: Path, text: str, matrix: Matrix | None
) -> None:
    assert read_matrix(text) == matrix
    number = os.stat("/dev/null").st_rdev
    data = tmp_path / f"c{os.major(number)}:{os.minor(number)}"
    assert calibration("/dev/null", tmp_path) is None
    data.write_text(f"I:1\nE:ID_INPUT=1\nE:LIBINPUT_CALIBRATION_MATRIX={text}\n")
    if matrix is None and text:
        with pytest.raises(DeviceError, match="--turned 0"):
            calibration("/dev/null", tmp_path)
    else:
        assert calibration("/dev/null", tmp_path) == matrix


def test_a_position_far_beyond_the_panel_costs_itself_alone() -> None:
    kernel = KernelSlots()
    device = opened(kernel)
    kernel.show({1: (100, 100), 2: (4200, 3100), 3: (2**31 - 1, 0), 4: (0, -2000)})
    (frame,) = device.poll()
    assert units(frame) == [(100, 100), (4000, 3000)]
    assert device.report.left_out == {"positions beyond the surface": 2}


ABS = {
    code: Axis(0, 4000, 20)
    for code in (ABS_MT_SLOT, ABS_MT_POSITION_X, ABS_MT_POSITION_Y, ABS_MT_TRACKING_ID)
}
KINDS: dict[str, tuple[dict[int, Axis], str]] = {
    "protocol B": (ABS, ""),
    "protocol A": ({c: a for c, a in ABS.items() if c != ABS_MT_SLOT}, "protocol A"),
    "no ids": ({c: a for c, a in ABS.items() if c != ABS_MT_TRACKING_ID}, "tracking ids"),
    "one finger": ({0: Axis(0, 9), 1: Axis(0, 9)}, "one finger"),
    "no touches": ({}, "no touches"),
    "no y": ({c: a for c, a in ABS.items() if c != ABS_MT_POSITION_Y}, "no touches"),
    "no width": (ABS | {ABS_MT_POSITION_X: Axis(0, 0)}, "no length"),
    "backwards": (ABS | {ABS_MT_POSITION_Y: Axis(9, 0)}, "no length"),
}


@pytest.mark.parametrize(("axes", "reason"), KINDS.values(), ids=KINDS)
def test_a_node_that_cannot_work_is_refused_for_its_own_reason(
    axes: dict[int, Axis], reason: str
) -> None:
    assert reason in why_unusable(axes)
    assert bool(reason) == bool(why_unusable(axes))


class FakeNodes:
    """The package evdev on a machine with some nodes: path -> its axes and properties."""

    def __init__(self, nodes: dict[str, tuple[dict[int, Axis], list[int]]]) -> None:
        self._nodes = nodes

    def list_devices(self) -> list[str]:
        return list(self._nodes)

    def InputDevice(self, path: str) -> Any:  # noqa: N802  (the package's name)
        axes, properties = self._nodes[path]
        absolute = [
            (c, SimpleNamespace(min=a.low, max=a.high, resolution=a.resolution))
            for c, a in axes.items()
        ]
        return SimpleNamespace(
            name=f"panel {path[-1]}",
            capabilities=lambda absinfo: {EV_ABS: absolute},
            input_props=lambda: properties,
            close=lambda: None,
        )


def test_the_node_that_is_opened_is_the_best_that_works(monkeypatch: pytest.MonkeyPatch) -> None:
    a, b, c = (f"/dev/input/event{n}" for n in "123")
    semi, screen, pad = [INPUT_PROP_SEMI_MT], [INPUT_PROP_DIRECT], [0]

    def chosen(*kinds: tuple[dict[int, Axis], list[int]]) -> str:
        nodes = FakeNodes(dict(zip((a, b, c), kinds, strict=False)))
        monkeypatch.setitem(sys.modules, "evdev", nodes)
        return open_node().name

    old = KINDS["protocol A"][0]
    assert a in chosen((ABS, pad))
    assert b in chosen((ABS, pad), (ABS, screen))
    assert c in chosen((ABS, semi), (old, screen), (ABS, pad))
    assert b in chosen((KINDS["no ids"][0], screen), (ABS, semi))
    with pytest.raises(DeviceError, match="protocol A"):
        chosen(({}, []), (old, screen))
    with pytest.raises(DeviceError, match="usermod"):
        chosen(({}, []), (KINDS["one finger"][0], pad))
    with pytest.raises(DeviceError, match="tracking ids"):
        monkeypatch.setitem(sys.modules, "evdev", FakeNodes({a: (KINDS["no ids"][0], screen)}))
        open_node(a)


CODES = [
    *(SYN_REPORT, SYN_DROPPED, ABS_MT_SLOT, ABS_MT_POSITION_X, ABS_MT_POSITION_Y),
    *(ABS_MT_TRACKING_ID, ABS_MT_TOOL_TYPE, 999),
]
EVENTS = st.tuples(
    st.sampled_from([EV_SYN, EV_ABS, 1, 4]),
    st.sampled_from(CODES),
    st.sampled_from([-(2**31), -1, 0, 1, 2, 5, 63, 64, 2**31 - 1]),
)


@given(st.lists(EVENTS, max_size=60))
def test_a_broken_driver_makes_no_contact_beyond_the_surface(
    events: list[tuple[int, int, int]],
) -> None:
    touch = MultiTouch(Axis(0, 4000, 20), Axis(0, 3000, 20), (0.2, 0.15))
    for event in events:
        touch.feed(*event)
        contacts = touch.contacts()
        assert len({c.id for c in contacts}) == len(contacts) <= 64
        assert all(0.0 <= c.x <= 0.2 and 0.0 <= c.y <= 0.15 for c in contacts)


def test_a_device_that_is_unplugged_cancels_its_touches_and_says_so() -> None:
    kernel = KernelSlots()
    device = opened(kernel)
    kernel.show({1: (100, 100)})
    (down,) = device.poll()
    kernel.gone = True
    (last,) = device.poll()
    assert last.contacts == ()
    assert last.cancelled == {c.id for c in down.contacts}
    # What has ended is a trial that counts; what has failed is not.
    assert not device.finished
    with pytest.raises(DeviceError, match="gone"):
        device.poll()
    device.close()
    device.close()
    assert kernel.closed == 1


@pytest.mark.parametrize("path", ["/dev/input/event-none", "/dev/null", "pyproject.toml"])
def test_a_node_that_is_no_touch_device_is_refused(path: str) -> None:
    with pytest.raises(DeviceError, match=path):
        open_node(path)


def test_a_screen_made_with_uinput_is_read_like_a_real_one(
    device_node: Callable[[str], Path],
) -> None:
    device_node("/dev/uinput")
    from evdev import AbsInfo, UInput

    axes = {
        ABS_MT_SLOT: AbsInfo(0, 0, 9, 0, 0, 0),
        ABS_MT_TRACKING_ID: AbsInfo(0, 0, 65_535, 0, 0, 0),
        ABS_MT_POSITION_X: AbsInfo(0, 0, 4000, 0, 0, 20),
        ABS_MT_POSITION_Y: AbsInfo(0, 0, 3000, 0, 0, 20),
    }
    with UInput({EV_ABS: list(axes.items())}, name="hand-sandbox test") as screen:
        device = opened(LinuxNode(screen.device.path))
        script = KernelSlots()
        scenes = [{1: (100, 200)}, {1: (150, 200), 2: (3000, 2000)}, {2: (3000, 1000)}, {}]
        for scene in scenes:
            script.show(scene)
            for event in script.read():
                screen.write(*event)
        frames: list[TouchFrame] = []
        end = time.monotonic() + PATIENCE
        while len(frames) < len(scenes) and time.monotonic() < end:
            frames += device.poll()
            time.sleep(0.005)
        assert [units(f) for f in frames] == [sorted(s.values()) for s in scenes]
        device.close()
