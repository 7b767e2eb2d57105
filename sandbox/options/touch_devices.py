"""Opens what touches come from: a live device, one of somebody else's, or a file."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any

import tyro

from models.errors import DeviceError, InputError, RecordingError
from models.json_input import decoded_record
from models.surface import Surface, parse_surface
from sandbox.devices.discovery import offered_devices
from sandbox.devices.evdev.evdev_device import EvdevDevice, evdev_surface, open_node
from sandbox.devices.files.frame_file import FramesDevice, read_frame_file
from sandbox.devices.registry import DEVICES, built_in, open_by_name
from sandbox.devices.tuio.touch_capture import CaptureDevice, read_capture
from sandbox.devices.tuio.tuio import DEFAULT_PORT, LOOPBACK, Tap, Transport, TuioDevice
from sandbox.devices.tuio.tuio_streams import DEFAULT_WEBSOCKET_PORT
from sandbox.session.device import Device

SERVED = ("web",)
"""Built-in devices that a server opens, with a page."""

_LONGEST_LINE = 1_000_000


@dataclass(frozen=True)
class TouchOptions:
    """Where touches come from."""

    device: Annotated[str, tyro.conf.arg(metavar="{tuio,web,evdev,FILE,...}")] = "tuio"
    """tuio: senders of TUIO 1.1 and 2.0. web: a page in a browser, --tablet for one in the network.
    evdev, evdev:NODE: a touch screen or trackpad of this Linux machine. A file: what `touches
    record` wrote, a recording of `sandbox`, a capture of packets. Or a device of your own:
    FILE.py:CLASS[:ARGUMENT], or the name under which a package offers it."""

    bind: Annotated[str, tyro.conf.arg(metavar="ADDRESS")] = LOOPBACK
    """Which of this machine's addresses TUIO is listened for on. 127.0.0.1 is reached from this
    machine only, 0.0.0.0 from the whole network."""

    port: int = DEFAULT_PORT
    """UDP and TCP port for TUIO; 0 takes a free one and tells which."""

    tuio_transport: Transport = "udp"
    """How TUIO comes: udp, tcp, websocket, or all three."""

    websocket_port: int = DEFAULT_WEBSOCKET_PORT
    """TCP port for TUIO over WebSockets; 0 takes a free one."""

    tuio_connect: Annotated[str, tyro.conf.arg(metavar="URL")] = ""
    """Calls a TUIO sender that waits for it, such as tcp://HOST:3333 or ws://HOST:8080."""

    surface: Annotated[str | None, tyro.conf.arg(metavar="SIZE")] = None
    """Size of the touch area: 7.76x5.82in, 197x148mm, or a preset (ipad2, ipad-11, ipad-13,
    ipad-mini). TUIO carries no sizes, so without this inches are a guess; the page is measured on
    the page, and most touch screens know their own."""

    stale_after: float = 2.0
    """Lift the touches of a TUIO sender after this many seconds without a packet."""

    tablet: tyro.conf.FlagCreatePairsOff[bool] = False
    """The page on a tablet in the same network: prints a code to be photographed."""

    lan: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None
    """Serves the page on this address instead."""

    page_port: int = 0
    """TCP port of the page; 0 takes a free one."""

    grab: tyro.conf.FlagCreatePairsOff[bool] = False
    """evdev: keep the touches from the desktop, so that a trackpad's pointer stays where it is."""


@dataclass(frozen=True)
class Opened:
    """A device and how large its surface is."""

    device: Device
    surface: Surface


def live_maker(options: Any, tap: Tap | None = None) -> Callable[[Surface], Device] | None:
    """What opens a live device of these options, given its surface; None: they name none.

    Args:
        options: `TouchOptions`, or others with the same names.
        tap: Is told of every TUIO packet.
    """
    name: str = options.device
    if name == "tuio":
        return lambda surface: TuioDevice(
            surface,
            bind=options.bind,
            port=options.port,
            transport=options.tuio_transport,
            websocket_port=options.websocket_port,
            connect=options.tuio_connect,
            stale_after=getattr(options, "stale_after", 2.0),
            tap=tap,
        )
    if is_evdev(name):
        return lambda surface: EvdevDevice(open_node(_node(name), options.grab), surface)
    entry = built_in(name)
    if Path(name).exists() or (entry and (entry.in_scene or name in SERVED)):
        return None
    return open_by_name(name)


def touch_devices() -> list[str]:
    """Built-in devices that `sandbox touches` takes."""
    return [name for name, entry in DEVICES.items() if not entry.in_scene]


def guesses_size(name: str) -> bool:
    """Whether a device does not tell how large its surface is."""
    entry = built_in(name)
    return entry is not None and entry.guessed_size


def is_evdev(name: str) -> bool:
    """Whether a device's name means a touch screen or trackpad of this machine."""
    return name == "evdev" or name.startswith("evdev:")


def native_surface(name: str) -> Surface | None:
    """The size that a device, or a file of recorded frames, knows; None where it does not."""
    path = Path(name)
    if path.is_file():
        return read_frame_file(path).surface if "surface_in" in first_line(path) else None
    if not is_evdev(name):
        return None
    node = open_node(_node(name))
    try:
        return evdev_surface(node)
    finally:
        node.close()


def open_touches(options: TouchOptions, tap: Tap | None = None) -> Opened:
    """Opens a live device or a file; not the page.

    Raises:
        InputError: There is no such device or file, or it cannot be opened.
    """
    given = parse_surface(options.surface) if options.surface else None
    maker = live_maker(options, tap)
    if maker is not None:
        size = given or native_surface(options.device) or guessed_surface()
        return Opened(maker(size), size)
    return open_file(Path(options.device), given, options.stale_after)


def open_file(path: Path, surface: Surface | None, stale_after: float = 2.0) -> Opened:
    """A file as a device; what it is is told by its content.

    Args:
        path: A capture of packets, recorded frames, or a recording of ours.
        surface: Its size; None: as the file says, or a guess.
        stale_after: For captures of TUIO packets, s.

    Raises:
        InputError: There is no such file, or it is none of these.
    """
    if not path.exists():
        raise InputError(
            "there is no such device or file",
            where="--device",
            got=str(path),
            expected=", ".join([*touch_devices(), *offered_devices(), "or a file"]),
            remedy="`sandbox touches formats` lists the files that play as devices",
        )
    if path.suffix == ".py":
        raise DeviceError(
            "the class of this device is missing",
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
    """The touches of a recording of ours; None: it is none."""
    # It knows scenes, which take long to load; other touches need none.
    from sandbox.recording.recording import is_recording, load_recording

    if not is_recording(path):
        return None
    recording = load_recording(path)
    told = recording.header["settings"].get("surface_in")
    frames = recording.touches()
    damage = RecordingError(recording.damage, where=str(path)) if recording.damage else None
    size = Surface(float(told[0]), float(told[1])) if told else guessed_surface()
    return Opened(FramesDevice(frames, damage), surface or size)


def first_line(path: Path) -> dict[str, object]:
    """The first line of a JSON lines file; empty where it is none.

    Raises:
        RecordingError: The file cannot be read.
    """
    try:
        with path.open("rb") as file:
            line = file.readline(_LONGEST_LINE)
    except OSError as error:
        raise RecordingError("cannot be read", where=str(path), got=error.strerror) from None
    try:
        return decoded_record(line, RecordingError, what="no JSON lines", where=str(path))
    except RecordingError:
        return {}


def guessed_surface() -> Surface:
    """The size that is assumed where nobody knows it."""
    return replace(parse_surface("ipad2"), calibrated=False)


def _node(name: str) -> str:
    return name.partition(":")[2]
