"""Opens a headset, or a simulated person in one."""

from __future__ import annotations

from typing import cast

from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.webxr.webxr import HeadsetDevice
from sandbox.trial.device_makers import DeviceMaker, DeviceMakers
from sandbox.trial.settings import Settings
from tasks.task import Task


def headset_maker(settings: Settings, hand: int) -> DeviceMaker:
    """A maker of a headset's device for one hand."""
    (make,) = headset_makers(1)
    return make


def headset_makers(hands: int) -> DeviceMakers:
    """Returns makers of a headset's device for one hand, or for two that share it."""
    opened: list[HeadsetDevice] = []

    def first(task: Task, surface: Surface) -> Device:
        opened[:] = [HeadsetDevice()]
        return cast(Device, opened[0])

    def second(task: Task, surface: Surface) -> Device:
        return cast(Device, opened[0].second)

    return (first, second)[:hands]


def simulated_headset_maker(settings: Settings, hand: int) -> DeviceMaker:
    """Returns a maker of a simulated headset.

    Args:
        settings: Settings of the run.
        hand: Index of the hand in `settings.hands`.
    """
    # Bodies are simulated with parts of SciPy that take long to load.
    from sandbox.devices.simulated.headset_user import SimulatedHeadset

    person, user = settings.hands[hand].person, settings.device_of(hand).user
    assert user is not None
    return lambda task, surface: cast(
        Device, SimulatedHeadset(task, user, settings.seed, person, hand)
    )
