"""Placeholders for option values in `--help`, made from the registry of devices."""

from __future__ import annotations

from collections.abc import Callable, Collection

from sandbox.devices.registry import DEVICES, DeviceEntry


def choices(*names: str) -> str:
    """Returns `{A,B,...}`."""
    return "{" + ",".join(names) + "}"


def device_choices(
    *others: str,
    accepts: Callable[[DeviceEntry], bool] = lambda entry: True,
    without: Collection[str] = (),
) -> str:
    """Returns the built-in devices that a command takes, followed by other values.

    Args:
        others: Values after the devices' names; `FILE` if there are none.
        accepts: Selects devices by their registry entry.
        without: Names of devices that the command does not take for other reasons.
    """
    names = [n for n, entry in DEVICES.items() if accepts(entry) and n not in without]
    return choices(*names, *(others or ("FILE",)))


TOUCH_DEVICE_CHOICES = device_choices("FILE", "...", accepts=lambda entry: not entry.in_scene)
"""Values of `--device` for commands that need touches and no scene."""
