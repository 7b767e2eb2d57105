"""Two keys as a lift control, for devices without one."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from dataclasses import replace

from models.frames import TouchFrame
from sandbox.devices.device import Device, DeviceWrapper

SPEED = 0.45
"""1/s, share of the whole lift while a key is held."""


class LiftKeys(DeviceWrapper):
    """Wrapper that adds a lift control to a device. Safe to use from two threads.

    Args:
        device: Source of the touches.
        leader: Wrapper whose lift this one copies, as the same keys lift two hands; None for the
            first hand.
    """

    lift = True

    def __init__(self, device: Device, leader: LiftKeys | None = None) -> None:
        super().__init__(device)
        self._leader = leader
        self._lock = threading.Lock()
        self._direction = 0.0
        self._tapped = 0.0
        self._lift = 0.0
        self._now = 0.0
        self._last = TouchFrame(0.0)

    def hold(self, direction: float) -> None:
        """Sets the held key: 1 lifts, -1 lowers, 0 means none."""
        with self._lock:
            self._direction = direction
            # A key that is pressed and released between two polls still has an effect.
            self._tapped = direction or self._tapped

    def follow(self, lift: float) -> None:
        """Takes over the lift of another control, from which the keys continue; makes no frame."""
        with self._lock:
            self._lift = lift

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The device's frames with the lift, or a repeated frame if only the lift changed."""
        with self._lock:
            direction, self._tapped = self._direction or self._tapped, 0.0
        passed, self._now = max(now - self._now, 0.0), now
        before = self._lift
        self._lift = min(max(before + direction * SPEED * passed, 0.0), 1.0)
        if self._leader is not None:
            self._lift = self._leader._lift
        over = self.device.finished
        frames = [replace(frame, lift=self._lift) for frame in super().poll(now)]
        if not frames and self._lift != before and not over:
            frames = [replace(self._last, lift=self._lift, cancelled=frozenset())]
        if frames:
            self._last = frames[-1]
        return frames
