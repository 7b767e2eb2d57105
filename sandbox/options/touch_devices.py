"""Options for touch devices, and how devices and files of touches are opened."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Protocol

import tyro

from models.errors import DeviceError, InputError, RecordingError
from models.json_input import decoded_record
from models.surface import Surface, parse_surface
from sandbox.devices.evdev.evdev_device import EvdevDevice, evdev_surface, open_node
from sandbox.devices.files.frame_file import FramesDevice, read_frame_file
from sandbox.devices.registry import (
    DEVICES,
    OWN_DEVICE,
    built_in,
    offered_devices,
    open_by_name,
)
from sandbox.devices.tuio.touch_capture import CaptureDevice, read_capture
from sandbox.devices.tuio.tuio import DEFAULT_PORT, LOOPBACK, Tap, Transport, TuioDevice
from sandbox.devices.tuio.tuio_streams import DEFAULT_WEBSOCKET_PORT
from sandbox.options.metavars import TOUCH_DEVICE_CHOICES
from sandbox.recording import recording_file
from sandbox.session.device import Device

SERVED = ("web",)
"""Built-in devices that are opened by the page server."""

STALE_AFTER = 2.0
"""s without a packet after which the touches of a TUIO sender are lifted, unless it is chosen."""

_LONGEST_LINE = 1_000_000


@dataclass(frozen=True)
class TouchOptions:
    """Source of touches."""

    device: Annotated[str, tyro.conf.arg(metavar=TOUCH_DEVICE_CHOICES)] = "tuio"
    """Source of the touches. tuio: senders of TUIO 1.1 and 2.0. web: a page in a browser; add
    --tablet for a tablet in the network. evdev, evdev:NODE: a touch screen or trackpad of this
    Linux machine. FILE: a file by `touches record`, a recording of this program, or a capture of
    TUIO packets. Or a device of your own: FILE.py:CLASS[:ARGUMENT], or its name in an installed
    package."""

    bind: Annotated[str, tyro.conf.arg(metavar="ADDRESS")] = LOOPBACK
    """Address on which this program listens for TUIO. 127.0.0.1: reachable from this machine only;
    0.0.0.0: from the network."""

    port: int = DEFAULT_PORT
    """UDP and TCP port for TUIO; 0 takes a free one and prints it."""

    tuio_transport: Transport = "udp"
    """Transport of TUIO: udp, tcp, websocket, or all three."""

    websocket_port: int = DEFAULT_WEBSOCKET_PORT
    """TCP port for TUIO over WebSockets; 0 takes a free one."""

    tuio_connect: Annotated[str, tyro.conf.arg(metavar="URL")] = ""
    """Connect to a TUIO sender that waits for connections, such as tcp://HOST:3333 or
    ws://HOST:8080."""

    surface: Annotated[str | None, tyro.conf.arg(metavar="SIZE")] = None
    """Size of the touch area: 7.76x5.82in, 197x148mm, or a preset (ipad2, ipad-11, ipad-13,
    ipad-mini). TUIO does not transmit the size, so without this option inches are a guess. A
    browser page is measured on the page, and most touch screens report their size."""

    stale_after: float = STALE_AFTER
    """Seconds without a packet after which the touches of a TUIO sender are lifted."""

    tablet: tyro.conf.FlagCreatePairsOff[bool] = False
    """Open the page on a tablet in the same network: prints a QR code to scan."""

    lan: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None
    """Address on which the page is served, in place of the one that --tablet finds."""

    page_port: int = 0
    """TCP port of the page; 0 takes a free one."""

    grab: tyro.conf.FlagCreatePairsOff[bool] = False
    """evdev: hide the touches from the desktop, so that a trackpad does not move the pointer."""

    @property
    def is_page(self) -> bool:
        """True if the touches come from the page, whether by --device or by where it is opened."""
        return self.device == "web" or self.tablet or self.lan is not None


@dataclass(frozen=True)
class Opened:
    """An open device and its surface."""

    device: Device
    surface: Surface


class LiveOptions(Protocol):
    """What a live device needs to know; for each see `TouchOptions`."""

    @property
    def device(self) -> str: ...

    @property
    def bind(self) -> str: ...

    @property
    def port(self) -> int: ...

    @property
    def tuio_transport(self) -> Transport: ...

    @property
    def websocket_port(self) -> int: ...

    @property
    def tuio_connect(self) -> str: ...

    @property
    def grab(self) -> bool: ...


def live_maker(
    options: LiveOptions, tap: Tap | None = None, stale_after: float = STALE_AFTER
) -> Callable[[Surface], Device] | None:
    """Returns a function that opens the live device of options; None if they name no live device.

    Args:
        options: Which device, and how it is reached.
        tap: Called with every TUIO packet.
        stale_after: s without a packet after which the touches of a TUIO sender are lifted.
    """
    name = options.device
    if name == "tuio":
        return lambda surface: TuioDevice(
            surface,
            bind=options.bind,
            port=options.port,
            transport=options.tuio_transport,
            websocket_port=options.websocket_port,
            connect=options.tuio_connect,
            stale_after=stale_after,
            tap=tap,
        )
    if is_evdev(name):
        return lambda surface: EvdevDevice(open_node(_node(name), options.grab), surface)
    entry = built_in(name)
    if Path(name).exists() or (entry and (entry.in_scene or name in SERVED)):
        return None
    return open_by_name(name)


