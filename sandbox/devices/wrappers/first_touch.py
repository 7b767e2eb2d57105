"""Start of a trial with the person's first touch, so that they can look at the scene before it."""

from __future__ import annotations

from collections.abc import Sequence

from models.frames import TouchFrame
from sandbox.devices.device import Device, DeviceWrapper


class FirstTouch(DeviceWrapper):
    """Wrapper that waits for the first touch while the session is paused.

    Frames before the first touch are dropped; the frame of the first touch is the first one that
    the session receives.

    Args:
        device: Device of a person.
    """

    def __init__(self, device: Device) -> None:
        super().__init__(device)
        self._kept: list[TouchFrame] = []
        self._came = False

    def came(self) -> bool:
        """True after the first touch. Until then it polls the device, so the session must not."""
        if not self._came and not self.device.finished:
            frames = list(super().poll(0.0))
            touched = [n for n, frame in enumerate(frames) if frame.contacts]
            if touched:
                self._kept = frames[touched[0] :]
                self._came = True
        return self._came or self.device.finished

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The device's frames, from that of the first touch on."""
        kept, self._kept, self._came = self._kept, [], True
        return [*kept, *super().poll(now)]
