"""Handling of signals that ask the program to end, as when a terminal or a service is closed."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

_ENDING = ("SIGINT", "SIGTERM", "SIGHUP")


@contextmanager
def ending_as_by_ctrl_c() -> Iterator[None]:
    """Context in which SIGTERM and SIGHUP raise KeyboardInterrupt, as Ctrl-C does."""
    with heeding(signal.default_int_handler):
        yield


@contextmanager
def heeding(handler: Callable[[int, FrameType | None], object]) -> Iterator[None]:
    """Context in which SIGINT (Ctrl-C), SIGTERM and SIGHUP call a signal handler.

    An ignored signal stays ignored, such as SIGHUP under `nohup`. Outside the main thread the
    context changes nothing, since only the main thread gets signals.
    """
    before = {}
    if threading.current_thread() is threading.main_thread():
        # Windows has no SIGHUP.
        for number in (signal.Signals[name] for name in _ENDING if hasattr(signal, name)):
            # None means a handler that Python did not set and cannot restore.
            if signal.getsignal(number) not in (signal.SIG_IGN, None):
                before[number] = signal.signal(number, handler)
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)
