"""Files of touches as devices: recordings of this program, recorded frames, TUIO captures."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar, cast

from models.reader_report import ReaderReport
from models.surface import Surface
from sandbox.devices.device import (
    AnyDevice,
    DeviceEntry,
    DeviceKind,
    Place,
    PlayedOptions,
    Source,
    UnitOptions,
)

T = TypeVar("T")


def read_once(read: Callable[..., T], path: Path, unit: str = "") -> T:
    """Reads a file with a reader; returns the same object again while the file is unchanged.

    The cache is useful because the file of a device is needed when the device is checked, and for
    each hand at every trial.

    Args:
        read: The reader. Its result must not be modified.
        path: The file.
        unit: Units that a person gave. If not empty, it is the reader's second argument.

    Raises:
        InputError: The reader refuses the file.
    """
    try:
        state = path.stat()
    except OSError:
        return read(path, *filter(None, [unit]))
    return cast(T, _read(read, path, unit, state.st_mtime_ns, state.st_size))


@lru_cache(maxsize=4)
def _read(read: Callable[..., Any], path: Path, unit: str, changed: int, size: int) -> Any:
    return read(path, *filter(None, [unit]))


def show_report(report: ReaderReport, where: str = "") -> None:
    """Prints a reader's report in one line, unless it is empty.

    Args:
        report: Left-out data and assumptions.
        where: Name of the file, if several files are read.
    """
    if report:
        from rich.console import Console
        from rich.text import Text

        text = f"{where}: {report.line()}" if where else report.line()
        Console(stderr=True).print(Text(text, style="yellow"))


def _open(options: PlayedOptions, place: Place) -> AnyDevice:
    from sandbox.devices.files.touch_files import open_file
    from sandbox.recording.recording import is_recording, load_recording

    path = Path(place.argument)
    if not is_recording(path):
        device = open_file(path, place.surface, unit=options.unit).device
        if device.report is not None:
            show_report(device.report)
        return device
    from sandbox.recording.recorded_device import RecordedDevice

    recording = read_once(load_recording, path)
    return RecordedDevice(recording, place.hand if place.hand in recording.inputs else 0)


def _check(options: PlayedOptions, argument: str) -> None:
    from sandbox.devices.files.touch_files import open_file
    from sandbox.recording.recording import is_recording

    path = Path(argument)
    if not is_recording(path):
        open_file(path, None, unit=options.unit).device.close()


def _surface(options: UnitOptions, argument: str) -> Surface | None:
    from sandbox.devices.files.touch_files import file_surface

    return file_surface(Path(argument))


FILE = DeviceEntry(
    "a recording of this program, recorded touches, or a capture of TUIO packets",
    _open,
    PlayedOptions,
    DeviceKind(source=Source.FILE),
    command_options=UnitOptions,
    check=_check,
    surface=_surface,
)
