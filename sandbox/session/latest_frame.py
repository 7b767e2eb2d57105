"""The latest frame of a device, stamped with session time, as a control period uses it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from models.frames import Frame, HandFrame, LandmarkFrame, TouchFrame

SILENCE = 0.5
"""s without a frame after which a 3-D device or a camera is taken to see no hand. A working one
sends many frames a second, also without a hand in view; touch devices send only changes."""


class LatestFrame:
    """Keeps the latest frame of a device.

    Args:
        empty: Frame that stands in until the first one.

    Attributes:
        frame: The latest frame, with session time.
    """

    def __init__(self, empty: Frame) -> None:
        self.frame = empty
        self._heard = 0.0

    def take(self, frames: Sequence[Frame], time: float) -> bool:
        """Takes in the frames since the last control period; True if there were any.

        Of several frames the last one counts; touches that were cancelled in any of them stay
        cancelled.

        Args:
            frames: Oldest first, of one kind.
            time: s, session time.
        """
        last = frames[-1] if frames else self.frame
        if frames:
            self._heard = time
        if isinstance(last, TouchFrame):
            self.frame = (
                _stamped([f for f in frames if isinstance(f, TouchFrame)], time)
                if frames
                else replace(last, time=time, cancelled=frozenset())
            )
        elif time - self._heard > SILENCE and isinstance(last, LandmarkFrame):
            self.frame = replace(last, time=time, hands=())
        elif time - self._heard > SILENCE:
            self.frame = HandFrame(time, (), last.source)
        else:
            self.frame = last if last.time == time else replace(last, time=time)
        return bool(frames)


def _stamped(frames: Sequence[TouchFrame], time: float) -> TouchFrame:
    """The last frame, stamped with a time, with the touches that were cancelled in any frame."""
    last = frames[-1]
    if len(frames) == 1 and last.time == time and not last.cancelled:
        return last
    cancelled = frozenset().union(*(f.cancelled for f in frames))
    present = {c.id for c in last.contacts}
    return replace(last, time=time, cancelled=frozenset(cancelled - present))
