"""Handles Ctrl-C and SIGTERM in a regression run between results, so that none is lost."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from sandbox.devices.device import Closeable

SIGNALS = (signal.SIGINT, signal.SIGTERM)
"""What a person sends with Ctrl-C, and what CI systems and schedulers send."""


class BreakOff(Closeable):
    """In its `with` block the first signal only sets a flag that workers check; a second one
    interrupts trials that are running.

    Outside of a program's main thread, and for signals that are ignored, it changes nothing.
    """

    def __init__(self) -> None:
        self._running = False
        self._signal: int | None = None
        self._before = {}
        if threading.current_thread() is threading.main_thread():
            before = {number: signal.getsignal(number) for number in SIGNALS}
            self._before = {n: how for n, how in before.items() if how is not signal.SIG_IGN}
        for number in self._before:
            signal.signal(number, self._hear)

    @property
    def asked(self) -> bool:
        """True once a signal has come."""
        return self._signal is not None

    @property
    def name(self) -> str:
        """Name of the first signal; empty if none has come."""
        return "" if self._signal is None else signal.Signals(self._signal).name

    @property
    def status(self) -> int:
        """Exit status of a program that the signal ended, as shells have it: 130 or 143."""
        return 128 + (self._signal or signal.SIGINT)

    @contextmanager
    def while_running(self) -> Iterator[None]:
        """While trials run, which a second signal interrupts; what is written then is not."""
        self._running = True
        try:
            yield
        finally:
            self._running = False

    def close(self) -> None:
        """The signals do what they did before."""
        for number, how in self._before.items():
            signal.signal(number, how)
        self._before = {}

    def _hear(self, number: int, frame: FrameType | None) -> None:
        if self.asked and self._running:
            raise KeyboardInterrupt
        self._signal = self._signal or number
