"""Measures when touches arrive, take effect and are drawn in the window.

A measurement begins when this program receives a touch and ends when a picture is handed to the
screen. It excludes the delays of the touch screen and of the display.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Sequence

from models.frames import TouchFrame
from sandbox.devices.device import Device
from sandbox.devices.wrappers.device_wrapper import DeviceWrapper
from sandbox.session.latency import LatencyLog
from sandbox.session.messages import Snapshot
from sandbox.trial.device_makers import DeviceMaker

WAITING = 4096
"""Largest number of touches that wait for their picture; beyond it the oldest are dropped."""


class Timing:
    """Follows touches from a device through the session into a window.

    Args:
        log: Receives `waited`, `stepped` and `window` (see `LatencyLog`).
    """

    def __init__(self, log: LatencyLog) -> None:
        self._log = log
        self._lock = threading.Lock()
        self._taken: list[float] = []
        self._polled, self._newest = 0.0, 0.0
        self._unseen: deque[tuple[int, float]] = deque(maxlen=WAITING)

    def taken_in(self, frames: Sequence[TouchFrame], origin: float) -> None:
        """Notes that the session fetched frames, whose clock began at `origin` (s, monotonic)."""
        self._polled = time.monotonic()
        # A frame repeated for a lift control keeps its time, and contains no new touch.
        arrived = [t for t in (frame.time + origin for frame in frames) if t > self._newest]
        self._newest = max([self._newest, *arrived])
        for at in arrived:
            self._log.take_in(at, self._polled)
        self._taken += arrived

    def stepped(self, snapshot: Snapshot) -> None:
        """Notes the end of the step in which they took effect; called in the session's thread."""
        if not self._taken:
            return
        self._log.add("stepped", 1000.0 * (time.monotonic() - self._polled))
        with self._lock:
            self._unseen.extend((snapshot.step, arrived) for arrived in self._taken)
        self._taken = []

    def drawn(self, snapshot: Snapshot) -> None:
        """Notes that a picture of this snapshot has just been handed to the screen."""
        now = time.monotonic()
        with self._lock:
            while self._unseen and self._unseen[0][0] <= snapshot.step:
                self._log.add("window", 1000.0 * (now - self._unseen.popleft()[1]))


class TimedDevice(DeviceWrapper):
    """Wrapper that reports when a live device's touches are fetched.

    Args:
        device: A device whose frames carry their time of arrival, s, on its own clock. Of one whose
            frames carry session time nothing is reported.
        timing: Receives the reports.
    """

    def __init__(self, device: Device, timing: Timing) -> None:
        super().__init__(device)
        self._timing = timing
        self._origin = device.clock_origin

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The device's frames, unchanged."""
        frames = self.device.poll(now)
        if frames and self._origin is not None:
            self._timing.taken_in(frames, self._origin)
        return frames


def timed(make_device: DeviceMaker, timing: Timing) -> DeviceMaker:
    """A maker of the same device in a `TimedDevice`."""
    return lambda task, surface: TimedDevice(make_device(task, surface), timing)
