"""Devices by name: built-in ones, those of installed packages, and those in a file.

A class is imported when its device is opened, and is called with the touch surface and the argument
(docs/write-a-device.md). Devices with their own command-line options are opened by
`sandbox.options` instead.

A package offers its devices under a name:

    [project.entry-points."hand_sandbox.devices"]
    my-lab-pad = "my_lab.pad:Pad"

and `--device my-lab-pad` or `--device my-lab-pad:ARGUMENT` opens it. An error in it is reported
only then.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from inspect import signature
from typing import Any

from models.errors import DeviceError
from models.plugins import PluginKind, imported
from models.surface import Surface
from sandbox.devices.device import AnyDevice, Device

DEVICE_PLUGINS: PluginKind[Any] = PluginKind(
    "device", "hand_sandbox.devices", DeviceError, takes_argument=True, verb="opened"
)

OWN_DEVICE = "FILE.py:CLASS[:ARGUMENT]"
"""Form of a device in a file, for error messages."""

OpenDevice = Callable[[Surface], Device]


@dataclass(frozen=True)
class DeviceEntry:
    """A built-in device.

    Attributes:
        place: `MODULE:CLASS`; `sandbox` alone prints the first sentence of the class's docstring.
        live: A person or another program drives it, so that a session runs at real time.
        in_air: It produces hand frames or landmark frames; otherwise touch frames.
        camera: It produces landmark frames.
        headset: It is a headset, which sees hands and shows the scene.
        simulated: A simulated user drives it.
        in_scene: It needs a scene: a window, objects to see, or a hand. Otherwise `sandbox touches`
            accepts it too.
        one_hand: It serves one hand; a task for two hands needs a second device.
        guessed_size: It does not report the size of its surface, which is a guess without
            --surface.
        argument: It can also be opened as `NAME:ARGUMENT`.
        options: `MODULE:CLASS` of its options.
        maker: `MODULE:FUNCTION` that returns a maker (`sandbox.trial.device_makers`) for settings
            and the index of a hand; empty for a device that its surface suffices for.
    """

    place: str
    live: bool = True
    in_air: bool = False
    camera: bool = False
    headset: bool = False
    simulated: bool = False
    in_scene: bool = False
    one_hand: bool = False
    guessed_size: bool = False
    argument: bool = True
    options: str = "sandbox.devices.options:NoOptions"
    maker: str = ""


DEVICES: dict[str, DeviceEntry] = {
    "mouse": DeviceEntry(
        "sandbox.devices.mouse:MouseDevice",
        in_scene=True,
        one_hand=True,
        argument=False,
        maker="sandbox.devices.mouse:mouse_maker",
    ),
    "web": DeviceEntry(
        "sandbox.server.web:WebDevice",
        one_hand=True,
        argument=False,
        maker="sandbox.server.web:web_maker",
    ),
    "tuio": DeviceEntry(
        "sandbox.devices.tuio.tuio:TuioDevice",
        guessed_size=True,
        argument=False,
        options="sandbox.devices.tuio.options:TuioOptions",
    ),
    "evdev": DeviceEntry(
        "sandbox.devices.evdev.evdev_device:EvdevDevice",
        guessed_size=True,
        options="sandbox.devices.evdev.options:EvdevOptions",
    ),
    "leap": DeviceEntry(
        "sandbox.devices.leap.leap:LeapDevice",
        in_air=True,
        in_scene=True,
        argument=False,
        options="sandbox.devices.leap.options:LeapOptions",
        maker="sandbox.devices.leap.leap_maker:leap_maker",
    ),
    "webcam": DeviceEntry(
        "sandbox.devices.webcam.webcam:WebcamDevice",
        in_air=True,
        camera=True,
        in_scene=True,
        argument=False,
        options="sandbox.devices.webcam.options:WebcamOptions",
        maker="sandbox.devices.webcam.webcam_maker:webcam_maker",
    ),
    "webxr": DeviceEntry(
        "sandbox.devices.webxr.webxr:HeadsetDevice",
        in_air=True,
        headset=True,
        in_scene=True,
        argument=False,
        maker="sandbox.devices.webxr.headset_maker:headset_maker",
    ),
    "simulated": DeviceEntry(
        "sandbox.devices.simulated.simulated:SimulatedDevice",
        live=False,
        simulated=True,
        in_scene=True,
        one_hand=True,
        argument=False,
        options="sandbox.devices.simulated.options:SimulatedOptions",
        maker="sandbox.devices.simulated.maker:simulated_maker",
    ),
    "webxr-simulated": DeviceEntry(
        "sandbox.devices.simulated.headset_user:SimulatedHeadset",
        live=False,
        in_air=True,
        headset=True,
        simulated=True,
        in_scene=True,
        argument=False,
        options="sandbox.devices.simulated.options:InAirOptions",
        maker="sandbox.devices.webxr.headset_maker:simulated_headset_maker",
    ),
    "leap-simulated": DeviceEntry(
        "sandbox.devices.simulated.leap_user:SimulatedLeap",
        live=False,
        in_air=True,
        simulated=True,
        in_scene=True,
        options="sandbox.devices.simulated.options:InAirOptions",
        maker="sandbox.devices.leap.leap_maker:leap_maker",
    ),
}
"""Built-in devices by name. To add one, write its module and add an entry here."""


_PLAYED = "sandbox.devices.options:PlayedOptions"
"""Options of files and of somebody's own devices."""


