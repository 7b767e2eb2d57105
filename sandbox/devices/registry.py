"""Devices by name: built-in devices, files that are played, and devices from other packages.

To add a device, write its folder with a `DeviceEntry` and add a line to `DEVICES`. A module is
imported when its device is named, and not before.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from functools import lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import msgspec

from models.errors import DeviceError, InputError, RecordingError, unknown_name
from models.plugins import PluginKind, Registry, imported
from models.surface import Surface
from sandbox.devices.device import (
    AnyDevice,
    DeviceEntry,
    DeviceKind,
    Place,
    PlayedOptions,
    Sees,
)
from sandbox.devices.simulated import SimulatedOptions
from tasks.user import UserConfiguration

if TYPE_CHECKING:
    from sandbox.devices.hand_input import HandInput

DEVICES: Registry[DeviceEntry[Any]] = Registry(
    {
        "mouse": "sandbox.devices.mouse:DEVICE",
        "web": "sandbox.devices.web:DEVICE",
        "tuio": "sandbox.devices.tuio:DEVICE",
        "evdev": "sandbox.devices.evdev:DEVICE",
        "leap": "sandbox.devices.leap:DEVICE",
        "webcam": "sandbox.devices.webcam:DEVICE",
        "webxr": "sandbox.devices.webxr:DEVICE",
        "simulated": "sandbox.devices.simulated:DEVICE",
        "webxr-simulated": "sandbox.devices.webxr:SIMULATED",
        "leap-simulated": "sandbox.devices.leap:SIMULATED",
    }
)
"""Built-in devices: name -> `MODULE:ENTRY`."""

DEVICE_PLUGINS: PluginKind[Any] = PluginKind(
    "device", "hand_sandbox.devices", DeviceError, takes_argument=True, verb="opened"
)
"""Devices offered by other packages (`sandbox.devices.own_device`)."""

_FILES = {
    Sees.TOUCHES: "sandbox.devices.files:FILE",
    Sees.LEAP: "sandbox.devices.leap:FILE",
    Sees.CAMERA: "sandbox.devices.webcam:FILE",
}
"""Kind of a recorded input -> `MODULE:ENTRY` of the device that plays such files."""

LIVE_LEAP, LIVE_WEBCAM, LIVE_HEADSET = "leap", "webcam", "webxr"
"""Live devices for hands in the air."""

_LEAP_SUFFIXES = (".json", ".lz")
"""Suffixes of Leap recordings. Recordings of touches never have them; files with other suffixes are
recognised by their content."""

_OWN_DEVICE = "FILE.py:CLASS[:ARGUMENT]"
"""Form of a device in a file, for error messages."""


class NamedDevice(NamedTuple):
    """A device found by its name.

    Attributes:
        entry: Registry entry of the device.
        argument: Text after the colon of the name, or the path of a file; else empty.
    """

    entry: DeviceEntry[Any]
    argument: str

    def surface(self, given: Mapping[str, Any] | None = None) -> Surface | None:
        """Returns the surface that the device reports; None if it reports none.

        Args:
            given: Values of options on the command line by name; options of other devices are
                ignored.
        """
        return self.entry.surface(options_among(self.entry, given or {}), self.argument)


def find_device(device: str) -> NamedDevice | None:
    """Finds a device by its name; returns None if there is none.

    Args:
        device: `NAME[:ARGUMENT]` of a built-in device or of one from an installed package; a file;
            or `FILE.py:CLASS[:ARGUMENT]` or `MODULE:CLASS[:ARGUMENT]`.

    Raises:
        DeviceError: The code of a user's own device cannot be used.
    """
    entry = built_in(device)
    if entry is not None:
        return NamedDevice(entry, device.partition(":")[2])
    path = Path(device)
    if path.exists():
        return NamedDevice(imported(_FILES[_seen_in(path)]), device)
    # Imported here, since most runs use a built-in device.
    from sandbox.devices.own_device import own_entry

    own = own_entry(device)
    return None if own is None else NamedDevice(*own)


def named_device(device: str, option: str = "--device") -> NamedDevice:
    """Finds a device by its name; see `find_device`.

    Args:
        device: Name of the device.
        option: Option with the name, for the error.

    Raises:
        InputError: There is no such device and no such file; the error names a similar device.
    """
    named = find_device(device)
    if named is None:
        raise unknown_device(device, option)
    return named


def options_among(entry: DeviceEntry[Any], given: Mapping[str, Any]) -> Any:
    """Creates the object of a device's options on the command line.

    Args:
        entry: The device.
        given: Values by name; options of other devices are ignored, missing ones have defaults.
    """
    shown = entry.on_command_line
    names = {each.name for each in fields(shown)}
    return shown(**{name: value for name, value in given.items() if name in names})


def seen_hand(device: str, given: Mapping[str, Any], side: str) -> HandInput:
    """Returns the input settings of a hand for a device that tracks hands in the air.

    Args:
        device: Name of the device.
        given: Values of its options on the command line, by name.
        side: `right` or `left`.

    Raises:
        InputError: The device does not exist or tracks no hands in the air, or an option is
            invalid.
    """
    entry, argument = named_device(device)
    if entry.hand_input is None:
        raise InputError(
            "this device does not track hands in the air",
            where="--device",
            got=device,
            expected="leap, webcam, webxr, leap-simulated, webxr-simulated, or a recording",
        )
    return entry.hand_input(options_among(entry, given), argument, side)


def devices_with_option(name: str) -> list[str]:
    """Returns the names of the built-in devices with an option of this name."""
    return [
        device
        for device, entry in DEVICES.items()
        if name in {each.name for each in fields(entry.on_command_line)}
    ]


def check_device_options(given: Iterable[str], devices: Sequence[str]) -> None:
    """Checks that given options belong to the devices in use.

    Args:
        given: Names of the options.
        devices: Names of the devices.

    Raises:
        InputError: An option belongs to another device; the error names that device.
    """
    known = {
        each.name
        for device in devices
        for each in fields(named_device(device).entry.on_command_line)
    }
    for name in given:
        if name not in known:
            raise unavailable_option(name, devices)


def unavailable_option(name: str, devices: Sequence[str]) -> InputError:
    """Creates the error for an option that none of the devices in use has.

    Args:
        name: Name of the option.
        devices: Names of the devices in use.
    """
    others = devices_with_option(name)
    return InputError(
        "this option belongs to another device",
        where="--" + name.replace("_", "-"),
        got=f"--device {' and '.join(devices)}",
        expected=f"--device {' or '.join(others)}" if others else None,
    )


def given_device_options(options: Any) -> dict[str, Any]:
    """Returns the device options, among a command's options, whose values are not the defaults.

    Args:
        options: Object of a dataclass. It may inherit options of built-in devices, and those of the
            device in its field `device`.
    """
    entries = list(DEVICES.values())
    if (named := find_device(getattr(options, "device", "") or "")) is not None:
        entries.append(named.entry)
    names = {f.name for entry in entries for f in fields(entry.on_command_line)}
    return {
        each.name: getattr(options, each.name)
        for each in fields(options)
        if each.name in names and getattr(options, each.name) != each.default
    }


def unknown_device(device: str, option: str = "--device") -> InputError:
    """Creates the error for an unknown device or file; it suggests the nearest device name."""
    return unknown_name(
        "no such device or file",
        device,
        [*DEVICES, *offered_devices()],
        where=option,
        others=f"{_OWN_DEVICE}, or a file",
        remedy="`sandbox touches formats` lists the files that play as devices",
    )


def built_in(device: str) -> DeviceEntry[Any] | None:
    """Returns the entry of `NAME` or `NAME:ARGUMENT`; None if it is no built-in device."""
    name, colon, _ = device.partition(":")
    entry = DEVICES.get(name)
    return entry if entry and (entry.argument or not colon) else None


def offered_devices() -> tuple[str, ...]:
    """Returns the names of devices offered by installed packages, without importing them."""
    return tuple(DEVICE_PLUGINS.offered())


def touch_devices() -> list[str]:
    """Returns the names of built-in devices that need no scene, for `sandbox touches`."""
    return [name for name, entry in DEVICES.items() if not entry.kind.in_scene]


def kind_of(device: str) -> DeviceKind:
    """Returns the kind of a device, by name or by its file's content; the default if unknown."""
    named = find_device(device)
    return DeviceKind() if named is None else named.entry.kind


