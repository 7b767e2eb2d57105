"""A TUIO decoder on a table with a clock, and the frames of a device at a network."""

from __future__ import annotations

from models.frames import TouchFrame
from models.plausible import ContactSizes
from models.reader_report import ReaderReport
from models.surface import Surface
from sandbox.devices.tuio.tuio import TuioDevice, touch_frame
from sandbox.devices.tuio.tuio_senders import Commit, Tuio
from tests.support.processes import until

A, B, C = (0.125, 0.25), (0.5, 0.75), (0.875, 0.5)
"""Positions that 32-bit floats hold exactly."""

PEER = "192.0.2.7:50001"


def touches(commit: Commit) -> dict[int, tuple[float, float]]:
    return {touch.id: (touch.x, touch.y) for touch in commit.touches}


def metres(commit: Commit, surface: Surface, time: float = 0.0) -> TouchFrame:
    """The frame that a device makes."""
    return touch_frame(commit, surface, time, ContactSizes(ReaderReport()))


class Table:
    """A decoder, and the time: every packet comes 10 ms after the last."""

    def __init__(self, stale_after: float = 2.0) -> None:
        self.tuio = Tuio(stale_after)
        self.now = 0.0

    def feed(self, *packets: bytes, peer: str = PEER) -> list[dict[int, tuple[float, float]]]:
        """Touches on the table after each frame that the packets complete."""
        frames = []
        for packet in packets:
            self.now += 0.01
            frames += [touches(commit) for commit in self.tuio.feed(packet, peer, self.now)]
        return frames

    def wait(self, seconds: float) -> list[dict[int, tuple[float, float]]]:
        self.now += seconds
        return [touches(commit) for commit in self.tuio.expire(self.now)]


def next_frames(device: TuioDevice, count: int) -> list[TouchFrame]:
    """Polls a device until so many frames have come."""
    frames: list[TouchFrame] = []
    until(lambda: frames.extend(device.poll()) or len(frames) >= count)
    return frames