def built_in(device: str) -> DeviceEntry | None:
    """The entry of `NAME` or `NAME:ARGUMENT`; None if that is not a built-in device."""
    name, colon, _ = device.partition(":")
    entry = DEVICES.get(name)
    return entry if entry and (entry.argument or not colon) else None


def device_options(device: str) -> type[Any]:
    """The class of a device's options; it alone is imported, and not the device.

    Args:
        device: `NAME[:ARGUMENT]`, built in; or a file, or the place of somebody's own device.
    """
    entry = built_in(device)
    options: type[Any] = imported(entry.options if entry else _PLAYED)
    return options


def open_built_in(device: str, surface: Surface) -> AnyDevice:
    """Opens the built-in device `NAME[:ARGUMENT]` with a surface and the argument."""
    name, _, argument = device.partition(":")
    opened: AnyDevice = imported(DEVICES[name].place)(surface, argument)
    return opened


def open_by_name(device: str) -> OpenDevice | None:
    """A function that opens a touch device by name or place; None if there is none.

    Args:
        device: `NAME[:ARGUMENT]`, built in or offered by an installed package, or
            `FILE.py:CLASS[:ARGUMENT]` or `MODULE:CLASS[:ARGUMENT]`.

    Raises:
        DeviceError: The device exists, but cannot be used.
    """
    if built_in(device) is None:
        return find_device(device)
    from sandbox.devices.wrappers.adapted import adapted

    return lambda surface: adapted(open_built_in(device, surface), device)


def offered_devices() -> tuple[str, ...]:
    """Names of the devices that installed packages offer; loads none of them."""
    return tuple(DEVICE_PLUGINS.offered())


def find_device(text: str) -> OpenDevice | None:
    """A function that opens an external device; None if the text does not name one.

    Args:
        text: `NAME[:ARGUMENT]` of an installed package, `FILE.py:CLASS[:ARGUMENT]` or
            `MODULE:CLASS[:ARGUMENT]`.

    Raises:
        DeviceError: The device exists, but cannot be used.
    """
    plugin = DEVICE_PLUGINS.find(text)
    if plugin is None:
        return None
    device_class, where, argument = plugin
    if not callable(device_class):
        raise DeviceError("this is not a device", where=where, got=repr(device_class)[:80])
    from sandbox.devices.wrappers.adapted import adapted
    from sandbox.devices.wrappers.guarded import GuardedDevice

    def open_it(surface: Surface) -> Device:
        if mismatch := _mismatch(device_class, surface, argument):
            raise DeviceError(
                "this device cannot be opened with a surface and a text",
                where=where,
                got=mismatch,
                expected="`__init__(self, surface, argument)`",
            )
        with DEVICE_PLUGINS.guarded(where):
            device = device_class(surface, argument)
        return GuardedDevice(adapted(device, where), surface, where)

    return open_it


def _mismatch(device_class: Any, *given: object) -> str:
    """Why a class does not take some arguments; empty if it does, or has no signature."""
    try:
        signature(device_class).bind(*given)
    except TypeError as error:
        return str(error)
    except ValueError:
        return ""
    return ""
