"""A fake leapd that plays a recording: it sends the handshake and the frames of the service."""

from __future__ import annotations

import json
import threading
import time
from collections import Counter
from collections.abc import Sequence
from typing import Any

from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.sync.server import Server, ServerConnection, serve

from models.errors import DeviceError

PATH = "/v6.json"
DEFAULT_PORT = 6437
FAKE = "0 (fake leapd)"
"""Version that the fake service reports. It marks recordings of its frames as not real."""


class FakeLeapd:
    """Sends all messages to every client, beginning with the first message.

    Args:
        messages: JSON objects of frames.
        bind: Address of this machine to listen on.
        port: TCP port; 0 takes a free one.
        rate: Hz, frame rate.
        loop: Repeats the messages with increasing times; otherwise the connection closes after the
            last message.

    Raises:
        DeviceError: The port is not available.
    """

    def __init__(
        self,
        messages: Sequence[dict[str, Any]],
        *,
        bind: str = "127.0.0.1",
        port: int = DEFAULT_PORT,
        rate: float = 100.0,
        loop: bool = False,
    ) -> None:
        self.counts: Counter[str] = Counter()
        self._messages, self._rate, self._loop = messages, rate, loop
        self._stop = threading.Event()
        try:
            self._server: Server = serve(
                self._play, bind, port, process_request=_only_path, compression=None
            )
        except OSError as error:
            raise DeviceError(
                f"the fake leapd cannot listen: {error}",
                where=f"{bind}:{port}",
                remedy="Another leapd may be running; --port 0 takes a free port",
            ) from error
        self.port: int = self._server.socket.getsockname()[1]
        self.address = f"ws://{bind}:{self.port}{PATH}"
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends all connections; may be called twice."""
        self._stop.set()
        self._server.shutdown()
        self._thread.join(timeout=5.0)

    def _play(self, channel: ServerConnection) -> None:
        self.counts["clients"] += 1
        try:
            channel.send(json.dumps({"serviceVersion": FAKE, "version": 6}))
            self._frames(channel)
        except ConnectionClosed:
            self.counts["clients that left"] += 1

    def _frames(self, channel: ServerConnection) -> None:
        begin, sent, turn = time.monotonic(), 0, 0
        step_us = 1e6 / self._rate
        while not self._stop.is_set():
            for message in self._messages:
                due = begin + sent / self._rate
                self._stop.wait(max(0.0, due - time.monotonic()))
                if self._stop.is_set():
                    return
                if turn:  # In a repetition, the recorded times would run backwards.
                    since = sent - len(self._messages) + 1
                    message = message | {"timestamp": round(since * step_us) + self._last_time()}
                channel.send(json.dumps(message, separators=(",", ":")))
                sent += 1
                self.counts["frames"] += 1
            turn += 1
            if not self._loop:
                return

    def _last_time(self) -> int:
        value = self._messages[-1].get("timestamp", 0)
        return value if isinstance(value, int) else 0


def _only_path(channel: ServerConnection, request: Request) -> Response | None:
    """Refuses any other path, as the bridge does."""
    return None if request.path == PATH else channel.respond(404, f"only {PATH}\n")
