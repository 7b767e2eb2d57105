"""Ctrl-C in a regression run: heard between results, so that none is lost on its way."""

from __future__ import annotations

import signal
import threading
from types import FrameType

from sandbox.session.closing import Closing


class BreakOff(Closing):
    """In its `with` block Ctrl-C is a wish that whoever works asks for; the second one interrupts.

    Elsewhere than in a program's main thread, and where Ctrl-C is ignored, all stays as it was.

    Attributes:
        asked: Whether somebody wishes to break off.
    """

    def __init__(self) -> None:
        self.asked = False
        self._before = signal.getsignal(signal.SIGINT)
        self._hears = (
            threading.current_thread() is threading.main_thread()
            and self._before is not signal.SIG_IGN
        )
        if self._hears:
            signal.signal(signal.SIGINT, self._hear)

    def close(self) -> None:
        """Ctrl-C is what it was before."""
        if self._hears:
            signal.signal(signal.SIGINT, self._before)
            self._hears = False

    def _hear(self, number: int, frame: FrameType | None) -> None:
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True
