"""A Leap: hands in the air, from its service, a simulated user or a recording."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from models.errors import InputError
from sandbox.devices.device import (
    AnyDevice,
    DeviceEntry,
    DeviceKind,
    Place,
    PlayedOptions,
    Sees,
    Source,
    UnitOptions,
)
from sandbox.devices.hand_input import UNDER, HandInput
from sandbox.devices.simulated import InAirOptions

if TYPE_CHECKING:
    from encoders.paalm.calibration import HandCalibration
    from sandbox.devices.leap.leap_file import LeapRecording

DEFAULT_ADDRESS = "ws://127.0.0.1:6437/v6.json"
"""WebSocket address of a service on this machine."""


@dataclass(frozen=True, kw_only=True)
class LeapOptions:
    """Options of the connection to a Leap's service."""

    leap: str = field(default=DEFAULT_ADDRESS, metadata={"metavar": "URL"})
    """WebSocket address of leapd or of the Ultraleap bridge, for --device leap."""


@dataclass(frozen=True, kw_only=True)
class OverLeapOptions:
    """Position of a live, simulated or recorded Leap, and calibration of the hand over it."""

    leap_at: str = field(default=",".join(f"{c:g}" for c in UNDER), metadata={"metavar": "X,Y,Z"})
    """Position of the Leap in the scene, in m from the centre of the table top: right, away, up.
    With the default, a hand 20 cm above the device is 10 cm above the table."""

    calibration: Path | None = field(default=None, metadata={"metavar": "FILE"})
    """Calibration of your hand by `sandbox paalm calibrate --out FILE`; --profile FILE accepts it,
    too. Default: the open hand in a recording, the bones that the device reports, or an average
    hand."""


@dataclass(frozen=True, kw_only=True)
class LeapCommandOptions(OverLeapOptions, LeapOptions):
    """Options of a live Leap on the command line."""


def over_leap(options: OverLeapOptions, side: str, live: bool = False) -> HandInput:
    """Returns the input settings of a hand over a live or simulated Leap.

    Args:
        options: Position and calibration.
        side: `right` or `left`.
        live: True for a person's hand. Without a calibration, a warning then describes the
            assumed bones.

    Raises:
        InputError: The position or the calibration is unusable.
    """
    at = _position(options)
    if options.calibration is None and live:
        _warn(
            f"no --calibration: the {side} hand gets the bones that the device reports, or those "
            "of an average hand if it reports none"
        )
    return HandInput.of(at, _calibration(options, side))


@dataclass(frozen=True, kw_only=True)
class PlayedLeapOptions(UnitOptions, OverLeapOptions):
    """Options of a recording of a Leap on the command line."""


def in_leap_file(options: PlayedLeapOptions, file: str, side: str) -> HandInput:
    """Returns the input settings of a hand in a recording of a Leap.

    Args:
        options: Position and calibration. Without a calibration, the open hand in the recording is
            measured.
        file: Path of the recording.
        side: `right` or `left`.

    Raises:
        InputError: The position, the calibration or the recording is unusable.
    """
    from sandbox.devices.files import read_once
    from sandbox.devices.leap.leap_file import read_leap

    at = _position(options)
    known = _calibration(options, side)
    return HandInput.of(
        at, known or _recorded(read_once(read_leap, Path(file), options.unit), side, file)
    )


def _position(options: OverLeapOptions) -> tuple[float, float, float]:
    try:
        x, y, z = map(float, options.leap_at.split(","))
    except ValueError:
        raise InputError(
            "not a position", where="--leap-at", got=options.leap_at, expected="X,Y,Z in m"
        ) from None
    return x, y, z


def _calibration(options: OverLeapOptions, side: str) -> HandCalibration | None:
    if options.calibration is None:
        return None
    from encoders.paalm.calibration_file import read_hand

    return read_hand(options.calibration, side)


def _recorded(recording: LeapRecording, side: str, name: str) -> HandCalibration:
    """Returns the calibration of the hand in a recording."""
    from encoders.paalm import Paalm
    from encoders.paalm.average import calibrate_on_recording
    from sandbox.devices.leap.leap_file import check_side, doubt_of_side

    check_side(recording.frames, side, name, "--hand")
    paalm = Paalm()
    why = calibrate_on_recording(paalm, recording.frames, cast(Any, side))
    for text in (doubt_of_side(recording.frames, side, "--hand"), why):
        if text:
            _warn(text)
    return paalm.calibration[side]


def _warn(text: str) -> None:
    from rich.console import Console
    from rich.text import Text

    Console(stderr=True).print(Text(text, style="yellow"))


def _open(options: LeapOptions, place: Place) -> AnyDevice:
    from sandbox.devices.leap.leap import open_leap

    return open_leap(options.leap, tell=True)


def _open_file(options: PlayedOptions, place: Place) -> AnyDevice:
    from sandbox.devices.files import read_once, show_report
    from sandbox.devices.leap.leap import LeapFileDevice
    from sandbox.devices.leap.leap_file import read_leap

    recording = read_once(read_leap, Path(place.argument), options.unit)
    show_report(recording.report)
    return LeapFileDevice(recording)


def _check_file(options: PlayedOptions, argument: str) -> None:
    from sandbox.devices.files import read_once
    from sandbox.devices.leap.leap_file import read_leap

    read_once(read_leap, Path(argument), options.unit)


def _open_simulated(options: InAirOptions, place: Place) -> AnyDevice:
    # The simulation loads parts of SciPy, which is slow.
    from sandbox.devices.simulated.in_air import SimulatedLeap, parse_simulated

    dialect, trouble = parse_simulated(place.argument)
    return SimulatedLeap(
        place.drawn_task,
        options.user,
        place.seed,
        place.at,
        dialect,
        place.person,
        place.hand,
        trouble=trouble,
    )


def _check_simulated(options: InAirOptions, argument: str) -> None:
    if argument:
        from sandbox.devices.simulated.in_air import parse_simulated

        parse_simulated(argument)


DEVICE: DeviceEntry[Any] = DeviceEntry(
    "a hand in the air over a Leap",
    _open,
    LeapOptions,
    DeviceKind(Sees.LEAP, labels=True, in_scene=True),
    command_options=LeapCommandOptions,
    hand_input=lambda options, argument, side: over_leap(options, side, live=True),
)

SIMULATED: DeviceEntry[Any] = DeviceEntry(
    "a Leap over which a simulated user moves a hand",
    _open_simulated,
    InAirOptions,
    DeviceKind(Sees.LEAP, Source.SIMULATED, labels=True, in_scene=True),
    argument="DIALECT,DISTURBANCE",
    check=_check_simulated,
    command_options=OverLeapOptions,
    hand_input=lambda options, argument, side: over_leap(options, side),
)

FILE: DeviceEntry[Any] = DeviceEntry(
    "a recording of a Leap",
    _open_file,
    PlayedOptions,
    DeviceKind(Sees.LEAP, Source.FILE, labels=True, in_scene=True),
    check=_check_file,
    command_options=PlayedLeapOptions,
    hand_input=in_leap_file,
)
