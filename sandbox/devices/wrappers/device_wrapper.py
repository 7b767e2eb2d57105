"""Base class of device wrappers."""

from __future__ import annotations

import threading
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from models.frames import TouchFrame
from sandbox.devices.device import AnyDevice, Device
from sandbox.session.messages import Snapshot

if TYPE_CHECKING:
    from sandbox.trial.latency import LatencyLog


class DeviceWrapper(Device):
    """Base class of touch devices that wrap another one and pass every member through.

    A subclass overrides the members that it changes.

    Args:
        device: The wrapped device.

    Attributes:
        device: As given.
    """

    def __init__(self, device: Device) -> None:
        self.device = device

    @property
    def name(self) -> str:
        """The wrapped device's."""
        return self.device.name

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """The wrapped device's frames."""
        return self.device.poll(now)

    @property
    def finished(self) -> bool:
        """The wrapped device's."""
        return self.device.finished

    def close(self) -> None:
        """Closes the wrapped device."""
        self.device.close()

    @property
    def lift(self) -> bool:
        """The wrapped device's."""
        return self.device.lift

    @property
    def wants_snapshots(self) -> bool:
        """The wrapped device's."""
        return self.device.wants_snapshots

    def show(self, snapshot: Snapshot) -> None:
        """Passes the snapshot to the wrapped device."""
        self.device.show(snapshot)

    @property
    def notices(self) -> Sequence[str]:
        """The wrapped device's."""
        return self.device.notices

    def mode_requests(self, now: float) -> Sequence[str]:
        """The wrapped device's."""
        return self.device.mode_requests(now)

    @property
    def frame_ready(self) -> threading.Event | None:
        """The wrapped device's; setting it gives the wrapped device another event."""
        return self.device.frame_ready

    @frame_ready.setter
    def frame_ready(self, frame_ready: threading.Event | None) -> None:
        self.device.frame_ready = frame_ready

    def wait(self, seconds: float) -> bool:
        """Waits for the wrapped device."""
        return self.device.wait(seconds)

    @property
    def address(self) -> str:
        """The wrapped device's."""
        return self.device.address

    @property
    def title(self) -> str:
        """The wrapped device's."""
        return self.device.title

    @property
    def plays_file(self) -> bool:
        """The wrapped device's."""
        return self.device.plays_file

    @property
    def damage(self) -> Exception | None:
        """The wrapped device's."""
        return self.device.damage

    @property
    def clock_origin(self) -> float | None:
        """The wrapped device's."""
        return self.device.clock_origin

    @property
    def latency(self) -> LatencyLog | None:
        """The wrapped device's."""
        return self.device.latency

    @property
    def true_labels(self) -> Mapping[int, int]:
        """The wrapped device's."""
        return self.device.true_labels

    @property
    def parts(self) -> tuple[AnyDevice, ...]:
        """The wrapped device."""
        return (self.device,)
