"""One clock for all pages of a camera: that of a page begins anew whenever it is loaded."""

from __future__ import annotations

from dataclasses import replace

from models.frames import LandmarkFrame

BACK = 1.0
"""s by which a page's time runs back when another page has taken its place unseen."""


class PageClock:
    """Moves the times of later pages so that they go on from those of the first one.

    Times of the first page are kept as they are.
    """

    def __init__(self) -> None:
        self._offset = 0.0
        self._last: LandmarkFrame | None = None
        self._arrived = 0.0
        self._anew = False

    def begin_anew(self) -> None:
        """The page has left, so the next frame is of another one."""
        self._anew = True

    def moved(self, frame: LandmarkFrame, arrived: float) -> LandmarkFrame:
        """A frame with times that go on.

        Args:
            frame: A frame with the times of its page.
            arrived: s, when it arrived, on a clock of this machine that never runs backwards.
        """
        last = self._last
        if last and (self._anew or frame.time + self._offset < last.time - BACK):
            gone = arrived - self._arrived
            # No picture was taken before the other page's last one.
            self._offset = max(last.time + gone - frame.time, last.taken - frame.taken)
        self._anew, self._arrived = False, arrived
        if self._offset:
            frame = replace(frame, time=frame.time + self._offset, taken=frame.taken + self._offset)
        self._last = frame
        return frame
