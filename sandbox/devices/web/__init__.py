"""The page in a browser, on this machine or a tablet; its server is `sandbox.server`."""

from __future__ import annotations

from sandbox.devices.device import AnyDevice, DeviceEntry, DeviceKind, NoOptions, Place


def _open(options: NoOptions, place: Place) -> AnyDevice:
    from sandbox.server.web import WebDevice

    return WebDevice(place.surface)


DEVICE = DeviceEntry(
    "the program's page in a browser, on this machine or a tablet: fingers, or a mouse",
    _open,
    NoOptions,
    DeviceKind(one_hand=True),
)
