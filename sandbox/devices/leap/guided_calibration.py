"""A guided measurement of a person's hand over a Leap, and writing of calibration files."""

from __future__ import annotations

from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

from rich.console import Console
from rich.text import Text

from models.errors import EncoderError, InputError
from sandbox.devices.leap.leap import LeapDevice

if TYPE_CHECKING:
    from encoders.paalm.calibration import HandCalibration

FRAMES_PER_WANTED = 3
"""Largest number of frames read per required frame, since not every frame shows an open hand."""


def measure_and_save(
    address: str, side: str, path: Path, console: Console, wanted: int | None = None
) -> bool:
    """Measures a hand over a live Leap and saves its calibration; False if the person skips it.

    Args:
        address: WebSocket address of the service.
        side: `right` or `left`.
        path: File of calibrations. A calibration of the other hand in it stays.
        console: Console for instructions and progress.
        wanted: Number of frames with five fingers; None: the paper's 1000, about ten seconds.

    Raises:
        DeviceError: The service sends nothing.
    """
    from encoders.paalm.calibration import PAPER_FRAMES
    from encoders.paalm.calibration_file import read_calibration

    wanted = PAPER_FRAMES if wanted is None else wanted
    console.print(
        f"Hold your {side} hand 20 cm above the Leap, palm down, fingers spread, and still for ten "
        "seconds. Ctrl-C skips this: an average hand is then assumed.",
        soft_wrap=True,
    )
    device = LeapDevice(address)
    try:
        while True:
            try:
                measured = _measure(device, cast(Literal["right", "left"], side), wanted, console)
                break
            except EncoderError as error:
                console.print(Text(f"please try again: {error}", style="yellow"), soft_wrap=True)
    except KeyboardInterrupt:
        console.print("skipped")
        return False
    finally:
        device.close()
    known = read_calibration(path) if path.exists() else {}
    save_calibrations({**known, **measured}, path)
    console.print(f"measured, and saved in {path}", soft_wrap=True)
    return True


def _measure(
    device: LeapDevice, side: Literal["right", "left"], wanted: int, console: Console
) -> dict[str, HandCalibration]:
    # This import is slow, and few runs measure a hand.
    from rich.progress import Progress

    from encoders.paalm import Paalm

    with Progress(console=console, transient=True) as bar:
        job = bar.add_task("open and still", total=1.0)
        return Paalm().calibrate(
            islice(device.follow(), FRAMES_PER_WANTED * wanted),
            side,
            wanted,
            lambda share: bar.update(job, completed=share),
        )


def save_calibrations(hands: dict[str, Any], path: Path) -> None:
    """Writes calibrations; creates the folder if it is missing.

    Raises:
        InputError: The folder cannot be made.
        EncoderError: The file cannot be written.
    """
    from encoders.paalm.calibration_file import write_calibration

    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            "the folder cannot be created", where=str(path.parent), got=error.strerror
        ) from None
    write_calibration(hands, path)
