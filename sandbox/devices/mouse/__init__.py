"""The mouse in the window."""

from __future__ import annotations

from sandbox.devices.device import AnyDevice, DeviceEntry, DeviceKind, NoOptions, Place


def _open(options: NoOptions, place: Place) -> AnyDevice:
    from sandbox.devices.mouse.mouse import MouseDevice

    return MouseDevice(place.surface, place.person)


DEVICE = DeviceEntry(
    "the mouse in the window, as one finger or a whole hand",
    _open,
    NoOptions,
    DeviceKind(labels=True, in_scene=True, one_hand=True),
)
