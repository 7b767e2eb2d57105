"""Errors of devices that were written elsewhere, in one line."""

from __future__ import annotations

from collections.abc import Sequence

from models.errors import DeviceError
from models.frames import TouchFrame
from models.plugins import failure
from sandbox.devices.wrappers.device_wrapper import DeviceWrapper
from sandbox.session.device import Device


class GuardedDevice(DeviceWrapper):
    """Converts whatever goes wrong in the `poll` of somebody's device to one clear error.

    What frames may hold, they check themselves when they are made (`models.frames`). All other
    rules for devices are those of `check_device`, which its author runs.

    Args:
        device: The device.
        where: Place of its code.
    """

    def __init__(self, device: Device, where: str) -> None:
        super().__init__(device)
        self._where = where

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The wrapped device's frames.

        Raises:
            DeviceError: The device fails, or returns something else than touch frames.
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
        return frames
