"""Errors of devices that were written elsewhere, in one line."""

from __future__ import annotations

from collections.abc import Sequence

from models.arithmetic.products import length
from models.errors import DeviceError
from models.frames import Contact, TouchFrame
from models.plugins import failure
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.wrappers.device_wrapper import DeviceWrapper


class GuardedDevice(DeviceWrapper):
    """Converts whatever goes wrong in the `poll` of somebody's device to one clear error.

    What frames may hold, they check themselves when they are made (`models.frames`). Contacts in
    another unit than metres are refused here, since a session would show nothing. All other rules
    for devices are those of `check_device`, which its author runs.

    Args:
        device: The device.
        surface: The touch surface.
        where: Place of its code.
    """

    def __init__(self, device: Device, surface: Surface, where: str) -> None:
        super().__init__(device)
        self._surface, self._where = surface, where

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The wrapped device's frames.

        Raises:
            DeviceError: The device fails, returns something else than touch frames, or a contact is
                far off the surface.
        """
        try:
            frames = self.device.poll(now)
            sound = all(isinstance(frame, TouchFrame) for frame in frames)
        except DeviceError:
            raise
        except (Exception, SystemExit) as error:
            raise DeviceError(
                "`poll` of this device fails", where=self._where, got=failure(error)
            ) from error
        if not sound:
            raise DeviceError(
                "`poll` returned something else than frames",
                where=self._where,
                got=repr(frames)[:60],
                expected="a list of TouchFrame, empty if there is nothing new",
            )
        for frame in frames:
            for contact in frame.contacts:
                if is_far_off(contact, self._surface):
                    raise far_off(contact, self._surface, self._where)
        return frames


def is_far_off(contact: Contact, surface: Surface) -> bool:
    """True for a contact further beyond the border than the surface's diagonal."""
    width, height = surface.size
    x, y = contact.x, contact.y
    return bool(max(-x, x - width, -y, y - height) > length(surface.size))


def far_off(contact: Contact, surface: Surface, where: str) -> DeviceError:
    """The error for a contact that must be in another unit than metres."""
    width, height = surface.size
    return DeviceError(
        "a contact is far off the surface",
        where=where,
        got=f"({contact.x:g}, {contact.y:g}) m",
        expected=f"metres, on a surface of {width:g} x {height:g} m",
    )
