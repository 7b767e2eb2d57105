"""Calibration of the hand over a Leap: a saved one, or a guided measurement."""

from __future__ import annotations

import sys
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, cast

from rich.console import Console
from rich.text import Text

from models.errors import EncoderError, InputError
from sandbox.devices.registry import LIVE_LEAP as LIVE
from sandbox.options.profiles import DEFAULT, default_path

if TYPE_CHECKING:
    from encoders.paalm.calibration import HandCalibration
    from sandbox.devices.leap.leap import LeapDevice

FRAMES_PER_WANTED = 3
"""Frames read at most per frame wanted, since many may not show an open hand."""


def own_calibration_path() -> Path:
    """Returns the file of this user's hands over a Leap, beside the profile of touches."""
    return default_path().with_name("hands.json")


def chosen_calibration(options: Any) -> Path | None:
    """Returns the calibration file named by --calibration or --profile; None if there is none.

    Args:
        options: `SceneOptions`, or those of a command with the same names.

    Raises:
        InputError: The options name two files.
    """
    named: str | None = options.profile
    path: Path | None = None
    if named == DEFAULT:
        path = own_calibration_path() if own_calibration_path().exists() else None
    elif named not in (None, "none") and _is_calibration(str(named)):
        path = Path(str(named))
        if options.calibration is not None:
            raise InputError(
                "two calibrations are given",
                where="--profile",
                got=f"--calibration and --profile {named}",
                expected="one of --calibration and --profile",
            )
    return options.calibration or path


def _is_calibration(name: str) -> bool:
    """True if a profile's name is the file of a calibration over a Leap."""
    from encoders.paalm.calibration_file import is_calibration

    return is_calibration(Path(name))


def uses_touch_profile(options: Any, in_air: bool) -> bool:
    """True if --profile names a profile by `sandbox hand measure`, and the device is for touches.

    Raises:
        InputError: The profile is a calibration over a Leap, and the device is for touches.
    """
    if options.profile in (None, "none"):
        return False
    if options.profile == DEFAULT:
        # Over a Leap the measured hand counts; the seat at a tablet has no meaning there.
        return not in_air or (not own_calibration_path().exists() and default_path().exists())
    if not _is_calibration(options.profile):
        return True
    if not in_air:
        raise InputError(
            "this profile is a calibration over a Leap",
            where=f"--profile {options.profile}",
            got=f"--device {options.device}",
            expected="--device leap",
            remedy="`sandbox hand measure` measures a hand that touches",
        )
    return False


def with_measured_hand(options: Any, console: Console, ask: bool | None = None) -> Any:
    """Returns options with the calibration of the player's hand over a Leap.

    A saved calibration is used. Otherwise the player is asked to hold the hand open. Ctrl-C skips
    this, and an average hand is assumed.

    Args:
        options: Options of `sandbox play`.
        console: Console for instructions.
        ask: True if a person can be asked; None: if this is a terminal.
    """
    if (
        options.device != LIVE
        or options.profile == "none"
        or chosen_calibration(options) is not None
    ):
        return options
    from encoders.paalm.calibration_file import read_calibration

    side = options.hand or "right"
    path = own_calibration_path()
    if path.exists() and side in read_calibration(path):
        console.print(f"calibration of your {side} hand: {path}", soft_wrap=True)
        return replace(options, calibration=path)
    if ask is None:
        ask = sys.stdin.isatty() and console.is_terminal
    if ask and measure_and_save(options.leap, side, path, console):
        return replace(options, calibration=path)
    return options


def measure_and_save(
    address: str, side: str, path: Path, console: Console, wanted: int | None = None
) -> bool:
    """Measures a hand over the service and saves it; returns False if the person skips this.

    Args:
        address: WebSocket address of the service.
        side: `right` or `left`.
        path: File of calibrations; that of the other hand in it is kept.
        console: Console for instructions and progress.
        wanted: Number of frames with five fingers; None takes the paper's 1000, about ten seconds.

    Raises:
        DeviceError: The service sends nothing.
    """
    from encoders.paalm.calibration import PAPER_FRAMES
    from encoders.paalm.calibration_file import read_calibration
    from sandbox.devices.leap.leap import LeapDevice

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
            "the folder cannot be made", where=str(path.parent), got=error.strerror
        ) from None
    write_calibration(hands, path)
