"""Linux touch screens and trackpads, read from /dev/input (extra `evdev`)."""

from __future__ import annotations

import array
import contextlib
import errno
import os
import time
from collections.abc import Iterable, Sequence
from typing import Any, Protocol

from models.errors import DeviceError
from models.frames import TouchFrame
from models.surface import METRES_PER_INCH, Surface
from sandbox.devices.device import Device
from sandbox.devices.evdev.evdev_touch import (
    ABS_MT_POSITION_X,
    ABS_MT_POSITION_Y,
    ABS_MT_SLOT,
    ABS_MT_TOUCH_MAJOR,
    EV_ABS,
    MAX_SLOTS,
    SLOT_CODES,
    Axis,
    MultiTouch,
    Slots,
)

_INPUT_PROP_DIRECT = 0x01
"""Property of touch screens, as opposed to trackpads."""


class Node(Protocol):
    """An open device node, as `EvdevDevice` needs it."""

    name: str
    x: Axis
    y: Axis
    diameter: Axis | None

    def read(self) -> Iterable[tuple[int, int, int]]:
        """Waiting events (kind, code, value); never blocks.

        Raises:
            OSError: The device is gone.
        """

    def slots(self) -> Slots:
        """Current values of the slots."""

    def close(self) -> None:
        """Closes the node."""


class EvdevDevice(Device):
    """A touch screen or trackpad.

    `poll` never blocks, so there is no thread. After a long time without a poll the kernel's buffer
    overflows; then the slots are read again, so that no finger gets stuck.

    Args:
        node: Node from `open_node`.
        surface: The touch surface, which the axes span; see `evdev_surface`.
    """

    name = "evdev"

    def __init__(self, node: Node, surface: Surface) -> None:
        self._node = node
        size = float(surface.size[0]), float(surface.size[1])
        self._touch = MultiTouch(node.x, node.y, size, node.slots(), node.diameter)
        self._present: frozenset[int] = frozenset()
        self._failure: DeviceError | None = None
        self._first = True
        self._closed = False

    @property
    def title(self) -> str:
        """Name of the device as the driver reports it, and its node."""
        return self._node.name

    @property
    def dropped(self) -> int:
        """Number of times that the kernel lost events."""
        return self._touch.dropped

    @property
    def finished(self) -> bool:
        """True once closed; a device that was unplugged has not ended, but fails in `poll`."""
        return self._closed

    def poll(self, now: float = 0.0) -> Sequence[TouchFrame]:
        """Every frame since the last call, oldest first; `now` is ignored.

        Raises:
            DeviceError: The device was unplugged; an earlier call cancelled its touches.
        """
        if self._closed:
            return []
        if self._failure is not None:
            raise self._failure
        frames: list[TouchFrame] = []
        if self._first:  # fingers that were down when the device was opened
            self._first = False
            if self._touch.contacts():
                frames.append(self._frame())
        try:
            for event in self._node.read():
                if self._touch.feed(*event):
                    frames.append(self._frame())
            if self._touch.lost:
                self._touch.resync(self._node.slots())
                frames.append(self._frame())
        except OSError as error:
            self._failure = DeviceError(
                "the touch device is gone",
                where=self._node.name,
                got=error.strerror,
                remedy="Plug it in and start again",
            )
            if self._present:
                frames.append(TouchFrame(time.monotonic(), (), None, self._present, self.name))
                self._present = frozenset()
            if not frames:
                raise self._failure from error
        return frames

    def close(self) -> None:
        """Closes the node, which other programs can use again; may be called twice."""
        if not self._closed:
            self._closed = True
            self._node.close()

    def _frame(self) -> TouchFrame:
        contacts = self._touch.contacts()
        present = frozenset(c.id for c in contacts)
        cancelled = self._touch.palms() & (self._present - present)
        self._present = present
        return TouchFrame(time.monotonic(), contacts, None, cancelled, self.name)


def evdev_surface(node: Node) -> Surface | None:
    """Surface of the size that the device's driver reports; None if it reports none."""
    width, height = node.x.length, node.y.length
    if width is None or height is None:
        return None
    return Surface(width / METRES_PER_INCH, height / METRES_PER_INCH)


