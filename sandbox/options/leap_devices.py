"""Options for hands in the air over 3-D devices, and how those devices are opened."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, cast

from cyclopts import Parameter
from rich.console import Console
from rich.text import Text

from models.errors import InputError
from sandbox.devices.kinds import is_leap
from sandbox.devices.leap.options import DEFAULT_ADDRESS
from sandbox.devices.registry import built_in
from sandbox.options.headings import LEAP
from sandbox.recording.recording import Recording
from sandbox.trial.hand_input import UNDER, HandInput
from sandbox.trial.recorded_settings import recorded_settings
from sandbox.trial.settings import Settings

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


def both_over_one_device(options: Any) -> bool:
    """True if two hands, should there be two, are over the same 3-D device."""
    return is_leap(options.device) and options.second_device in (None, options.device)


def with_leap_hands(
    settings: Settings, options: Any, second_recording: Recording | None
) -> Settings:
    """Returns settings with position and calibration of the hands over 3-D devices.

    Args:
        settings: Settings with all hands.
        options: `LeapOptions` with `device` and `second_device`.
        second_recording: Recording that the second hand's device plays; None otherwise.

    Raises:
        InputError: A position or calibration is unusable, or both hands are of one side.
    """
    first, *others = settings.hands
    if is_leap(options.device):
        if settings.variation.degrades_touches:
            raise InputError("touches can be degraded, hands in the air cannot", where="--vary")
        first = replace(first, in_air=hand_input(options, options.device, first.side))
        settings = replace(settings, hands=(first, *others))
    if not others:
        return settings
    second = others[0]
    other = options.second_device or options.device
    if second_recording is not None:
        played = recorded_settings(second_recording.header, "hands")
        in_air = played.hands[1 if 1 in second_recording.inputs else 0].in_air
    elif is_leap(other):
        in_air = hand_input(options, other, second.side)
    else:
        return settings
    if both_over_one_device(options) and first.side == second.side:
        raise InputError(
            "two hands over one Leap must be a right and a left hand",
            where="--hand",
            got=f"two {second.side} hands",
        )
    shared = settings.surface.shared and in_air is None
    return settings.changed(hands=(first, replace(second, in_air=in_air)), shared=shared)


def hand_input(options: LeapOptions, device: str, side: str) -> HandInput:
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
    from sandbox.options.leap_calibration import chosen_calibration

    calibration: HandCalibration | None = None
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
