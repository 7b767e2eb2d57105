"""A camera shared by two hands: both see every picture, and each looks for its own side."""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from models.frames import LandmarkFrame
from sandbox.devices.device import LandmarkDevice

KEPT = 600
"""Largest number of frames that wait for a hand, as in `sandbox.devices.webcam.webcam`."""


class SharedCamera:
    """Gives the pictures of one device to several hands.

    Args:
        device: The camera, or a recording of one.
        hands: Number of hands.

    Attributes:
        parts: A device for each hand.
    """

    def __init__(self, device: LandmarkDevice, hands: int = 2) -> None:
        self.device = device
        self.parts = tuple(CameraPart(self, i) for i in range(hands))

    def fetch(self, now: float) -> None:
        """Polls the device, and gives its frames to all parts."""
        frames = self.device.poll(now)
        for part in self.parts:
            part.waiting.extend(frames)


class CameraPart(LandmarkDevice):
    """The pictures of a shared camera for one hand.

    Args:
        shared: The shared camera.
        index: Index of the hand in the scene; the first shows the camera's notices.
    """

    name: str
    lift = True

    def __init__(self, shared: SharedCamera, index: int) -> None:
        self._shared, self._first = shared, index == 0
        self.name = shared.device.name
        self.waiting: deque[LandmarkFrame] = deque(maxlen=KEPT)

    @property
    def finished(self) -> bool:
        """True when no further frame can arrive for this hand."""
        return self._shared.device.finished and not self.waiting

    @property
    def address(self) -> str:
        """The camera's."""
        return self._shared.device.address

    @property
    def damage(self) -> Exception | None:
        """The camera's."""
        return self._shared.device.damage

    @property
    def notices(self) -> Sequence[str]:
        """The camera's, once for all hands."""
        return self._shared.device.notices if self._first else ()

    def poll(self, now: float) -> Sequence[LandmarkFrame]:
        """The pictures since the last call."""
        self._shared.fetch(now)
        frames = tuple(self.waiting)
        self.waiting.clear()
        return frames

    def close(self) -> None:
        """Closes the camera."""
        self._shared.device.close()
