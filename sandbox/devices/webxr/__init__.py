"""A headset whose page draws the table and sends the joints of hands."""

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
    """How a headset sees a hand: all its joints, in the world of the table."""
    return HandInput(at=(0.0, 0.0, 0.0), joints=True)


def _open(options: NoOptions, place: Place) -> AnyDevice:
    from sandbox.devices.webxr.webxr import HeadsetDevice

    return HeadsetDevice()


def _open_simulated(options: InAirOptions, place: Place) -> AnyDevice:
    # Bodies are simulated with parts of SciPy that take long to load.
    from sandbox.devices.simulated.in_air import SimulatedHeadset

    return SimulatedHeadset(place.drawn_task, options.user, place.seed, place.person, place.hand)


DEVICE = DeviceEntry(
    "hands in a headset, or controllers: a page that enters VR draws the table and sends them",
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
