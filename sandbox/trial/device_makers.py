"""Device makers: functions that open a hand's device for a drawn task on a placed surface."""

from __future__ import annotations

from collections.abc import Callable

from models.errors import InputError
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.trial.settings import Settings
from sandbox.trial.surfaces import homes
from tasks.task import Task

DeviceMaker = Callable[[Task, Surface], Device]
"""Function that opens a device for a drawn task on a placed surface."""

DeviceMakers = tuple[DeviceMaker, ...]
"""One maker per hand, in the order of `Settings.hands`."""


def with_first(makers: DeviceMakers, change: Callable[[DeviceMaker], DeviceMaker]) -> DeviceMakers:
    """The makers, with a change to that of the first hand, which is the person at the screen."""
    first, *others = makers
    return (change(first), *others)


def sharing(make_device: DeviceMaker, settings: Settings) -> DeviceMakers:
    """Makers for two hands that open one device and share its surface.

    Args:
        make_device: Opens the device.
        settings: Settings of the run.
    """
    from sandbox.devices.wrappers.shared import SharedSurface

    parts: list[Device] = []

    def first(task: Task, surface: Surface) -> Device:
        parts[:] = SharedSurface(make_device(task, surface), homes(settings, surface)).parts
        return parts[0]

    def second(task: Task, surface: Surface) -> Device:
        return parts[1]

    return first, second


def merging(makers: DeviceMakers) -> DeviceMaker:
    """A maker that opens both hands' devices on one surface and merges their touches."""

    from sandbox.devices.wrappers.shared import MergedTouches

    def make(task: Task, surface: Surface) -> Device:
        first, second = (maker(task, surface) for maker in makers)
        return MergedTouches((first, second))

    return make


def check_count(makers: DeviceMakers, settings: Settings) -> None:
    """Checks that there is one maker per hand.

    Raises:
        InputError: The numbers of makers and hands differ.
    """
    if len(makers) != len(settings.hands):
        raise InputError(
            "every hand needs its own device, or a share of one",
            where=settings.task,
            got=f"{len(makers)} for {len(settings.hands)} hands",
        )
