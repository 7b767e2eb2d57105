"""Files of touches as devices: recordings of this program, recorded frames, captures of TUIO."""

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
    """What a reader reads from a file; of an unchanged file that was read before, the same.

    A file is read when its device is checked, and opened for one or two hands at every trial.

    Args:
        read: The reader; what it returns must not be changed.
        path: The file.
        unit: Units that a person gave; with some, the reader's second argument.

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
    """Prints what a reader left out and assumed, in one line, if there is anything.

    Args:
        report: The report.
        where: The file, where several are read.
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
