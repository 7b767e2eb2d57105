"""Files of touches as devices: recordings of this program, recorded frames, captures of TUIO."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar, cast

from models.surface import Surface
from sandbox.devices.device import (
    AnyDevice,
    DeviceEntry,
    DeviceKind,
    NoOptions,
    Place,
    PlayedOptions,
    Source,
)

T = TypeVar("T")


def read_once(read: Callable[[Path], T], path: Path) -> T:
    """What a reader reads from a file; of an unchanged file that was read before, the same.

    A file is read when its device is checked, and opened for one or two hands at every trial.

    Args:
        read: The reader; what it returns must not be changed.
        path: The file.

    Raises:
        InputError: The reader refuses the file.
    """
    try:
        state = path.stat()
    except OSError:
        return read(path)
    return cast(T, _read(read, path, state.st_mtime_ns, state.st_size))


@lru_cache(maxsize=4)
def _read(read: Callable[[Path], Any], path: Path, changed: int, size: int) -> Any:
    return read(path)


def _open(options: PlayedOptions, place: Place) -> AnyDevice:
    from sandbox.devices.files.touch_files import open_file
    from sandbox.recording.recording import is_recording, load_recording

    path = Path(place.argument)
    if not is_recording(path):
        return open_file(path, place.surface).device
    from sandbox.recording.recorded_device import RecordedDevice

    recording = read_once(load_recording, path)
    return RecordedDevice(recording, place.hand if place.hand in recording.inputs else 0)


def _check(options: PlayedOptions, argument: str) -> None:
    from sandbox.devices.files.touch_files import open_file
    from sandbox.recording.recording import is_recording

    path = Path(argument)
    if not is_recording(path):
        open_file(path, None).device.close()


def _surface(argument: str) -> Surface | None:
    from sandbox.devices.files.touch_files import file_surface

    return file_surface(Path(argument))


FILE = DeviceEntry(
    "a recording of this program, recorded touches, or a capture of TUIO packets",
    _open,
    PlayedOptions,
    DeviceKind(source=Source.FILE),
    command_options=NoOptions,
    check=_check,
    surface=_surface,
)
