"""`sandbox play` on pages, in a thread, until a test has seen enough."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator

from sandbox.play.page_play import PagePlay
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import PlayerRequest


@contextlib.contextmanager
def played(play: PagePlay, server: PageServer) -> Iterator[None]:
    """Plays; at the end of the block it is as if somebody had pressed Ctrl-C."""
    heard, over = server.take_requests, threading.Event()

    def asked() -> list[PlayerRequest]:
        if over.is_set():
            raise KeyboardInterrupt
        return heard()

    server.take_requests = asked  # type: ignore[method-assign]

    def run() -> None:
        with contextlib.suppress(KeyboardInterrupt):
            play.run()

    thread = threading.Thread(target=run)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()
