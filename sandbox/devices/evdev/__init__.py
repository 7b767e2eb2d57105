"""Touch screens and trackpads of this Linux machine."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from models.surface import Surface
from sandbox.devices.device import DeviceEntry, DeviceKind, Place

if TYPE_CHECKING:
    from sandbox.devices.evdev.evdev_device import EvdevDevice


@dataclass(frozen=True, kw_only=True)
class EvdevOptions:
    """Options of a touch screen or trackpad of this Linux machine."""

    grab: bool = False
    """Hide the touches from the desktop, so that a trackpad does not move the pointer."""

    turned: Literal[0, 90, 180, 270] | None = None
    """Degrees clockwise by which the panel is mounted. Default: the value in udev
    (LIBINPUT_CALIBRATION_MATRIX)."""


def _open(options: EvdevOptions, place: Place) -> EvdevDevice:
    from sandbox.devices.evdev.evdev_device import EvdevDevice, open_node

    node = open_node(place.argument, options.grab, options.turned)
    return EvdevDevice(node, place.surface)


def _surface(options: EvdevOptions, argument: str) -> Surface | None:
    from sandbox.devices.evdev.evdev_device import evdev_surface, open_node

    node = open_node(argument, turned=options.turned)
    try:
        return evdev_surface(node)
    finally:
        node.close()


DEVICE = DeviceEntry(
    "a touch screen or trackpad of this Linux machine",
    _open,
    EvdevOptions,
    DeviceKind(guessed_size=True),
    argument="NODE",
    surface=_surface,
)
