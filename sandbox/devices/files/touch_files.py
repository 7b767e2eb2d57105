"""Opens files of touches; their content decides the format."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from models.errors import DeviceError, RecordingError
from models.json_input import loosely_decoded
from models.surface import Surface, parse_surface
from sandbox.devices.device import Device
from sandbox.devices.files import read_once
from sandbox.devices.files.frame_file import FramesDevice, read_frame_file, touch_surface
from sandbox.devices.registry import unknown_device
from sandbox.devices.tuio import STALE_AFTER
from sandbox.devices.tuio.touch_capture import CaptureDevice, read_capture
from sandbox.recording import recording as recording_file

_LONGEST_LINE = 1_000_000


@dataclass(frozen=True)
class Opened:
    """An open device and its surface."""

    device: Device
    surface: Surface


def file_surface(path: Path) -> Surface | None:
    """Returns the surface of a file of touches; None for other files.

    If the file does not state the size, the surface is marked as a guess. For a recording of this
    program, None is returned: its settings have the surface.
    """
    if not path.is_file():
        return None
    head = first_line(path)
    if "surface_in" in head:
        return touch_surface(path)
    return guessed_surface() if {"contacts", "hex", "closed"} & set(head) else None


def open_file(
    path: Path, surface: Surface | None, stale_after: float = STALE_AFTER, unit: str = ""
) -> Opened:
    """Opens a file as a device; its content decides the format.

    Args:
        path: A capture of TUIO packets, recorded frames, or a recording of this program.
        surface: Touch surface; None: that of the file, or a guess.
        stale_after: For captures of TUIO packets: time (s) without a packet after which touches are
            lifted.
        unit: Units of times and lengths that a person gave, such as `mm,ms`; missing ones are
            found.

    Raises:
        InputError: The file is missing or has none of these formats, or its times or positions are
            impossible.
    """
    if not path.exists():
        raise unknown_device(str(path))
    if path.suffix == ".py":
        raise DeviceError(
            "the name of the device class is missing",
            where="--device",
            got=str(path),
            expected=f"{path}:CLASS",
        )
    head = first_line(path) if path.is_file() else {}
    if "contacts" in head or "surface_in" in head:
        file = read_once(read_frame_file, path, unit)
        size = surface or file.surface or guessed_surface()
        return Opened(FramesDevice(file.frames, file.damage, file.report.copy()), size)
    if head and not {"hex", "closed"} & set(head):
        recorded = _recording(path, surface)
        if recorded is not None:
            return recorded
    size = surface or guessed_surface()
    capture = read_once(read_capture, path, unit)
    return Opened(CaptureDevice(capture, size, stale_after=stale_after), size)


def _recording(path: Path, surface: Surface | None) -> Opened | None:
    """Opens the touches of a recording; returns None if the file is not a recording."""
    # This import loads scenes, which is slow; other touches do not need it.
    from sandbox.recording.recording import is_recording, load_recording

    if not is_recording(path):
        return None
    recording = read_once(load_recording, path)
    frames = recording.touches()
    damage = RecordingError(recording.damage, where=str(path)) if recording.damage else None
    size = surface or recorded_surface(recording.header["settings"]) or guessed_surface()
    return Opened(FramesDevice(frames, damage), size)


def recorded_surface(settings: Mapping[str, Any]) -> Surface | None:
    """Returns the surface in a recording's settings, of any version; None if they have none."""
    surface = settings.get("surface")
    if not isinstance(surface, Mapping):
        # Settings of earlier versions have no groups, and longer names.
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
        raise RecordingError(
            "the file cannot be read", where=str(path), got=error.strerror
        ) from None
    head = loosely_decoded(line)
    return head if isinstance(head, dict) else {}


def guessed_surface() -> Surface:
    """Returns the surface that is assumed when its size is unknown."""
    return replace(parse_surface("ipad2"), calibrated=False)
