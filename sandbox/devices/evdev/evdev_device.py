"""Linux touch screens and trackpads, read from /dev/input (extra `evdev`)."""

from __future__ import annotations

import array
import contextlib
import errno
import os
import time
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, Protocol

from models.errors import DeviceError
from models.frames import TouchFrame
from models.reader_report import ReaderReport
from models.surface import METRES_PER_INCH, Surface
from sandbox.devices.device import Device
from sandbox.devices.evdev.evdev_touch import (
    ABS_MT_POSITION_X,
    ABS_MT_POSITION_Y,
    ABS_MT_SLOT,
    ABS_MT_TOUCH_MAJOR,
    EV_ABS,
    INPUT_PROP_DIRECT,
    INPUT_PROP_SEMI_MT,
    MAX_SLOTS,
    SLOT_CODES,
    TURNED,
    Axis,
    Matrix,
    MultiTouch,
    Slots,
    doubts,
    on_its_side,
    read_matrix,
    why_unusable,
)

_UDEV = Path("/run/udev/data")
_CALIBRATION = "E:LIBINPUT_CALIBRATION_MATRIX="
_INSTEAD = "Every touch screen works with `--device web`, the page in a browser on this machine"


class Node(Protocol):
    """An open device node, as `EvdevDevice` needs it.

    Attributes:
        name: Name of the device and its path.
        x: Horizontal axis of the panel.
        y: Vertical axis of the panel.
        diameter: Axis of the contacts' diameters; None if the device has none.
        matrix: Position of the panel on the surface.
        warning: Warning for the person; empty if there is none.
    """

    name: str
    x: Axis
    y: Axis
    diameter: Axis | None
    matrix: Matrix
    warning: str

    def read(self) -> Iterable[tuple[int, int, int]]:
        """Yields the events (kind, code, value) that wait; never blocks.

        Raises:
            OSError: The device is gone.
        """

    def slots(self) -> Slots:
        """Returns the current values of the slots."""

    def close(self) -> None:
        """Closes the node."""


