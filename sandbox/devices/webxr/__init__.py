"""A headset: its browser shows a page that draws the table and sends the joints of hands."""

from __future__ import annotations

from typing import Any

from sandbox.devices.device import (
    AnyDevice,
    DeviceEntry,
    DeviceKind,
    NoOptions,
    Place,
    Sees,
    Source,
)
from sandbox.devices.hand_input import HandInput
from sandbox.devices.simulated import InAirOptions


def joints_in_world(options: object, argument: str, side: str) -> HandInput:
    """Returns the input settings of a hand in a headset: all joints, in world coordinates."""
    return HandInput(at=(0.0, 0.0, 0.0), joints=True)


def _open(options: NoOptions, place: Place) -> AnyDevice:
    from sandbox.devices.webxr.webxr import HeadsetDevice

    return HeadsetDevice()


def _open_simulated(options: InAirOptions, place: Place) -> AnyDevice:
    # The simulation loads parts of SciPy, which is slow.
    from sandbox.devices.simulated.in_air import SimulatedHeadset

    return SimulatedHeadset(place.drawn_task, options.user, place.seed, place.person, place.hand)


DEVICE = DeviceEntry(
    "hands or controllers in a headset, whose browser opens a page that draws the table",
    _open,
    NoOptions,
    DeviceKind(Sees.HEADSET, labels=True, in_scene=True),
    hand_input=joints_in_world,
)

SIMULATED: DeviceEntry[Any] = DeviceEntry(
    "a headset that sees the hand of a simulated user",
    _open_simulated,
    InAirOptions,
    DeviceKind(Sees.HEADSET, Source.SIMULATED, labels=True, in_scene=True),
    command_options=NoOptions,
    hand_input=joints_in_world,
)
