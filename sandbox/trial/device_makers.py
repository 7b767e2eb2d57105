"""Makers of devices: functions that open them for a drawn task on placed surfaces, one a hand."""

from __future__ import annotations

from collections.abc import Callable

from models.errors import InputError
from models.surface import Surface
from sandbox.devices.wrappers.shared import MergedTouches, SharedSurface
from sandbox.session.device import Device
from sandbox.trial.settings import RunSettings
from sandbox.trial.surfaces import homes
from tasks.task import Task

DeviceMaker = Callable[[Task, Surface], Device]
"""Opens a device for a drawn task on a placed surface."""

DeviceMakers = tuple[DeviceMaker, ...]
"""One for every hand, in the order of `RunSettings.hands`."""


def with_first(makers: DeviceMakers, change: Callable[[DeviceMaker], DeviceMaker]) -> DeviceMakers:
    """The makers, with the first hand's changed: the hand of the person before the screen."""
    first, *others = makers
    return (change(first), *others)


def sharing(make_device: DeviceMaker, settings: RunSettings) -> DeviceMakers:
    """Makers for two hands that open a device once and share its surface.

    Args:
        make_device: Opens the device.
        settings: Of the run.
    """
    parts: list[Device] = []

    def first(task: Task, surface: Surface) -> Device:
        parts[:] = SharedSurface(make_device(task, surface), homes(settings, surface)).parts
        return parts[0]

    def second(task: Task, surface: Surface) -> Device:
        return parts[1]

    return first, second


def merging(makers: DeviceMakers) -> DeviceMaker:
    """Opens both hands' devices on one surface, as one that feels the touches of both."""

    def make(task: Task, surface: Surface) -> Device:
        first, second = (maker(task, surface) for maker in makers)
        return MergedTouches((first, second))

    return make


def check_count(makers: DeviceMakers, settings: RunSettings) -> None:
    """Refuses makers that are more or fewer than the hands.

    Raises:
        InputError: They are.
    """
    if len(makers) != len(settings.hands):
        raise InputError(
            "every hand needs a device of its own, or its share of one",
            where=settings.task,
            got=f"{len(makers)} for {len(settings.hands)} hands",
        )
