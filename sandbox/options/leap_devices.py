"""Hands in the air on the command line: which devices are 3-D ones, and what they need."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, cast

import tyro
from rich.console import Console
from rich.text import Text

from encoders.paalm import Paalm
from encoders.paalm.average import average_calibration
from encoders.paalm.calibration import HandCalibration
from encoders.paalm.calibration_file import read_hand
from models.errors import EncoderError, InputError
from models.surface import Surface
from sandbox.devices.leap.leap import DEFAULT_ADDRESS, LeapDevice, LeapFileDevice
from sandbox.devices.leap.leap_file import LeapRecording, check_side, read_leap
from sandbox.devices.leap.shared_leap import MergedLeap, SharedLeap
from sandbox.devices.registry import built_in, open_built_in
from sandbox.options.own_hand import chosen_file
from sandbox.recording.recording import Recording
from sandbox.session.device import Device
from sandbox.trial.device_makers import DeviceMaker, DeviceMakers
from sandbox.trial.hand_input import UNDER, HandInput
from sandbox.trial.settings import RunSettings
from tasks.task import Task
from tasks.user import UserConfiguration

LIVE, SIMULATED = "leap", "leap-simulated"
SUFFIXES = (".json", ".lz")
"""Of Leap recordings; touches are in files of other names."""
PATIENCE = 3.0
"""s that a live device has to say something."""
_USED = ("frames", "handshakes", "connections")
"""Of a device's counts, those of nothing that was wrong."""
OPEN_FRAMES = 100
"""Frames of a recorded open hand that measure it, as in `sandbox paalm show`."""


@dataclass(frozen=True)
class LeapOptions:
    """Of hands in the air."""

    leap: Annotated[str, tyro.conf.arg(metavar="URL")] = DEFAULT_ADDRESS
    """Where --device leap finds leapd or the Ultraleap bridge."""

    leap_at: Annotated[str, tyro.conf.arg(metavar="X,Y,Z")] = ",".join(f"{c:g}" for c in UNDER)
    """Where the Leap is in the scene, m from the middle of the table's top: right, away, up. A hand
    20 cm over the device is 10 cm over the table unless this says otherwise."""

    calibration: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    """Your hand, as `sandbox paalm calibrate --out FILE` measured it; --profile takes it, too.
    Without one: an average hand, or what a recording's open hand or the device's bones say."""


def is_leap(device: str) -> bool:
    """Whether a device's name means a 3-D one: `leap`, `leap-simulated`, or a Leap recording."""
    entry = built_in(device)
    if entry is not None:
        return entry.in_air
    path = Path(device)
    return path.suffix in SUFFIXES and path.is_file()


def from_one(options: Any) -> bool:
    """Whether both hands, where there are two, are over the same device."""
    return is_leap(options.device) and options.second_device in (None, options.device)


def with_leaps(
    settings: RunSettings, options: Any, second_recording: Recording | None
) -> RunSettings:
    """The settings with what has to be known of 3-D devices.

    Args:
        settings: Of both hands.
        options: `LeapOptions` with `device` and `second_device`.
        second_recording: What the second hand's device plays, where it is another recording.

    Raises:
        InputError: A place or a calibration cannot be used, or both hands are of one side.
    """
    first, *others = settings.hands
    if is_leap(options.device):
        if settings.variation.degrades_touches:
            raise InputError("touches can be spoiled, hands in the air cannot", where="--vary")
        first = replace(first, in_air=hand_input(options, options.device, first.side))
        settings = replace(settings, hands=(first, *others))
    if not others:
        return settings
    second = others[0]
    other = options.second_device or options.device
    if second_recording is not None:
        played = RunSettings.from_json(second_recording.header["settings"])
        in_air = played.hands[1 if 1 in second_recording.inputs else 0].in_air
    elif is_leap(other):
        in_air = hand_input(options, other, second.side)
    else:
        return settings
    if from_one(options) and first.side == second.side:
        raise InputError(
            "one Leap tells two hands by their sides", where="--hand", got=f"two {second.side} ones"
        )
    one_surface = settings.one_surface and in_air is None
    return replace(settings, hands=(first, replace(second, in_air=in_air)), one_surface=one_surface)


