"""What every device offers to the session: one of touches, or one of hands in the air."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from models.frames import HandFrame, TouchFrame


class Device(Protocol):
    """A source of touch frames.

    Whatever may block (a socket, a file, a window) lives in the device's own thread; `poll` is
    called from the session's loop and returns at once.
    """

    name: str

    def poll(self, now: float) -> Sequence[TouchFrame]:
        """Frames committed since the last call, oldest first.

        Args:
            now: Session time, seconds of simulated time. A live device ignores it; one that plays
                from a file or from a simulation gives the frames due by then.
        """
        ...

    @property
    def finished(self) -> bool:
        """True when no further frame can come, as at the end of a file."""
        ...

    def close(self) -> None:
        """Gives back sockets, files and threads; may be called twice."""
        ...


class HandDevice(Protocol):
    """A source of hand frames; as `Device`, but for hands in the air."""

    name: str

    def poll(self, now: float) -> Sequence[HandFrame]:
        """Frames since the last call, oldest first; `now` is session time, s."""
        ...

    @property
    def finished(self) -> bool:
        """True when no further frame can come."""
        ...

    def close(self) -> None:
        """Gives everything back; may be called twice."""
        ...
