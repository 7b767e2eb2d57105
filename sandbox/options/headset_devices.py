"""Hands that a headset sees: their settings, and how the device is opened."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, cast

from models.errors import InputError
from models.surface import Surface
from sandbox.devices.webxr.webxr import HeadsetDevice
from sandbox.session.device import Device
from sandbox.trial.device_makers import DeviceMaker, DeviceMakers
from sandbox.trial.hand_input import HandInput
from sandbox.trial.settings import RunSettings
from tasks.task import Task
from tasks.user import UserConfiguration

LIVE, SIMULATED = "webxr", "webxr-simulated"


def is_headset(device: str) -> bool:
    """True if a device is a headset, or a simulated one."""
    return device in (LIVE, SIMULATED)


def both_in_one_headset(options: Any) -> bool:
    """True if two hands, should there be two, are seen by the same headset."""
    return options.device == LIVE and options.second_device in (None, LIVE)


def with_headset_hands(settings: RunSettings, options: Any) -> RunSettings:
    """Returns settings whose hands are solved from joints where a headset sees them.

    Args:
        settings: Settings with all hands.
        options: Options with `device` and `second_device`.

    Raises:
        InputError: Both hands are of one side, or only the second one is in a headset.
    """
    first, *others = settings.hands
    other = options.second_device or options.device
    if others and other == LIVE and options.device != LIVE:
        raise InputError(
            "a headset shows the scene on its own page, so its hand comes first",
            where="--device",
            got=f"{options.device}, {other}",
            expected=f"--device {LIVE} first",
        )
    seen = HandInput(at=(0.0, 0.0, 0.0), joints=True)
    if is_headset(options.device):
        if settings.variation.degrades_touches:
            raise InputError("touches can be degraded, hands in the air cannot", where="--vary")
        first = replace(first, in_air=seen)
    if others and is_headset(other):
        if both_in_one_headset(options) and first.side == others[0].side:
            raise InputError(
                "two hands in one headset must be a right and a left hand",
                where="--hand",
                got=f"two {first.side} hands",
            )
        others = [replace(others[0], in_air=seen)]
        settings = replace(settings, one_surface=False)
    return replace(settings, hands=(first, *others))


def headset_makers(hands: int) -> DeviceMakers:
    """Returns makers of a headset's device for one hand, or for two that share it."""
    opened: list[HeadsetDevice] = []

    def first(task: Task, surface: Surface) -> Device:
        opened[:] = [HeadsetDevice()]
        return cast(Device, opened[0])

    def second(task: Task, surface: Surface) -> Device:
        return cast(Device, opened[0].second)

    return (first, second)[:hands]


def simulated_maker(settings: RunSettings, user: UserConfiguration, hand: int) -> DeviceMaker:
    """Returns a maker of a simulated headset.

    Args:
        settings: Settings of the run.
        user: Simulated user, whose hand it sees.
        hand: Index of the hand in `settings.hands`.
    """
    # Bodies are simulated with parts of SciPy that take long to load.
    from sandbox.devices.simulated.headset_user import SimulatedHeadset

    person = settings.hands[hand].person
    return lambda task, surface: cast(
        Device, SimulatedHeadset(task, user, settings.seed, person, hand)
    )
