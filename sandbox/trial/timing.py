"""When touches arrive, take effect, and are seen in the window: measured around a session.

What is measured begins when this program hears of a touch and ends when a picture is handed to the
screen. What the touch screen needs before, and the display after, is in none of it.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Sequence

from models.frames import TouchFrame
from sandbox.devices.wrappers.device_wrapper import DeviceWrapper
from sandbox.session.device import Device
from sandbox.session.latency import LatencyLog
from sandbox.session.messages import Snapshot
from sandbox.trial.device_makers import DeviceMaker

WAITING = 4096
"""Touches that may wait for a picture that shows them; of more, the oldest go."""


class Timing:
    """Follows touches from a device through the session into a window.

    Args:
        log: Gets `waited`, `stepped` and `window` (see `LatencyLog`).
    """

    def __init__(self, log: LatencyLog) -> None:
        self._log = log
        self._lock = threading.Lock()
        self._taken: list[float] = []
        self._polled, self._newest = 0.0, 0.0
        self._unseen: deque[tuple[int, float]] = deque(maxlen=WAITING)

    def taken_in(self, frames: Sequence[TouchFrame], origin: float) -> None:
        """The session has fetched frames, whose clock began at `origin` (s, monotonic)."""
        self._polled = time.monotonic()
        # A frame that a lift control repeats has the time of the touches in it: no touch is new.
        arrived = [t for t in (frame.time + origin for frame in frames) if t > self._newest]
        self._newest = max([self._newest, *arrived])
        for at in arrived:
            self._log.add("waited", 1000.0 * (self._polled - at))
        self._taken += arrived

    def stepped(self, snapshot: Snapshot) -> None:
        """The step that they took effect in is over; called in the session's thread."""
        if not self._taken:
            return
        self._log.add("stepped", 1000.0 * (time.monotonic() - self._polled))
        with self._lock:
            self._unseen.extend((snapshot.step, arrived) for arrived in self._taken)
        self._taken = []

    def drawn(self, snapshot: Snapshot) -> None:
        """A picture of this moment has just been handed to the screen."""
        now = time.monotonic()
        with self._lock:
            while self._unseen and self._unseen[0][0] <= snapshot.step:
                self._log.add("window", 1000.0 * (now - self._unseen.popleft()[1]))


class TimedDevice(DeviceWrapper):
    """A live device whose touches are followed.

    Args:
        device: Its frames carry the time at which they came in, s, by its own clock.
        timing: Is told.
    """

    def __init__(self, device: Device, timing: Timing) -> None:
        super().__init__(device)
        self._timing = timing
        # A device that counts from its own beginning says when that was.
        self._origin = device.clock_origin

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The device's frames as they are."""
        frames = self.device.poll(now)
        if frames:
            self._timing.taken_in(frames, self._origin)
        return frames


def timed(make_device: DeviceMaker, timing: Timing) -> DeviceMaker:
    """Opens the same device with its touches followed."""
    return lambda task, surface: TimedDevice(make_device(task, surface), timing)
