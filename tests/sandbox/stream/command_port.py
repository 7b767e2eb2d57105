"""A command port that behaves as badly as Maya's is known to; notes in docs/stream.md."""

from __future__ import annotations

import select
import socket
import threading
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass

BUFFER = 4096
"""Maya's default bufferSize: a longer command closes the connection."""


@dataclass(frozen=True)
class Manners:
    """How a port behaves.

    Attributes:
        answer: What it says after every command; None says nothing.
        dies: Closes the connection after every answer, as Maya 2022 to 2025 do.
        drops_after: Commands after which it closes without a word.
        delay: s before it reads again: what came meanwhile arrives merged.
        piece: Bytes that it reads at once, at most.
    """

    answer: bytes | None = b"None\n\0"
    dies: bool = False
    drops_after: int = 0
    delay: float = 0.0
    piece: int = 65536


class CommandPort:
    """Listens, runs what it hears, line by line, and counts.

    Args:
        run: Runs one line.
        manners: How it behaves.
        port: TCP; 0 takes a free one.
    """

    def __init__(self, run: Callable[[str], object], manners: Manners, port: int = 0) -> None:
        self._run_line, self.manners = run, manners
        self.counts: Counter[str] = Counter()
        self.longest = 0
        self.errors: list[str] = []
        self._stop = threading.Event()
        self._server = socket.create_server(("127.0.0.1", port))
        self.port: int = self._server.getsockname()[1]
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends it, and every connection."""
        self._stop.set()
        self._thread.join()
        self._server.close()

    def _serve(self) -> None:
        while not self._stop.is_set():
            ready, _, _ = select.select([self._server], [], [], 0.02)
            if ready:
                channel, _ = self._server.accept()
                self.counts["connections"] += 1
                with channel:
                    self._talk(channel)

    def _talk(self, channel: socket.socket) -> None:
        left, done = b"", 0
        while not self._stop.is_set():
            ready, _, _ = select.select([channel], [], [], 0.02)
            if not ready:
                continue
            time.sleep(self.manners.delay)
            try:
                data = channel.recv(self.manners.piece)
            except ConnectionError:
                return
            if not data:
                return
            *lines, left = (left + data).split(b"\n")
            if len(left) >= BUFFER or any(len(line) + 1 >= BUFFER for line in lines):
                self.counts["too long"] += 1
                return
            for line in lines:
                self._one(line)
                done += 1
                if self.manners.answer is not None:
                    try:
                        channel.sendall(self.manners.answer)
                    except OSError:
                        return
                if self.manners.dies or done == self.manners.drops_after:
                    return

    def _one(self, line: bytes) -> None:
        self.longest = max(self.longest, len(line) + 1)
        try:
            self._run_line(line.decode("utf-8"))
        except Exception as error:
            self.errors.append(repr(error))
        self.counts["commands"] += 1
