"""Options for hands in the air over 3-D devices, and how those devices are opened."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, cast

import tyro
from rich.console import Console
from rich.text import Text

from encoders.paalm import Paalm
from encoders.paalm.calibration import HandCalibration
from encoders.paalm.calibration_file import read_hand
from encoders.paalm.recorded import calibrate_on_recording
from models.errors import InputError
from models.surface import Surface
from sandbox.devices.leap.leap import DEFAULT_ADDRESS, LeapDevice, LeapFileDevice
from sandbox.devices.leap.leap_file import (
    LeapRecording,
    check_side,
    doubt_of_side,
    is_leap_recording,
    read_leap,
)
from sandbox.devices.leap.shared_leap import MergedLeap, SharedLeap
from sandbox.devices.registry import built_in, open_built_in
from sandbox.devices.webcam.landmark_file import is_landmark_file
from sandbox.options.leap_calibration import chosen_calibration
from sandbox.recording.recording import Recording
from sandbox.session.device import Device
from sandbox.trial.device_makers import DeviceMaker, DeviceMakers
from sandbox.trial.hand_input import UNDER, HandInput
from sandbox.trial.recorded_settings import recorded_settings
from sandbox.trial.settings import RunSettings
from tasks.task import Task
from tasks.user import UserConfiguration

LIVE, SIMULATED = "leap", "leap-simulated"
SUFFIXES = (".json", ".lz")
"""Suffixes of Leap recordings, which no recording of touches has; others are told by content."""
PATIENCE = 3.0
"""s within which a live device must send its first frame."""
_NORMAL_COUNTS = ("frames", "handshakes", "connections")
"""Counts of a device that do not report a problem."""


@dataclass(frozen=True)
class LeapOptions:
    """Options for hands in the air."""

    leap: Annotated[str, tyro.conf.arg(metavar="URL")] = DEFAULT_ADDRESS
    """WebSocket address of leapd or of the Ultraleap bridge, for --device leap."""

    leap_at: Annotated[str, tyro.conf.arg(metavar="X,Y,Z")] = ",".join(f"{c:g}" for c in UNDER)
    """Position of the Leap in the scene, in m from the centre of the table top: right, away, up.
    With the default, a hand 20 cm above the device is 10 cm above the table."""

    calibration: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Your hand as measured by `sandbox paalm calibrate --out FILE`; --profile FILE works, too.
    Default: the open hand in a recording, the bones that the device reports, or an average hand."""


def is_leap(device: str) -> bool:
    """True if a device is a Leap: `leap`, `leap-simulated`, or a Leap recording."""
    entry = built_in(device)
    if entry is not None:
        return entry.in_air and not (entry.camera or entry.headset)
    path = Path(device)
    if not path.is_file() or is_landmark_file(path):
        return False
    return path.suffix in SUFFIXES or is_leap_recording(path)


def both_over_one_device(options: Any) -> bool:
    """True if two hands, should there be two, are over the same 3-D device."""
    return is_leap(options.device) and options.second_device in (None, options.device)


def with_leap_hands(
    settings: RunSettings, options: Any, second_recording: Recording | None
) -> RunSettings:
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
        played = recorded_settings(second_recording.header)
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
    one_surface = settings.one_surface and in_air is None
    return replace(settings, hands=(first, replace(second, in_air=in_air)), one_surface=one_surface)


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


def leap_maker(options: Any, settings: RunSettings, user: UserConfiguration, hand: int) -> Any:
    """Returns a function that opens the 3-D device of one hand.

    Args:
        options: `LeapOptions` with `device`.
        settings: Settings of the run.
        user: Simulated user, who moves the hand over a simulated device.
        hand: Index of the hand in `settings.hands`.

    Raises:
        InputError: The dialect is unknown, or the file cannot be read.
    """
    device: str = options.device
    if device == LIVE:
        return lambda task, surface: open_leap(options.leap, tell=True)
    if built_in(device) is None:
        recording = read_leap(Path(device))
        _report_left_out(recording.counts)
        return lambda task, surface: LeapFileDevice(recording)
    if device.partition(":")[0] != SIMULATED:
        return lambda task, surface: open_built_in(device, surface)
    # Bodies and devices are simulated with parts of SciPy that take long to load.
    from sandbox.devices.simulated.leap_disturbance import parse_simulated
    from sandbox.devices.simulated.leap_user import SimulatedLeap

    dialect, trouble = parse_simulated(device.partition(":")[2])
    hand_settings = settings.hands[hand]
    assert hand_settings.in_air is not None
    person, at = hand_settings.person, hand_settings.in_air.at
    return lambda task, surface: SimulatedLeap(
        task, user, settings.seed, at, dialect, person, hand, trouble=trouble
    )


def split_by_side(
    makers: DeviceMakers | None, make: DeviceMaker, settings: RunSettings
) -> DeviceMakers:
    """Returns makers of two devices that share one 3-D device, each with the hand of one side.

    Args:
        makers: Open the hands of two simulated people over a shared device; None if one device
            sees both hands.
        make: Opens the single device.
        settings: Settings of the run.
    """
    parts: list[Device] = []
    first_side, second_side = (hand.side for hand in settings.hands)

    def first(task: Task, surface: Surface) -> Device:
        device: Any = make(task, surface) if makers is None else None
        if makers is not None:
            device = MergedLeap([cast(Any, maker(task, surface)) for maker in makers])
        shared = SharedLeap(device, (first_side, second_side))
        parts[:] = [cast(Device, part) for part in shared.parts]
        return parts[0]

    def second(task: Task, surface: Surface) -> Device:
        return parts[1]

    return first, second


class ReportingLeapDevice(LeapDevice):
    """A live device that prints, when closed, its unusable frames and repeated connections."""

    def close(self) -> None:
        """Ends the connection, once."""
        closed = self._stop.is_set()
        super().close()
        if not closed:
            _report_left_out(self.counts)


def open_leap(address: str = DEFAULT_ADDRESS, tell: bool = False) -> LeapDevice:
    """Connects to a running Leap service and waits for its first message.

    Args:
        address: WebSocket URL.
        tell: Print unusable frames and repeated connections when the device is closed.

    Raises:
        DeviceError: The service sends nothing.
    """
    device = ReportingLeapDevice(address) if tell else LeapDevice(address)
    if not device.wait(PATIENCE):
        device.close()
        raise device.silent(PATIENCE)
    return device


def _recorded(recording: LeapRecording, side: str, name: str) -> HandCalibration:
    """Returns the calibration of the hand in a recording."""
    check_side(recording.frames, side, name, "--hand")
    paalm = Paalm()
    why = calibrate_on_recording(paalm, recording.frames, cast(Any, side))
    for text in (doubt_of_side(recording.frames, side, "--hand"), why):
        if text:
            _warn(text)
    return paalm.calibration[side]


def _report_left_out(counts: Counter[str]) -> None:
    """Prints counts of frames that could not be used, if there were any."""
    left = {what: n for what, n in counts.items() if n and what not in _NORMAL_COUNTS}
    # The first connection is the normal start.
    if counts["connections"] > 1:
        left["new connections"] = counts["connections"] - 1
    if left:
        _warn("left out: " + ", ".join(f"{n} {what}" for what, n in left.items()))


def _warn(text: str) -> None:
    Console(stderr=True).print(Text(text, style="yellow"))
