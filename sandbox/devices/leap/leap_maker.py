"""Opens 3-D devices: a live Leap, a recording of one, or a simulated person over one."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any, cast

from rich.console import Console
from rich.text import Text

from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.kinds import LIVE_LEAP
from sandbox.devices.leap.leap import LeapDevice, LeapFileDevice
from sandbox.devices.leap.leap_file import read_leap
from sandbox.devices.leap.options import DEFAULT_ADDRESS
from sandbox.devices.leap.shared_leap import MergedLeap, SharedLeap
from sandbox.devices.registry import built_in, open_built_in
from sandbox.trial.device_makers import DeviceMaker, DeviceMakers
from sandbox.trial.settings import Settings
from tasks.task import Task

SIMULATED = "leap-simulated"
PATIENCE = 3.0
"""s within which a live device must send its first frame."""
_NORMAL_COUNTS = ("frames", "handshakes", "connections")
"""Counts of a device that do not report a problem."""


def leap_maker(settings: Settings, hand: int) -> Any:
    """Returns a function that opens the 3-D device of one hand.

    Args:
        settings: Settings of the run.
        hand: Index of the hand in `settings.hands`.

    Raises:
        InputError: The dialect is unknown, or the file cannot be read.
    """
    chosen = settings.device_of(hand)
    device, user = chosen.name, chosen.user
    if device == LIVE_LEAP:
        return lambda task, surface: open_leap(chosen.options.leap, tell=True)
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
    assert hand_settings.in_air is not None and user is not None
    person, at = hand_settings.person, hand_settings.in_air.at
    return lambda task, surface: SimulatedLeap(
        task, user, settings.seed, at, dialect, person, hand, trouble=trouble
    )


def split_by_side(
    makers: DeviceMakers | None, make: DeviceMaker, settings: Settings
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