def touch_devices() -> list[str]:
    """Returns the names of built-in devices that `sandbox touches` takes."""
    return [name for name, entry in DEVICES.items() if not entry.in_scene]


def has_unknown_size(name: str) -> bool:
    """True if a device does not report the size of its surface."""
    entry = built_in(name)
    return entry is not None and entry.guessed_size


def is_evdev(name: str) -> bool:
    """True if a device is a touch screen or trackpad of this machine."""
    return name == "evdev" or name.startswith("evdev:")


def native_surface(name: str) -> Surface | None:
    """Returns the surface of a device or a file of touches; None if it has none of its own.

    Files of touches that do not say a size get one that is marked as a guess. A recording of this
    program has its surface in its settings.
    """
    path = Path(name)
    if path.is_file():
        head = first_line(path)
        if "surface_in" in head:
            return read_frame_file(path).surface
        return guessed_surface() if {"contacts", "hex", "closed"} & set(head) else None
    if not is_evdev(name):
        return None
    node = open_node(_node(name))
    try:
        return evdev_surface(node)
    finally:
        node.close()


def open_touches(options: TouchOptions, tap: Tap | None = None) -> Opened:
    """Opens a live device or a file, but not the page.

    Raises:
        InputError: The device or file is missing or cannot be opened.
    """
    given = parse_surface(options.surface) if options.surface else None
    maker = live_maker(options, tap, options.stale_after)
    if maker is not None:
        size = given or native_surface(options.device) or guessed_surface()
        return Opened(maker(size), size)
    return open_file(Path(options.device), given, options.stale_after)


def open_file(path: Path, surface: Surface | None, stale_after: float = STALE_AFTER) -> Opened:
    """Opens a file as a device; its content decides the format.

    Args:
        path: A capture of TUIO packets, recorded frames, or a recording of this program.
        surface: Touch surface; None: that of the file, or a guess.
        stale_after: For captures of TUIO packets: s without a packet until touches are lifted.

    Raises:
        InputError: The file is missing or has none of these formats.
    """
    if not path.exists():
        raise InputError(
            "no such device or file",
            where="--device",
            got=str(path),
            expected=", ".join([*touch_devices(), *offered_devices(), OWN_DEVICE, "or a file"]),
            remedy="`sandbox touches formats` lists the files that play as devices",
        )
    if path.suffix == ".py":
        raise DeviceError(
            "the name of the device class is missing",
            where="--device",
            got=str(path),
            expected=f"such as {path}:CLASS",
        )
    head = first_line(path) if path.is_file() else {}
    if "contacts" in head or "surface_in" in head:
        file = read_frame_file(path)
        size = surface or file.surface or guessed_surface()
        return Opened(FramesDevice(file.frames, file.damage), size)
    if head and not {"hex", "closed"} & set(head):
        recorded = _recording(path, surface)
        if recorded is not None:
            return recorded
    size = surface or guessed_surface()
    return Opened(CaptureDevice(read_capture(path), size, stale_after=stale_after), size)


def _recording(path: Path, surface: Surface | None) -> Opened | None:
    """Opens the touches of a recording; returns None if the file is not a recording."""
    # This import loads scenes, which is slow; other touches do not need it.
    from sandbox.recording.recording import is_recording, load_recording

    if not is_recording(path):
        return None
    recording = load_recording(path)
    frames = recording.touches()
    damage = RecordingError(recording.damage, where=str(path)) if recording.damage else None
    size = surface or recorded_surface(recording.header["settings"]) or guessed_surface()
    return Opened(FramesDevice(frames, damage), size)


def recorded_surface(settings: Mapping[str, Any]) -> Surface | None:
    """The surface in a recording's settings, of any version; None if they name none."""
    size_in = settings.get("surface_in")
    if not size_in:
        return None
    calibrated = bool(settings.get("surface_calibrated", True))
    return Surface(float(size_in[0]), float(size_in[1]), calibrated=calibrated)


def first_line(path: Path) -> dict[str, object]:
    """Returns the first line of a JSON lines file, plain or compressed; empty if it is not JSON.

    Raises:
        RecordingError: The file cannot be read.
    """
    try:
        line = recording_file.first_line(path, _LONGEST_LINE)
    except OSError as error:
        raise RecordingError("cannot be read", where=str(path), got=error.strerror) from None
    try:
        return decoded_record(line, RecordingError, what="not JSON lines", where=str(path))
    except RecordingError:
        return {}


def guessed_surface() -> Surface:
    """Returns the surface that is assumed when its size is not known."""
    return replace(parse_surface("ipad2"), calibrated=False)


def _node(name: str) -> str:
    return name.partition(":")[2]
