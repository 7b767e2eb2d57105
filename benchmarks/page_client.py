"""A client of the page's protocol on a plain socket, with one thread in a separate process.

It adds as little as possible to the measured times: it has no browser and no other threads.
"""

from __future__ import annotations

import json
import os
import select
import socket
import struct
import time
from typing import Any
from urllib.parse import urlsplit

import numpy as np
from websockets.client import ClientProtocol
from websockets.frames import Frame, Opcode
from websockets.uri import parse_uri

from sandbox.server.page_frames import KIND
from sandbox.server.protocol import PROTOCOL

PX_PER_IN = 132.0
SCREEN = {"px_per_in": PX_PER_IN, "width_px": 1024, "height_px": 768, "calibrated": True}


class Line:
    """A connection to the server, after the handshake and the message `hello`.

    Args:
        url: Link of the page.
    """

    def __init__(self, url: str) -> None:
        parts = urlsplit(url)
        uri = parse_uri(f"ws://{parts.netloc}/?{parts.query}")
        self._protocol = ClientProtocol(uri, origin=f"http://{parts.netloc}")  # type: ignore[arg-type]
        self._socket = socket.create_connection((parts.hostname, parts.port))
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._protocol.send_request(self._protocol.connect())
        self._flush()
        while not self._protocol.events_received():
            self._protocol.receive_data(self._socket.recv(65536))
        hello = {"type": "hello", "protocol": PROTOCOL, "client": "bench", "role": "player"}
        self.say(hello | {"screen": SCREEN})

    def say(self, message: dict[str, Any]) -> None:
        """Sends a message."""
        self._protocol.send_text(json.dumps(message).encode())
        self._flush()

    def heard(self, until: float) -> list[tuple[Opcode, bytes]]:
        """Returns the next messages. It is empty if none arrives until the time `until` (s) of
        `perf_counter`."""
        wait = max(0.0, until - time.perf_counter())
        if not select.select([self._socket], [], [], wait)[0]:
            return []
        self._protocol.receive_data(self._socket.recv(1 << 20))
        events = self._protocol.events_received()
        return [(e.opcode, bytes(e.data)) for e in events if isinstance(e, Frame)]

    def close(self) -> None:
        """Closes the connection."""
        self._socket.close()

    def _flush(self) -> None:
        for data in self._protocol.data_to_send():
            if data:
                self._socket.sendall(data)


def measure(url: str, seconds: float, rate: float, core: int | None, out: Any) -> None:
    """Sends touches of two moving fingers at a steady rate, with beats in between.

    A beat is sent half a period after a touch, when no control step for a touch is running. Its
    round trip is therefore the time of the connection alone.

    Args:
        url: Link of the page.
        seconds: Duration (s) of the measurement.
        rate: Number of touch messages a second.
        core: Processor core of this process; None: any.
        out: Queue for the result: round trips (ms) of the touches, and of the beats.
    """
    if core is not None:
        os.sched_setaffinity(0, {core})
    line = Line(url)
    sent: dict[int, float] = {}
    touches: list[float] = []
    echoes: list[float] = []
    start = time.perf_counter()
    due, seq, beat = start, 0, False
    while (now := time.perf_counter()) - start < seconds:
        if now >= due:
            due += 0.5 / rate
            if beat:
                line.say({"type": "beat", "t": 1e3 * time.perf_counter()})
            else:
                seq += 1
                touch = _touch(seq, now - start)
                sent[seq] = time.perf_counter()
                line.say(touch)
            beat = not beat
        for opcode, data in line.heard(due):
            now = time.perf_counter()
            if opcode is Opcode.TEXT:
                answer = json.loads(data)
                if answer["type"] == "echo":
                    echoes.append(1e3 * now - answer["t"])
            elif opcode is Opcode.BINARY and data[1] == KIND:
                number, newest = struct.unpack_from("<II", data, 8)
                touches += [1e3 * (now - sent.pop(s)) for s in [s for s in sent if s <= newest]]
                line.say({"type": "got", "frame": number})
    line.close()
    out.put((touches, echoes))


def _touch(seq: int, now: float) -> dict[str, Any]:
    x, y = 500 + 60 * float(np.cos(2 * now)), 380 + 60 * float(np.sin(2 * now))
    contacts = [[1, x - 80, y + 60, 20.0, 20.0], [2, x + 60, y - 60, 20.0, 20.0]]
    return {"type": "touches", "seq": seq, "t": now * 1e3, "contacts": contacts}
