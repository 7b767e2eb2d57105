"""Devices that were written without our base class, completed with the defaults of the contract."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from typing import Any

from models.errors import DeviceError
from models.frames import TouchFrame
from sandbox.devices.device import Device

_METHODS = ("poll", "close")
_COPIED = (
    "name",
    "lift",
    "show",
    "mode_requests",
    "wait",
    "address",
    "title",
    "plays_file",
    "latency",
)
"""Members whose values are copied when a device is adapted; see `sandbox.devices.device`. The other
members are read on every access, because they may change."""


class AdaptedDevice(Device):
    """Adapter for a touch device that was written without the base class `Device`.

    The device needs `name`, `poll`, `finished` and `close`; missing members have their defaults.

    Args:
        device: The external device.
    """

    name: str

    def __init__(self, device: Any) -> None:
        self._device = device
        for member in _COPIED:
            if hasattr(device, member):
                setattr(self, member, getattr(device, member))

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The device's frames."""
        frames: Sequence[TouchFrame] = self._device.poll(now)
        return frames

    @property
    def finished(self) -> bool:
        """The device's."""
        return bool(self._device.finished)

    def close(self) -> None:
        """Closes the device."""
        self._device.close()

    @property
    def notices(self) -> Sequence[str]:
        """The device's; empty if it has none."""
        return tuple(getattr(self._device, "notices", ()))

    @property
    def wants_snapshots(self) -> bool:
        """True if the device has `show`."""
        return hasattr(self._device, "show")

    @property
    def damage(self) -> Exception | None:
        """The device's, which may find it out as it plays; None if it has none."""
        damage: Exception | None = getattr(self._device, "damage", None)
        return damage

    @property
    def clock_origin(self) -> float | None:
        """The device's, which may know it from its first frame on; 0 if it has none."""
        origin: float | None = getattr(self._device, "clock_origin", 0.0)
        return origin

    @property
    def true_labels(self) -> Mapping[int, int]:
        """The device's, which may come to know it with the touches; empty if it has none."""
        true_labels: Mapping[int, int] = getattr(self._device, "true_labels", {})
        return true_labels

    @property
    def frame_ready(self) -> threading.Event | None:
        """The device's; setting it gives the device another event."""
        frame_ready: threading.Event | None = getattr(self._device, "frame_ready", None)
        return frame_ready

    @frame_ready.setter
    def frame_ready(self, frame_ready: threading.Event | None) -> None:
        self._device.frame_ready = frame_ready


def adapted(device: Any, where: str) -> Device:
    """The device with all members of the contract, in an adapter if necessary.

    Args:
        device: Object that external code returned as a device.
        where: Place of that code, for error messages.

    Raises:
        DeviceError: A required member is missing.
    """
    if isinstance(device, Device):
        return device
    missing = [part for part in _METHODS if not callable(getattr(device, part, None))]
    missing += [part for part in ("name", "finished") if not hasattr(device, part)]
    if missing:
        raise DeviceError(
            "the object is not a device",
            where=where,
            got=f"without {', '.join(missing)}",
            expected="name, poll, finished and close",
            remedy="docs/write-a-device.md shows a device of 30 lines",
        )
    return AdaptedDevice(device)