def hand_input(options: LeapOptions, device: str, side: str) -> HandInput:
    """Place and calibration of one hand.

    Raises:
        InputError: They cannot be used.
    """
    try:
        x, y, z = map(float, options.leap_at.split(","))
    except ValueError:
        raise InputError(
            "this is no place", where="--leap-at", got=options.leap_at, expected="X,Y,Z in m"
        ) from None
    found: HandCalibration | None = None
    file = chosen_file(options)
    if file is not None:
        found = read_hand(file, side)
    elif (entry := built_in(device)) is None:
        found = _recorded(read_leap(Path(device)), side, device)
    elif not entry.simulated:
        _say(f"no --calibration: your {side} hand is taken for an average one")
    return HandInput.of((x, y, z), found)


def leap_maker(options: Any, settings: RunSettings, user: UserConfiguration, hand: int) -> Any:
    """What opens a 3-D device for one hand.

    Args:
        options: `LeapOptions` with `device`.
        settings: Of the run.
        user: Who moves the hand over a simulated device.
        hand: Whose.

    Raises:
        InputError: There is no such dialect, or the file cannot be read.
    """
    device: str = options.device
    if device == LIVE:
        return lambda task, surface: open_leap(options.leap, tell=True)
    if built_in(device) is None:
        recording = read_leap(Path(device))
        _tell_left_out(recording.counts)
        return lambda task, surface: LeapFileDevice(recording)
    if device.partition(":")[0] != SIMULATED:
        return lambda task, surface: open_built_in(device, surface)
    # Bodies and devices are simulated with parts of SciPy that take long to load.
    from sandbox.devices.simulated.leap_disturbance import parse_simulated
    from sandbox.devices.simulated.leap_user import SimulatedLeap

    dialect, trouble = parse_simulated(device.partition(":")[2])
    whose = settings.hands[hand]
    assert whose.in_air is not None
    person, at = whose.person, whose.in_air.at
    return lambda task, surface: SimulatedLeap(
        task, user, settings.seed, at, dialect, person, hand, trouble=trouble
    )


def over_one(makers: DeviceMakers | None, make: DeviceMaker, settings: RunSettings) -> DeviceMakers:
    """Opens one device for both hands, split by side.

    Args:
        makers: Of two simulated people, who share one; None where a single device sees both.
        make: Of the single device.
        settings: Of the run.
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


class TellingLeap(LeapDevice):
    """A live device that says at its end what it left out, and how often it had to be called."""

    def close(self) -> None:
        """Ends the connection, once."""
        closed = self._stop.is_set()
        super().close()
        if not closed:
            _tell_left_out(self.counts)


def open_leap(address: str = DEFAULT_ADDRESS, tell: bool = False) -> LeapDevice:
    """A running service that says something.

    Args:
        address: WebSocket URL.
        tell: Say at the end what was left out.

    Raises:
        DeviceError: It does not.
    """
    device = TellingLeap(address) if tell else LeapDevice(address)
    if not device.wait(PATIENCE):
        device.close()
        raise device.silent(PATIENCE)
    return device


def _recorded(recording: LeapRecording, side: str, name: str) -> HandCalibration:
    """The hand of a recording: measured where it is held open, else an average one."""
    check_side(recording.frames, side, name, "--hand")
    paalm = Paalm()
    try:
        return paalm.calibrate(recording.frames, cast(Any, side), OPEN_FRAMES)[side]
    except EncoderError as error:
        _say(f"taken for an average hand, because {error}")
        return average_calibration(recording.frames, side, paalm.options)


def _tell_left_out(counts: Counter[str]) -> None:
    """Says what of a device's frames could not be used, where anything could not."""
    left = {what: n for what, n in counts.items() if n and what not in _USED}
    # One call is how it begins.
    if counts["connections"] > 1:
        left["new connections"] = counts["connections"] - 1
    if left:
        _say("left out: " + ", ".join(f"{n} {what}" for what, n in left.items()))


def _say(text: str) -> None:
    Console(stderr=True).print(Text(text, style="yellow"))
