"""Opens devices and files of touches."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from models.errors import DeviceError, RecordingError, unknown_name
from models.json_input import decoded_record
from models.surface import Surface, parse_surface
from sandbox.devices.device import Device
from sandbox.devices.device_settings import DeviceSettings
from sandbox.devices.evdev.evdev_device import EvdevDevice, evdev_surface, open_node
from sandbox.devices.files.frame_file import FramesDevice, read_frame_file
from sandbox.devices.registry import DEVICES, OWN_DEVICE, built_in, offered_devices, open_by_name
from sandbox.devices.tuio.options import STALE_AFTER
from sandbox.devices.tuio.touch_capture import CaptureDevice, read_capture
from sandbox.devices.tuio.tuio import Tap, TuioDevice
from sandbox.recording import recording as recording_file

SERVED = ("web",)
"""Built-in devices that are opened by the page server."""

_LONGEST_LINE = 1_000_000


@dataclass(frozen=True)
class Opened:
    """An open device and its surface."""

    device: Device
    surface: Surface


def live_maker(
    device: DeviceSettings, tap: Tap | None = None, stale_after: float = STALE_AFTER
) -> Callable[[Surface], Device] | None:
    """Returns a function that opens a live device of touches; None if it is not one.

    Args:
        device: The device and its options.
        tap: Called with every TUIO packet.
        stale_after: s without a packet after which the touches of a TUIO sender are lifted.
    """
    name, options = device.name, device.options
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
        raise unknown_name(
            "no such device or file",
            str(path),
            [*touch_devices(), *offered_devices()],
            where="--device",
            others=f"{OWN_DEVICE}, or a file",
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
    surface = settings.get("surface")
    if not isinstance(surface, Mapping):
        # In headers without groups the names are longer.
        names = {"size_in": "surface_in", "calibrated": "surface_calibrated"}
        surface = {name: settings[old] for name, old in names.items() if old in settings}
    size_in = surface.get("size_in")
    if not size_in:
        return None
    calibrated = bool(surface.get("calibrated", True))
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
