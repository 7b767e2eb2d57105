"""Handles Ctrl-C in a regression run between results, so that none is lost."""

from __future__ import annotations

import signal
import threading
from types import FrameType

from sandbox.session.closeable import Closeable


class BreakOff(Closeable):
    """In its `with` block the first Ctrl-C only sets a flag that workers check; the second one
    interrupts.

    Outside of a program's main thread, and where Ctrl-C is ignored, it changes nothing.

    Attributes:
        asked: True once the user has pressed Ctrl-C.
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
