"""Opens the devices that settings name."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from pathlib import Path

from models.errors import unknown_name
from models.plugins import imported
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.device_settings import DeviceSettings
from sandbox.devices.kinds import DeviceKind, is_in_air, kind_of
from sandbox.devices.registry import DEVICES, OWN_DEVICE, built_in, find_device, offered_devices
from sandbox.devices.simulated.options import NEXT_PERSON
from sandbox.recording.recording import Recording, is_recording, load_recording
from sandbox.trial.device_makers import DeviceMaker, DeviceMakers, merging, sharing
from sandbox.trial.settings import Settings
from tasks.task import Task

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
    kind = kind_of(name)
    if second is not None:
        other = _degraded(_maker(settings, 1), settings, 1)
        if kind is DeviceKind.LEAP and second.name == name:
            from sandbox.devices.leap.leap_maker import split_by_side

            return split_by_side((first, other), first, settings)
        if name == "simulated" and settings.surface.shared:
            return sharing(merging((first, other)), settings)
        return first, other
    match kind:
        case DeviceKind.LEAP:
            from sandbox.devices.leap.leap_maker import split_by_side

            return split_by_side(None, first, settings)
        case DeviceKind.HEADSET:
            from sandbox.devices.webxr.headset_maker import headset_makers

            return headset_makers(len(settings.hands))
        case DeviceKind.CAMERA:
            from sandbox.devices.webcam.webcam_maker import sharing_camera

            return sharing_camera(first)
    return sharing(first, settings)


def is_live(settings: Settings) -> bool:
    """True if a person or another program drives the run, which is then in real time."""
    devices = filter(None, (settings.device, settings.second_device))
    return any(_is_live(device.name) for device in devices)


def recording_of(device: str) -> Recording | None:
    """The recording that a device's name names; None if it names another device.

    Raises:
        InputError: There is no such device and no such file, or the file cannot be read.
    """
    path = Path(device)
    if built_in(device) is not None or is_in_air(device):
        return None
    if not path.exists():
        if find_device(device) is not None:
            return None
        raise unknown_name(
            "no such device or file",
            device,
            [*DEVICES, *offered_devices()],
            where="--device",
            others=f"{OWN_DEVICE}, or a file",
            remedy="`sandbox touches formats` lists the files that play as devices",
        )
    if not is_recording(path):
        return None
    state = path.stat()
    return _loaded(path, state.st_mtime_ns, state.st_size)


def check_openable(device: DeviceSettings) -> None:
    """Checks, before anything is built, a device's argument, its engine or its file of touches.

    Raises:
        InputError: The device cannot be opened like that.
    """
    path, argument = Path(device.name), device.name.partition(":")[2]
    entry = built_in(device.name)
    if device.name == "webcam":
        from sandbox.devices.webcam.installed import installed_engine

        installed_engine()
    elif entry is not None and entry.simulated and argument:
        from sandbox.devices.simulated.leap_disturbance import parse_simulated

        parse_simulated(argument)
    elif entry is not None or is_in_air(device.name) or not path.exists():
        return
    elif not is_recording(path):
        from sandbox.devices.open_touches import open_file

        open_file(path, None).device.close()


@lru_cache(maxsize=2)
def _loaded(path: Path, changed: int, size: int) -> Recording:
    """A recording, read once for settings and devices of both hands."""
    return load_recording(path)


def _is_live(device: str) -> bool:
    entry = built_in(device)
    if entry is not None:
        return entry.live
    return not Path(device).exists()


def _maker(settings: Settings, hand: int) -> DeviceMaker:
    """The maker of the device of one hand."""
    device = settings.device_of(hand)
    entry = built_in(device.name)
    if entry is not None and entry.maker:
        maker: DeviceMaker = imported(entry.maker)(settings, hand)
        return maker
    kind = kind_of(device.name)
    if kind in _FILES:
        maker = imported(_FILES[kind])(settings, hand)
        return maker
    from sandbox.devices.open_touches import live_maker, open_file

    if (make := live_maker(device)) is not None:
        return _on_surface(make)
    recording = recording_of(device.name)
    if recording is not None:
        from sandbox.recording.recorded_device import RecordedDevice

        recorded_hand = hand if hand in recording.inputs else 0
        return lambda task, surface: RecordedDevice(recording, recorded_hand)
    path = Path(device.name)
    return _on_surface(lambda surface: open_file(path, surface).device)


_FILES = {
    DeviceKind.LEAP: "sandbox.devices.leap.leap_maker:leap_maker",
    DeviceKind.CAMERA: "sandbox.devices.webcam.webcam_maker:webcam_maker",
}
"""Makers of devices that play files of hands in the air."""


def _degraded(make: DeviceMaker, settings: Settings, hand: int) -> DeviceMaker:
    """A maker whose device is disturbed by the settings' variation."""
    variation, name = settings.variation, settings.device_of(hand).name
    if not variation.degrades_touches:
        return make
    from sandbox.devices.wrappers.degraded import DegradedDevice
    from sandbox.recording.recorded_device import RecordedDevice

    # Only simulated users and 3-D devices have random numbers that differ between hands.
    person = hand if is_in_air(name) or name == "simulated" else 0

    def open_device(task: Task, surface: Surface) -> Device:
        device = make(task, surface)
        # Recorded touches were degraded when they were recorded.
        if isinstance(device, RecordedDevice):
            return device
        return DegradedDevice(device, variation, surface, settings.seed + person * NEXT_PERSON)

    return open_device


def _on_surface(make: Callable[[Surface], Device]) -> DeviceMaker:
    """A maker of a device that does not depend on the task."""
    return lambda task, surface: make(surface)
