"""Whose hand is over the Leap: calibrations that were kept, and a guided one where none was."""

from __future__ import annotations

import sys
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any, Literal, cast

from rich.console import Console
from rich.progress import Progress
from rich.text import Text

from encoders.paalm import Paalm
from encoders.paalm.calibration import PAPER_FRAMES, HandCalibration
from encoders.paalm.calibration_file import is_calibration, read_calibration, write_calibration
from models.errors import EncoderError, InputError
from sandbox.devices.leap.leap import LeapDevice
from sandbox.options.profiles import DEFAULT, default_path

LIVE = "leap"
TRIES = 3
"""Frames that are looked at for every one that is wanted: most may show no open hand."""


def own_path() -> Path:
    """Where this user's own measured hands are, beside the profile of `sandbox calibrate`."""
    return default_path().with_name("hands.json")


def chosen_file(options: Any) -> Path | None:
    """The calibration that options name, with --calibration or with --profile; None for none.

    Args:
        options: `LeapOptions`, with or without `profile`.

    Raises:
        InputError: They name two.
    """
    named: str | None = getattr(options, "profile", None)
    path: Path | None = None
    if named == DEFAULT:
        path = own_path() if own_path().exists() else None
    elif named not in (None, "none") and is_calibration(Path(str(named))):
        path = Path(str(named))
        if options.calibration is not None:
            raise InputError(
                "a hand is measured once",
                where="--profile",
                got=f"{named}, a calibration, too",
                expected="one of --calibration and --profile",
            )
    return options.calibration or path


def of_touches(options: Any, in_air: bool) -> bool:
    """Whether --profile names a person, as `sandbox calibrate` finds one, and they are meant.

    Raises:
        InputError: It names a hand over a Leap, and fingers touch.
    """
    if options.profile in (None, "none"):
        return False
    if options.profile == DEFAULT:
        # Over a Leap, the own hand's measures; where somebody sits at a tablet says nothing there.
        return not in_air or (not own_path().exists() and default_path().exists())
    if not is_calibration(Path(options.profile)):
        return True
    if not in_air:
        raise InputError(
            "this is a hand over a Leap",
            where=f"--profile {options.profile}",
            got=f"--device {options.device}",
            expected="--device leap",
            remedy="`sandbox calibrate` measures a hand that touches",
        )
    return False


def with_own_hand(options: Any, console: Console, ask: bool | None = None) -> Any:
    """The options of somebody who plays over a Leap, with their hand measured.

    A hand that was kept is taken. Otherwise they are asked to hold it open; Ctrl-C leaves that, and
    the hand is then an average one.

    Args:
        options: Of `sandbox play`.
        console: Where they are told what to do.
        ask: Whether somebody is there to do it; None looks whether this is a terminal.
    """
    if options.device != LIVE or options.profile == "none" or chosen_file(options) is not None:
        return options
    side = options.hand or "right"
    path = own_path()
    if path.exists() and side in read_calibration(path):
        console.print(f"your {side} hand as it was measured: {path}", soft_wrap=True)
        return replace(options, calibration=path)
    if ask is None:
        ask = sys.stdin.isatty() and console.is_terminal
    if ask and measured(options.leap, side, path, console):
        return replace(options, calibration=path)
    return options


def measured(
    address: str, side: str, path: Path, console: Console, wanted: int = PAPER_FRAMES
) -> bool:
    """Measures a hand over the service and keeps it; False where the person left it.

    Args:
        address: Of the service.
        side: Whose hand.
        path: Where it is kept, beside the other one.
        console: Shows what to do, and how far it is.
        wanted: Frames with five fingers; 1000 in the paper, about ten seconds.

    Raises:
        DeviceError: The service says nothing.
    """
    console.print(
        f"Hold your {side} hand 20 cm above the Leap, palm down, fingers spread, and still for ten "
        "seconds. Ctrl-C leaves this out: your hand is then taken for an average one.",
        soft_wrap=True,
    )
    device = LeapDevice(address)
    try:
        while True:
            try:
                found = _measure(device, cast(Literal["right", "left"], side), wanted, console)
                break
            except EncoderError as error:
                console.print(Text(f"once more: {error}", style="yellow"), soft_wrap=True)
    except KeyboardInterrupt:
        console.print("left out")
        return False
    finally:
        device.close()
    known = read_calibration(path) if path.exists() else {}
    keep_hands({**known, **found}, path)
    console.print(f"measured, and kept in {path}", soft_wrap=True)
    return True


def _measure(
    device: LeapDevice, side: Literal["right", "left"], wanted: int, console: Console
) -> dict[str, HandCalibration]:
    with Progress(console=console, transient=True) as bar:
        job = bar.add_task("open and still", total=1.0)
        return Paalm().calibrate(
            islice(device.follow(), TRIES * wanted),
            side,
            wanted,
            lambda share: bar.update(job, completed=share),
        )


def keep_hands(hands: dict[str, Any], path: Path) -> None:
    """Writes calibrations, in a folder that need not be there yet.

    Raises:
        InputError: The folder cannot be made.
        EncoderError: The file cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(
            "the folder cannot be made", where=str(path.parent), got=error.strerror
        ) from None
    write_calibration(hands, path)
