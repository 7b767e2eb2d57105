"""A device around another one, which has all that the other one has."""

from __future__ import annotations

from typing import Any

from sandbox.session.device import Device


class Around:
    """What a device around another one need not write: whatever it does not have itself (an
    address, `news`, a user, ...) is found in the device within.

    Args:
        device: Within.

    Attributes:
        device: As given.
        name: Of the device.
    """

    def __init__(self, device: Device) -> None:
        self.device, self.name = device, device.name

    @property
    def finished(self) -> bool:
        """As the device says."""
        return self.device.finished

    def close(self) -> None:
        """Closes the device."""
        self.device.close()

    def __getattr__(self, name: str) -> Any:
        # `copy` and `pickle` ask for parts before there are any.
        if "device" not in vars(self):
            raise AttributeError(name)
        return getattr(self.device, name)
