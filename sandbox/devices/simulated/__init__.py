"""A simulated user at a tablet. Simulated users over a Leap and in a headset are entries of
`sandbox.devices.leap` and `sandbox.devices.webxr`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from models.errors import InputError
from sandbox.devices.device import (
    AnyDevice,
    DeviceEntry,
    DeviceKind,
    NoOptions,
    Place,
    Source,
)
from tasks.user import UserConfiguration

NEXT_PERSON = 1_000_003
"""Added to the seed for the user of the second hand; larger than all seeds of trials."""
MOST_DROP_OUTS = 10.0
"""Largest rate at which a simulated screen loses each touch, 1/s."""


@dataclass(frozen=True)
class SimulatedOptions:
    """Options of the simulated user at a tablet."""

    user: UserConfiguration = field(default_factory=UserConfiguration)
    """The simulated user."""

    drop_outs: float = 0.0
    """Rate at which the user's screen loses each touch, 0 to 10 times per second."""

    def __post_init__(self) -> None:
        if not 0.0 <= self.drop_outs <= MOST_DROP_OUTS:
            raise InputError(
                "out of range",
                where="--drop-outs",
                got=self.drop_outs,
                expected=f"0 to {MOST_DROP_OUTS:g} times per second",
            )


@dataclass(frozen=True)
class InAirOptions:
    """Options of a simulated person over a Leap, or in a headset."""

    user: UserConfiguration = field(default_factory=UserConfiguration)
    """The simulated user."""


def _open(options: SimulatedOptions, place: Place) -> AnyDevice:
    from sandbox.devices.simulated.simulated import SimulatedDevice

    return SimulatedDevice(
        place.drawn_task,
        options.user,
        place.surface,
        place.seed,
        place.labels,
        options.drop_outs,
        place.person,
        place.hand,
        place.home,
    )


DEVICE: DeviceEntry[Any] = DeviceEntry(
    "a tablet under the fingers of a simulated user",
    _open,
    SimulatedOptions,
    DeviceKind(source=Source.SIMULATED, labels=True, in_scene=True, one_hand=True),
    command_options=NoOptions,
)
