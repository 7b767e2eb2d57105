"""Opens the devices that settings name, for a drawn task on placed surfaces.

A device maker opens the device of one hand. Settings name one device for each hand, or one device
that both hands share.
"""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import cast

from models.errors import InputError
from models.surface import Surface
from sandbox.devices.device import AnyDevice, Device, Place, Sees
from sandbox.devices.registry import kind_of, named_device
from sandbox.devices.simulated import NEXT_PERSON
from sandbox.recording.recording import Recording, is_recording, load_recording
from sandbox.trial.settings import Settings
from sandbox.trial.surfaces import home, homes
from tasks.task import Task

DeviceMaker = Callable[[Task, Surface], Device]
"""Function that opens a device for a drawn task on a placed surface."""

DeviceMakers = tuple[DeviceMaker, ...]
"""One maker per hand, in the order of `Settings.hands`."""

Around = Callable[[DeviceMaker], DeviceMaker]
"""Function that puts something around the device that a maker opens."""


def device_makers(settings: Settings, around: Around = lambda make: make) -> DeviceMakers:
    """Makers of the devices that settings name, one for each hand.

    Args:
        settings: Settings of the run.
        around: Change of the maker of the first device, beneath all that degrades or shares it.

    Raises:
        InputError: A device does not exist, or its file cannot be read.
    """
    name, second = settings.device.name, settings.second_device
    first = _degraded(around(_maker(settings, 0)), settings, 0)
    if len(settings.hands) == 1:
        return (first,)
    sees = kind_of(name).sees
    if second is None:
        return shared_makers(first, settings, sees)
    other = _degraded(_maker(settings, 1), settings, 1)
    one_leap = sees is Sees.LEAP and second.name == name
    one_screen = name == "simulated" and settings.surface.shared
    if one_leap or one_screen:
        return shared_by_users((first, other), settings, sees)
    return first, other


def place_of(settings: Settings, hand: int, task: Task, surface: Surface) -> Place:
    """Where, and for whom, the device of a hand is opened.

    Args:
        settings: Settings of the run.
        hand: Index of the hand.
        task: The drawn task.
        surface: Surface of the device, placed in the world.
    """
    whose, kind = settings.hands[hand], kind_of(settings.device_of(hand).name)
    served = settings.hands if settings.one_device else (whose,)
    return Place(
        surface,
        hand=hand,
        sides=tuple(each.side for each in served),
        person=whose.person,
        task=task,
        seed=settings.seed,
        labels=kind.labels and settings.pipeline.labels == "device",
        home=home(hand, settings, surface),
        at=(0.0, 0.0, 0.0) if whose.in_air is None else whose.in_air.at,
    )


def shared_makers(make: DeviceMaker, settings: Settings, sees: Sees) -> DeviceMakers:
    """Makers for two hands that open one device and share it.

    Args:
        make: Opens the device.
        settings: Settings of the run.
        sees: What the device sees, which decides how its frames are divided.
    """
    # Most trials have one hand.
    from sandbox.devices.wrappers.shared import SharedDevice, Split, SplitByPlace

    def split(surface: Surface) -> Split:
        if sees is Sees.TOUCHES:
            return SplitByPlace(homes(settings, surface))
        if sees is Sees.LEAP:
            from sandbox.devices.leap.two_hands import SplitBySide

            return SplitBySide([hand.side for hand in settings.hands])
        return Split()

    parts: list[Device] = []

    def first(task: Task, surface: Surface) -> Device:
        parts[:] = SharedDevice(make(task, surface), split(surface)).parts
        return parts[0]

    def second(task: Task, surface: Surface) -> Device:
        return parts[1]

    return first, second


def shared_by_users(makers: DeviceMakers, settings: Settings, sees: Sees) -> DeviceMakers:
    """Makers for two simulated users who share one device.

    Args:
        makers: Open the device of each user.
        settings: Settings of the run.
        sees: What the device sees.
    """
    return shared_makers(_merged(makers, sees), settings, sees)


def with_first(makers: DeviceMakers, change: Around) -> DeviceMakers:
    """The makers, with a change to that of the first hand, which is the person at the screen."""
    first, *others = makers
    return (change(first), *others)


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


def is_live(settings: Settings) -> bool:
    """True if a person or another program drives the run, which is then in real time."""
    devices = filter(None, (settings.device, settings.second_device))
    return any(kind_of(device.name).live for device in devices)


def recording_of(device: str) -> Recording | None:
    """The recording that a device's name names; None if it names another device.

    Raises:
        InputError: There is no such device and no such file, or the file cannot be read.
    """
    named, path = named_device(device), Path(device)
    if named.argument != device or named.entry.kind.in_air or not is_recording(path):
        return None
    from sandbox.devices.files import read_once

    return read_once(load_recording, path)


def _maker(settings: Settings, hand: int) -> DeviceMaker:
    """The maker of the device of one hand."""
    device = settings.device_of(hand)

    def make(task: Task, surface: Surface) -> Device:
        return cast(Device, device.open(place_of(settings, hand, task, surface)))

    return make


def _merged(makers: DeviceMakers, sees: Sees) -> DeviceMaker:
    """A maker of one device of two simulated users."""

    def make(task: Task, surface: Surface) -> Device:
        devices: list[AnyDevice] = [maker(task, surface) for maker in makers]
        if sees is Sees.LEAP:
            from sandbox.devices.leap.two_hands import MergedLeaps

            return MergedLeaps(devices)
        from sandbox.devices.wrappers.shared import MergedTouches

        return MergedTouches(devices)

    return make


def _degraded(make: DeviceMaker, settings: Settings, hand: int) -> DeviceMaker:
    """A maker whose device is disturbed by the settings' variation."""
    variation, name = settings.variation, settings.device_of(hand).name
    if not variation.degrades_touches:
        return make
    from sandbox.devices.wrappers.degraded import DegradedDevice
    from sandbox.recording.recorded_device import RecordedDevice

    # Only simulated users and 3-D devices have random numbers that differ between hands.
    kind = kind_of(name)
    person = hand if kind.in_air or kind.simulated else 0

    def open_device(task: Task, surface: Surface) -> Device:
        device = make(task, surface)
        # Recorded touches were degraded when they were recorded.
        if isinstance(device, RecordedDevice):
            return device
        return DegradedDevice(device, variation, surface, settings.seed + person * NEXT_PERSON)

    return open_device
