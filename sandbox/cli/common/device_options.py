"""Adds the options of the devices that the command line names to the options of the command."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any, TypeVar, cast, get_type_hints

from rich.console import Console

from models.errors import DeviceError
from sandbox.cli.common.command_line import flat
from sandbox.devices.registry import DEVICES, find_device
from sandbox.trial.trial_options import device_heading

T = TypeVar("T")

_NAMING = ("--device", "--second-device")
"""Options whose values are devices."""


def named_options(options: type[Any], argv: Sequence[str]) -> dict[type[Any], str]:
    """Returns option classes and headings of the devices named on the command line.

    Args:
        options: Dataclass of the command's options; its default device is used if the command line
            names no device.
        argv: Words of the command line.

    Raises:
        DeviceError: The code of a user's own device cannot be used.
    """
    devices = []
    for word, after in zip(argv, [*argv, ""][1:], strict=True):
        option, equals, value = word.partition("=")
        if option in _NAMING:
            devices.append(value if equals else after)
    found: dict[type[Any], str] = {}
    for device in devices or [options.device]:
        # The command itself refuses unknown devices later.
        if (named := find_device(device)) is None:
            continue
        shown = named.entry.on_command_line
        if fields(shown):
            found.setdefault(shown, _heading(shown, device))
    return found


def with_options(options: type[T], of_devices: Mapping[type[Any], str]) -> type[T]:
    """Returns the command's option class, extended by the options of devices.

    Args:
        options: Dataclass of the command's options.
        of_devices: Option classes of devices, with their headings.

    Raises:
        DeviceError: An option of a device has the name of another option.
    """
    if not of_devices:
        return options
    own = {each.name for each in fields(cast(Any, options))}
    for kind, heading in of_devices.items():
        # Command and device may inherit options from the same class, such as `UnitOptions`.
        shared = [base for base in kind.__mro__ if is_dataclass(base) and issubclass(options, base)]
        same = {each.name for base in shared for each in fields(base)}
        if both := own & {each.name for each in fields(kind)} - same:
            raise DeviceError(
                "an option of the device has the name of another option",
                where=heading,
                got=", ".join("--" + name.replace("_", "-") for name in sorted(both)),
                remedy="Give it another name",
            )
    # Leave out classes that another class in the list already inherits.
    bases = [
        kind
        for kind in of_devices
        if not any(issubclass(other, kind) and other is not kind for other in of_devices)
    ]
    about = {"__doc__": options.__doc__, "__module__": options.__module__}
    extended = type(options.__name__, (*bases, options), about)
    return cast(type[T], dataclass(frozen=True, kw_only=True)(extended))


def taking_device_options(command: Callable[..., int], argv: Sequence[str]) -> Callable[..., int]:
    """Returns the subcommand with the options of the device named on its command line added.

    Args:
        command: Function with one argument, an options object whose class has a field `device`.
        argv: Words of the command line.

    Raises:
        DeviceError: The code of a user's own device cannot be used, or one of its options has the
            name of another option.
    """
    ((name, kind),) = (
        (name, kind) for name, kind in get_type_hints(command).items() if name != "return"
    )
    more = {
        shown: heading
        for shown, heading in named_options(kind, argv).items()
        if not issubclass(kind, shown)
    }
    if not more:
        return command
    extended = flat(with_options(kind, more), more)

    def extended_command(options: Any) -> int:
        return command(options)

    extended_command.__name__, extended_command.__doc__ = command.__name__, command.__doc__
    extended_command.__defaults__ = (extended(),) if command.__defaults__ else None
    extended_command.__annotations__ = {name: extended, "return": int}
    return extended_command


def show_hidden_devices(shown: Iterable[str]) -> None:
    """Prints, for each device that is not on the command line, the command that shows its options.

    Args:
        shown: Headings of the devices whose options have been shown.
    """
    others: dict[str, str] = {}
    for device, entry in DEVICES.items():
        if fields(entry.on_command_line):
            others.setdefault(_heading(entry.on_command_line, device), device)
    for heading, device in others.items():
        if heading not in shown:
            title = device_heading(heading).name
            Console().print(f"{title}: `--device {device} --help` shows its options")


def _heading(options: type[Any], device: str) -> str:
    """Returns the heading of a device: its folder in `sandbox.devices`, or a user device's name."""
    folder, _, last = options.__module__.rpartition(".")
    return last if folder == "sandbox.devices" else device
