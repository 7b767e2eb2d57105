"""Options for hands in the air over 3-D devices, and how those devices are opened."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

from cyclopts import Parameter
from rich.console import Console
from rich.text import Text

from models.errors import InputError
from sandbox.devices.leap.options import DEFAULT_ADDRESS
from sandbox.devices.registry import built_in
from sandbox.options.headings import LEAP
from sandbox.trial.hand_input import UNDER, HandInput

if TYPE_CHECKING:
    from encoders.paalm.calibration import HandCalibration
    from sandbox.devices.leap.leap_file import LeapRecording


@dataclass(frozen=True, kw_only=True)
class LeapOptions:
    """Options for hands in the air."""

    leap: Annotated[str, Parameter(group=LEAP, metavar="URL")] = DEFAULT_ADDRESS
    """WebSocket address of leapd or of the Ultraleap bridge, for --device leap."""

    leap_at: Annotated[str, Parameter(group=LEAP, metavar="X,Y,Z", allow_leading_hyphen=True)] = (
        ",".join(f"{c:g}" for c in UNDER)
    )
    """Position of the Leap in the scene, in m from the centre of the table top: right, away, up.
    With the default, a hand 20 cm above the device is 10 cm above the table."""

    calibration: Annotated[Path | None, Parameter(group=LEAP, metavar="FILE")] = None
    """Your hand as measured by `sandbox paalm calibrate --out FILE`; --profile FILE works, too.
    Default: the open hand in a recording, the bones that the device reports, or an average hand."""


def hand_over_leap(options: LeapOptions, device: str, side: str) -> HandInput:
    """Returns position of the device and calibration of one hand.

    Raises:
        InputError: The position or the calibration is unusable.
    """
    try:
        x, y, z = map(float, options.leap_at.split(","))
    except ValueError:
        raise InputError(
            "not a position", where="--leap-at", got=options.leap_at, expected="X,Y,Z in m"
        ) from None
    from encoders.paalm.calibration_file import read_hand
    from sandbox.devices.leap.leap_file import read_leap

    calibration: HandCalibration | None = None
    from sandbox.options.leap_calibration import chosen_calibration

    file = chosen_calibration(options)
    if file is not None:
        calibration = read_hand(file, side)
    elif (entry := built_in(device)) is None:
        calibration = _recorded(read_leap(Path(device)), side, device)
    elif not entry.simulated:
        _warn(
            f"no --calibration: the {side} hand has the bones that the device reports, or those of "
            "an average hand where it reports none"
        )
    return HandInput.of((x, y, z), calibration)


def _recorded(recording: LeapRecording, side: str, name: str) -> HandCalibration:
    """Returns the calibration of the hand in a recording."""
    from encoders.paalm import Paalm
    from encoders.paalm.recorded import calibrate_on_recording
    from sandbox.devices.leap.leap_file import check_side, doubt_of_side

    check_side(recording.frames, side, name, "--hand")
    paalm = Paalm()
    why = calibrate_on_recording(paalm, recording.frames, cast(Any, side))
    for text in (doubt_of_side(recording.frames, side, "--hand"), why):
        if text:
            _warn(text)
    return paalm.calibration[side]


def _warn(text: str) -> None:
    Console(stderr=True).print(Text(text, style="yellow"))
