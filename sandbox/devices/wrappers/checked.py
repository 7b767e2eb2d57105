"""Checks of frames from devices that were written elsewhere."""

from __future__ import annotations

from collections.abc import Sequence

from models.arithmetic.products import length
from models.errors import DeviceError
from models.frames import TouchFrame
from models.surface import Surface
from sandbox.devices.wrappers.device_wrapper import DeviceWrapper
from sandbox.session.device import Device


class CheckedDevice(DeviceWrapper):
    """Refuses what a device of somebody else's cannot have meant, with one clear error.

    `poll` must return frames, and contacts must be on the surface or near it: a contact that is
    further beyond the border than the surface's diagonal is in another unit than metres.

    Args:
        device: The device.
        surface: The touch surface.
        where: Place of its code, for error messages.
    """

    def __init__(self, device: Device, surface: Surface, where: str) -> None:
        super().__init__(device)
        self._size, self._where = surface.size, where

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The wrapped device's frames.

        Raises:
            DeviceError: They are not frames, or a contact is far off the surface.
        """
        frames = self.device.poll(now)
        if not isinstance(frames, Sequence) or not all(isinstance(f, TouchFrame) for f in frames):
            raise DeviceError(
                "`poll` returned something else than frames",
                where=self._where,
                got=repr(frames)[:60],
                expected="a list of TouchFrame, empty if there is nothing new",
            )
        width, height = self._size
        far = length(self._size)
        for frame in frames:
            for contact in frame.contacts:
                x, y = contact.x, contact.y
                if max(-x, x - width, -y, y - height) > far:
                    raise DeviceError(
                        "a contact is far off the surface",
                        where=self._where,
                        got=f"({x:g}, {y:g}) m",
                        expected=f"metres, on a surface of {width:g} x {height:g} m",
                    )
        return frames
