"""Ends on request of the system, as when a terminal is closed or a service is stopped."""

from __future__ import annotations

import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

_ENDING = ("SIGINT", "SIGTERM", "SIGHUP")


@contextmanager
def ending_as_by_ctrl_c() -> Iterator[None]:
    """Context in which requests to end raise KeyboardInterrupt, as Ctrl-C does; see `heeding`."""
    with heeding(signal.default_int_handler):
        yield


@contextmanager
def heeding(handler: Callable[[int, FrameType | None], object]) -> Iterator[None]:
    """Context in which Ctrl-C and requests to end call a handler of signals.

    A signal that is ignored, as SIGHUP is under `nohup`, stays ignored. Outside the main thread it
    changes nothing, since only that one gets signals.
    """
    before = {}
    if threading.current_thread() is threading.main_thread():
        # Windows has no SIGHUP.
        for number in (signal.Signals[name] for name in _ENDING if hasattr(signal, name)):
            # None is a handler that Python did not set, and cannot put back.
            if signal.getsignal(number) not in (signal.SIG_IGN, None):
                before[number] = signal.signal(number, handler)
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)