def is_in_air(device: str) -> bool:
    """True if a device tracks hands in the air: a Leap, a camera, a headset, or a file of these."""
    return kind_of(device).in_air


def _seen_in(path: Path) -> Sees:
    """Returns the kind of input that a file has, by its content."""
    if not path.is_file():
        return Sees.TOUCHES
    state = path.stat()
    return _sees(path, state.st_mtime_ns, state.st_size)


@lru_cache(maxsize=16)
def _sees(path: Path, changed: int, size: int) -> Sees:
    # Imported here, since only files need readers.
    from sandbox.devices.leap.leap_file import is_leap_recording
    from sandbox.devices.webcam.landmarks import is_landmark_file

    if is_landmark_file(path):
        return Sees.CAMERA
    leap = path.suffix in _LEAP_SUFFIXES or is_leap_recording(path)
    return Sees.LEAP if leap else Sees.TOUCHES


@dataclass(frozen=True)
class DeviceSettings:
    """A device's name and options."""

    name: str = "simulated"
    """Name of a built-in device (`DEVICES`), name or `FILE.py:CLASS` of a user's own device, or
    path of a file that is played."""

    options: Any = field(default_factory=SimulatedOptions)
    """Options of the device, of the class in its entry."""

    @classmethod
    def of(cls, name: str, given: Mapping[str, Any] | None = None) -> DeviceSettings:
        """Creates the settings of a device from its name.

        Args:
            name: As in the field `name`.
            given: Values of options by name, as on the command line; options of other devices are
                ignored.
        """
        values = dict(given or {})
        kind = device_options(name)
        named = find_device(name)
        if named is not None:
            options = options_among(named.entry, values)
            if kind is named.entry.options:
                for each in fields(kind):
                    if hasattr(options, each.name):
                        values[each.name] = getattr(options, each.name)
            else:
                values["own"] = msgspec.to_builtins(options)
        known = {each.name for each in fields(kind)}
        return cls(name, kind(**{k: v for k, v in values.items() if k in known}))

    @property
    def user(self) -> UserConfiguration | None:
        """The simulated user who drives the device, or drove the recording; None for a person."""
        user: UserConfiguration | None = getattr(self.options, "user", None)
        return user

    def open(self, place: Place) -> AnyDevice:
        """Opens the device.

        Args:
            place: Surface, person and task; the argument of the name is added.

        Raises:
            InputError: There is no such device, or it cannot be opened.
        """
        entry, argument = named_device(self.name)
        return entry.open(self.options, replace(place, argument=argument))

    def check(self) -> None:
        """Checks the settings, such as the file, before anything is built.

        Raises:
            InputError: The device cannot be opened.
        """
        entry, argument = named_device(self.name)
        entry.check(self.options, argument)

    def decoded(self) -> DeviceSettings:
        """Returns the settings with options decoded from JSON to the named device's class.

        Missing options get their defaults: an anonymous copy of a recording lacks the addresses,
        on which a replay does not depend.

        Raises:
            RecordingError: The device has no such option, or a value has the wrong type.
        """
        kind = device_options(self.name)
        if isinstance(self.options, kind):
            return self
        where = f"settings.device {self.name}"
        values = self.options if isinstance(self.options, Mapping) else {}
        known = [each.name for each in fields(kind)]
        for option in values:
            if option not in known:
                what = "this device has no such option"
                raise unknown_name(what, option, known, where=where, kind=RecordingError)
        try:
            return replace(self, options=msgspec.convert(values, kind))
        except (msgspec.ValidationError, InputError) as error:
            raise RecordingError(
                "an option of the device cannot be read", where=where, got=str(error)
            ) from None


def device_options(device: str) -> type[Any]:
    """Returns the class of a device's options in settings, without importing the device itself.

    Args:
        device: Name of a device, as in `DeviceSettings.name`.
    """
    entry = built_in(device)
    # A recording must be readable even if the file or user's code that it names is missing.
    options: type[Any] = PlayedOptions if entry is None else entry.options
    return options