class EvdevDevice(Device):
    """A touch screen or trackpad.

    `poll` never blocks, so the device needs no thread. If the kernel's buffer overflows after a
    long time without a poll, the slots are read again, so that no finger stays down by mistake.

    Args:
        node: Node from `open_node`.
        surface: The touch surface, which the axes span; see `evdev_surface`.
    """

    name = "evdev"

    def __init__(self, node: Node, surface: Surface) -> None:
        self._node = node
        size = float(surface.size[0]), float(surface.size[1])
        self._touch = MultiTouch(node.x, node.y, size, node.slots(), node.diameter, node.matrix)
        if node.warning:
            self._touch.report.assume(node.warning)
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
    def report(self) -> ReaderReport:
        """Report on contacts and sizes that were left out, and warnings about the device."""
        return self._touch.report

    @property
    def notices(self) -> Sequence[str]:
        """The node's warning, if it has one."""
        return (self._node.warning,) if self._node.warning else ()

    @property
    def finished(self) -> bool:
        """True once closed. An unplugged device has not finished: its `poll` raises an error."""
        return self._closed

    def poll(self, now: float = 0.0) -> Sequence[TouchFrame]:
        """Returns all frames since the last call, oldest first; `now` is ignored.

        Raises:
            DeviceError: The device was unplugged. If it had touches, an earlier call has returned
                a frame that cancels them.
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
        """Closes the node, so that other programs can use it again; may be called twice."""
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
    """Returns a surface of the size that the driver reports; None if it reports none."""
    width, height = node.x.length, node.y.length
    if width is None or height is None:
        return None
    if on_its_side(node.matrix):
        width, height = height, width
    return Surface(width / METRES_PER_INCH, height / METRES_PER_INCH)


class LinuxNode:
    """A node under /dev/input.

    Args:
        path: Path such as /dev/input/event5.
        grab: True hides the events from other programs while the node is open, so that a trackpad
            does not move the pointer.
        turned: Degrees clockwise by which the panel is rotated; None takes udev's value.

    Raises:
        DeviceError: The node cannot be opened, or its touches cannot be read.
    """

    def __init__(self, path: str, grab: bool = False, turned: int | None = None) -> None:
        evdev = _evdev(path)
        try:
            self._device = evdev.InputDevice(path)
        except OSError as error:
            raise _not_readable(path, error) from error
        try:
            axes, properties = _axes(self._device), self._device.input_props()
            if reason := why_unusable(axes):
                raise DeviceError(
                    f"touches of this device cannot be read: {reason}",
                    where=path,
                    got=self._device.name,
                    expected="a multitouch screen or trackpad with slots and tracking ids",
                    remedy=f"`--device evdev` without a node finds such a device. {_INSTEAD}",
                )
            self._count = min(axes[ABS_MT_SLOT].high + 1, MAX_SLOTS)
            self.x, self.y = axes[ABS_MT_POSITION_X], axes[ABS_MT_POSITION_Y]
            self.diameter = axes.get(ABS_MT_TOUCH_MAJOR)
            self.warning = doubts(properties)
            self.matrix = TURNED[turned or 0]
            if turned is None and INPUT_PROP_DIRECT in properties:
                self.matrix = calibration(path) or self.matrix
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
        """See `Node`; reads the values from the kernel."""
        # Only Unix has this module.
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


def open_node(path: str = "", grab: bool = False, turned: int | None = None) -> LinuxNode:
    """Opens a node.

    Args:
        path: Path of the node; empty: the first touch screen, or else the first trackpad. Devices
            that report only a box around the fingers come last.
        grab: See `LinuxNode`.
        turned: See `LinuxNode`.

    Raises:
        DeviceError: There is no readable device.
    """
    if path:
        return LinuxNode(path, grab, turned)
    evdev = _evdev()
    nodes: list[tuple[bool, bool, str]] = []
    unusable: list[str] = []
    for candidate in sorted(evdev.list_devices(), key=_number):
        with contextlib.suppress(OSError):
            device = evdev.InputDevice(candidate)
            axes, properties = _axes(device), device.input_props()
            reason = why_unusable(axes)
            if not reason:
                semi, pad = INPUT_PROP_SEMI_MT in properties, INPUT_PROP_DIRECT not in properties
                nodes.append((semi, pad, candidate))
            elif ABS_MT_POSITION_X in axes:
                unusable.append(f"{candidate} ({device.name}): {reason}")
            device.close()
    if not nodes and unusable:
        raise DeviceError(
            "no touch screen or trackpad whose touches can be read",
            where="/dev/input",
            got="; ".join(unusable),
            expected="a device with slots and tracking ids",
            remedy=_INSTEAD,
        )
    if not nodes:
        raise DeviceError(
            "no touch screen or trackpad that this user may read",
            where="/dev/input",
            remedy="Nodes belong to the group `input`: run `sudo usermod -aG input $USER`, then "
            "log in again. Or name a node: `--device evdev:/dev/input/event5`",
        )
    return LinuxNode(min(nodes, key=lambda node: node[:2])[2], grab, turned)


def calibration(path: str, folder: Path = _UDEV) -> Matrix | None:
    """Returns libinput's calibration matrix of a node; None if udev has none.

    Args:
        path: Path of the node.
        folder: Folder of udev's data.

    Raises:
        DeviceError: udev's value is not a matrix.
    """
    try:
        device = os.stat(path).st_rdev
        lines = (folder / f"c{os.major(device)}:{os.minor(device)}").read_text().splitlines()
    except (OSError, UnicodeDecodeError):
        return None
    found = (line.removeprefix(_CALIBRATION) for line in lines if line.startswith(_CALIBRATION))
    text = next(found, "")
    if not text:
        return None
    matrix = read_matrix(text)
    if matrix is None:
        raise DeviceError(
            "udev's calibration matrix of this device cannot be read",
            where=path,
            got=text[:80],
            expected="six numbers",
            remedy="--turned 0 ignores it; `udevadm info` shows it",
        )
    return matrix


def _axes(device: Any) -> dict[int, Axis]:
    """Returns the absolute axes of a device, by code."""
    return {
        code: Axis(axis.min, axis.max, axis.resolution)
        for code, axis in device.capabilities(absinfo=True).get(EV_ABS, [])
    }


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
        remedy="Nodes belong to the group `input`: run `sudo usermod -aG input $USER`, then log "
        "in again",
    )