class LinuxNode:
    """A node under /dev/input.

    Args:
        path: Path such as /dev/input/event5.
        grab: Keeps events from other programs while it is open, so that a trackpad does not move
            the pointer.

    Raises:
        DeviceError: It cannot be opened, or reports no contacts in slots.
    """

    def __init__(self, path: str, grab: bool = False) -> None:
        evdev = _evdev(path)
        try:
            self._device = evdev.InputDevice(path)
        except OSError as error:
            raise _not_readable(path, error) from error
        try:
            absolute = dict(self._device.capabilities(absinfo=True).get(EV_ABS, []))
            lacking = {ABS_MT_SLOT, ABS_MT_POSITION_X, ABS_MT_POSITION_Y} - set(absolute)
            if lacking:
                raise DeviceError(
                    "this device does not report touches in slots",
                    where=path,
                    got=self._device.name,
                    expected="a multitouch screen or trackpad",
                    remedy="`--device evdev` alone finds one",
                )
            self._count = min(absolute[ABS_MT_SLOT].max + 1, MAX_SLOTS)
            self.x, self.y = (
                Axis(absolute[c].min, absolute[c].max, absolute[c].resolution)
                for c in (ABS_MT_POSITION_X, ABS_MT_POSITION_Y)
            )
            major = absolute.get(ABS_MT_TOUCH_MAJOR)
            self.diameter = major and Axis(major.min, major.max, major.resolution)
            if grab:
                self._device.grab()
        except OSError as error:
            self._device.close()
            raise _not_readable(path, error) from error
        except DeviceError:
            self._device.close()
            raise
        self.name = f"{self._device.name} ({path})"

    def read(self) -> Iterable[tuple[int, int, int]]:
        """See `Node`."""
        while True:
            try:
                events = list(self._device.read())
            except BlockingIOError:
                return
            for event in events:
                yield event.type, event.code, event.value

    def slots(self) -> Slots:
        """See `Node`; asks the kernel."""
        # Only systems that have such devices have this module.
        import fcntl

        values: dict[int, dict[int, int]] = {n: {} for n in range(self._count)}
        for code in SLOT_CODES:
            buffer = array.array("i", [code, *[0] * self._count])
            try:
                fcntl.ioctl(self._device.fd, _slots_request(len(buffer) * buffer.itemsize), buffer)
            except OSError as error:
                if error.errno == errno.ENODEV:
                    raise
                continue  # this device does not have this code
            for n in range(self._count):
                values[n][code] = buffer[n + 1]
        return Slots(values, self._device.absinfo(ABS_MT_SLOT).value)

    def close(self) -> None:
        """See `Node`; also ends a grab."""
        with contextlib.suppress(OSError):
            self._device.close()


def open_node(path: str = "", grab: bool = False) -> LinuxNode:
    """Opens a node by its path; without one, the first touch screen, else the first trackpad.

    Raises:
        DeviceError: There is no readable device.
    """
    if path:
        return LinuxNode(path, grab)
    evdev = _evdev()
    nodes: list[tuple[bool, str]] = []
    for candidate in sorted(evdev.list_devices(), key=_number):
        with contextlib.suppress(OSError):
            device = evdev.InputDevice(candidate)
            codes = dict(device.capabilities(absinfo=True).get(EV_ABS, []))
            if ABS_MT_SLOT in codes and ABS_MT_POSITION_X in codes:
                nodes.append((_INPUT_PROP_DIRECT not in device.input_props(), candidate))
            device.close()
    if not nodes:
        raise DeviceError(
            "no touch screen or trackpad that this user may read",
            where="/dev/input",
            remedy="Name one, `--device evdev:/dev/input/event5`; nodes belong to the group "
            "`input`: `sudo usermod -aG input $USER`, then log in again",
        )
    return LinuxNode(min(nodes, key=lambda node: node[0])[1], grab)


def _number(path: str) -> tuple[int, str]:
    digits = "".join(c for c in os.path.basename(path) if c.isdigit())
    return int(digits or 0), path


def _slots_request(size: int) -> int:
    """Request number of the ioctl that reads one code of all slots (EVIOCGMTSLOTS)."""
    read, event, number = 2, ord("E"), 0x0A
    return read << 30 | size << 16 | event << 8 | number


def _evdev(path: str = "") -> Any:
    try:
        import evdev
    except ImportError as error:
        raise DeviceError(
            "touch screens and trackpads need the package evdev, on Linux",
            where=f"--device evdev:{path}".rstrip(":"),
            remedy='pip install "hand-sandbox[evdev]"',
        ) from error
    return evdev


def _not_readable(path: str, error: OSError) -> DeviceError:
    return DeviceError(
        "this device cannot be read",
        where=path,
        got=error.strerror,
        expected="a node under /dev/input that this user may read and no other program has grabbed",
        remedy="Nodes belong to the group `input`: `sudo usermod -aG input $USER`, then log in",
    )
