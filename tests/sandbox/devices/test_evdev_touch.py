"""Linux touch screens: whatever fingers do is what comes out, and lost events leave none stuck."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from models.errors import DeviceError
from models.frames import TouchFrame
from models.surface import Surface
from sandbox.devices.evdev.evdev_device import EvdevDevice, LinuxNode, evdev_surface, open_node
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
    MT_TOOL_PALM,
    SYN_DROPPED,
    SYN_REPORT,
    Axis,
    MultiTouch,
)
from tests.sandbox.devices.kernel_slots import KernelSlots
from tests.support.processes import PATIENCE

PLACES = st.tuples(st.integers(0, 4000), st.integers(0, 3000))
FINGERS = st.dictionaries(st.integers(0, 12), PLACES, max_size=10)


def opened(kernel: KernelSlots) -> EvdevDevice:
    surface = evdev_surface(kernel)
    assert surface is not None
    return EvdevDevice(kernel, surface)


def units(frame: TouchFrame) -> list[tuple[int, int]]:
    """Places of a frame's contacts in the units of the made-up screen, 20 per mm."""
    return sorted((round(c.x * 20_000), round(c.y * 20_000)) for c in frame.contacts)


@given(st.lists(FINGERS, min_size=1, max_size=20))
def test_whatever_fingers_do_is_what_comes_out(scenes: list[dict[int, tuple[int, int]]]) -> None:
    kernel = KernelSlots()
    device = opened(kernel)
    for scene in scenes:
        kernel.show(scene)
    frames = device.poll()
    assert [units(f) for f in frames] == [sorted(scene.values()) for scene in scenes]


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


def test_the_size_of_a_touch_is_in_metres() -> None:
    kernel = KernelSlots()
    kernel.set(0, ABS_MT_TOUCH_MAJOR, 160)
    kernel.show({1: (100, 100)})
    (contact,) = opened(kernel).poll()[0].contacts
    assert contact.size == pytest.approx(0.008)
    assert contact.extent == pytest.approx((0.008, 0.008)), "round without a smaller diameter"


def test_width_and_height_are_those_of_the_ellipse_in_units_of_its_own_axis() -> None:
    kernel = KernelSlots(diameter=Axis(0, 255, 2))
    kernel.set(0, ABS_MT_TOUCH_MAJOR, 60)
    kernel.set(0, ABS_MT_TOUCH_MINOR, 30)
    kernel.show({1: (100, 100), 2: (900, 900)})
    ellipse, unknown = opened(kernel).poll()[0].contacts
    assert ellipse.extent == pytest.approx((0.015, 0.030))
    assert unknown.extent is None


EVENTS = st.tuples(
    st.sampled_from([EV_SYN, EV_ABS, 1, 4]),
    st.sampled_from(
        [
            SYN_REPORT,
            SYN_DROPPED,
            ABS_MT_SLOT,
            ABS_MT_POSITION_X,
            ABS_MT_POSITION_Y,
            ABS_MT_TRACKING_ID,
            ABS_MT_TOOL_TYPE,
            999,
        ]
    ),
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
        device = opened_live(LinuxNode(screen.device.path))
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


def opened_live(node: LinuxNode) -> EvdevDevice:
    surface = evdev_surface(node)
    assert surface is not None
    assert surface.size == pytest.approx((0.2, 0.15))
    return EvdevDevice(node, surface)
