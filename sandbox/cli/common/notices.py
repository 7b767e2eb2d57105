"""Prints notices of a session in a thread of its own."""

from __future__ import annotations

import threading
import time
from queue import SimpleQueue

from rich.console import Console
from rich.text import Text


class NoticePrinter:
    """Prints notices; a terminal that stands still, as by Ctrl-S, does not hold up their session.

    Args:
        console: Console of the program.
        wrap: False leaves it to the terminal to break long lines.
    """

    def __init__(self, console: Console, wrap: bool = True) -> None:
        self._console, self._wrap = console, wrap
        self._waiting: SimpleQueue[str] = SimpleQueue()
        self._thread: threading.Thread | None = None
        self._said = self._printed = 0

    def say(self, notice: str) -> None:
        """Prints a notice soon; called from the session's thread."""
        self._said += 1
        self._waiting.put(notice)
        if self._thread is None:
            self._thread = threading.Thread(target=self._print, name="notices", daemon=True)
            self._thread.start()

    @property
    def waiting(self) -> int:
        """Number of notices that are not printed yet."""
        return self._said - self._printed

    def wait(self, seconds: float = 1.0) -> None:
        """Waits until all notices are printed, but no longer than a terminal may take."""
        end = time.monotonic() + seconds
        while self.waiting and time.monotonic() < end:
            time.sleep(0.01)

    def _print(self) -> None:
        while True:
            text = Text(self._waiting.get(), style="yellow")
            self._console.print(text, soft_wrap=not self._wrap)
            self._printed += 1


def address_line(address: str) -> str:
    """Returns the line about where a device listens: a link to open, or an address to send to."""
    told = "open" if "://" in address else "listening for TUIO on"
    return f"{told} [bold]{address}[/]"
