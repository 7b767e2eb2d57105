"""A person's time begins with their first touch: before, they look at the scene."""

from __future__ import annotations

from collections.abc import Sequence

from models.frames import TouchFrame
from sandbox.devices.wrappers.device_wrapper import DeviceWrapper
from sandbox.session.device import Device


class FirstTouch(DeviceWrapper):
    """A device that can be asked whether anybody has touched it, while its session stands still.

    What comes before the first touch is forgotten; the frame of the first touch is the first one
    that the session gets.

    Args:
        device: Of a person.
    """

    def __init__(self, device: Device) -> None:
        super().__init__(device)
        self._kept: list[TouchFrame] = []
        self._came = False

    def came(self) -> bool:
        """Whether anybody has touched it. Not to be asked while the session runs, unless it did."""
        if not self._came and not self.device.finished:
            frames = list(self.device.poll(0.0))
            touched = [n for n, frame in enumerate(frames) if frame.contacts]
            if touched:
                self._kept = frames[touched[0] :]
                self._came = True
        return self._came or self.device.finished

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The device's frames, with the first touch."""
        kept, self._kept, self._came = self._kept, [], True
        return [*kept, *self.device.poll(now)]
