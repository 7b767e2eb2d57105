"""A client of the page's protocol in plain Python, for tests: no browser, no code of the server."""

from __future__ import annotations

import json
import struct
import time
from contextlib import ExitStack
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import urlsplit

from websockets.sync.client import ClientConnection, connect

from tests.support.processes import PATIENCE

BEAT = 0.5
"""s, after which a page that has nothing to say says that it is there."""
SCREEN: dict[str, Any] = {
    "px_per_in": 132.0,
    "width_px": 1024.0,
    "height_px": 768.0,
    "calibrated": True,
}


def open_socket(url: str, origin: str | None = "", **more: Any) -> Any:
    """A socket to a server, to be entered; its origin is the page unless said otherwise."""
    parts = urlsplit(url)
    options: dict[str, Any] = {"open_timeout": PATIENCE, **more}
    options["origin"] = f"http://{parts.netloc}" if origin == "" else origin
    return connect(
        f"ws://{parts.netloc}/?{parts.query}",
        compression=None,
        **options,
    )


@dataclass
class Page:
    """A page that says hello, sends touches, and takes frames apart by its own reading of them.

    One that beats says that it is there while it waits, as ours does in a browser.
    """

    url: str
    name: str = "test"
    role: str = "player"
    screen: dict[str, Any] = field(default_factory=lambda: dict(SCREEN))
    protocol: int = 4
    beats: bool = False

    def __post_init__(self) -> None:
        self._stack = ExitStack()
        self.socket: ClientConnection = self._stack.enter_context(open_socket(self.url))
        self.seq = 0
        self.told: list[dict[str, Any]] = []
        self.skins: list[dict[str, Any]] = []
        self.say(
            type="hello",
            protocol=self.protocol,
            client=self.name,
            role=self.role,
            screen=self.screen,
        )

    def say(self, **message: Any) -> None:
        self.socket.send(json.dumps(message))

    def touch(self, *contacts: tuple[int, float, float], **more: Any) -> int:
        """Contacts as id and inches; returns the message's seq."""
        self.seq += 1
        ppi = self.screen["px_per_in"]
        listed = [[i, x * ppi, y * ppi, 20.0, 20.0] for i, x, y in contacts]
        self.say(type="touches", seq=self.seq, t=self.seq * 16.0, contacts=listed, **more)
        return self.seq

    def next(self, timeout: float = PATIENCE) -> dict[str, Any]:
        """The next message; a frame's parts, or a text's JSON."""
        end = time.monotonic() + timeout
        while True:
            message = self._received(end)
            if not isinstance(message, str):
                break
            told: dict[str, Any] = json.loads(message)
            if told == {"type": "echo", "t": BEAT}:
                continue
            self.told.append(told)
            return told
        if message[1] == 2:
            self.skins.append({"type": "skin", "bytes": message})
            return self.skins[-1]
        bodies = struct.unpack_from("<H", message, 2)[0]
        scene, number, touch = struct.unpack_from("<III", message, 4)
        at, length = struct.unpack_from("<dI", message, 16)
        assert len(message) == 32 + 28 * bodies + length
        poses = [struct.unpack_from("<7f", message, 32 + 28 * i) for i in range(bodies)]
        state = json.loads(message[32 + 28 * bodies :])
        return {
            "type": "frame",
            "scene": scene,
            "number": number,
            "touch": touch,
            "time": at,
            "poses": poses,
            "state": state,
        }

    def _received(self, end: float) -> str | bytes:
        """Messages that arrive before this time of the clock."""
        while self.beats and end - time.monotonic() > BEAT:
            try:
                return self.socket.recv(timeout=BEAT)
            except TimeoutError:
                self.say(type="beat", t=BEAT)
        return self.socket.recv(timeout=max(end - time.monotonic(), 0.0))

    def until(self, kind: str, /, **wanted: Any) -> dict[str, Any]:
        """The next message of a kind with these values; frames are acknowledged on the way."""
        for _ in range(2000):
            message = self.next()
            if message["type"] == "frame":
                self.say(type="got", frame=message["number"])
            if message["type"] == kind and all(message[k] == v for k, v in wanted.items()):
                return message
        raise AssertionError(f"no {kind} came")

    def answered(self) -> None:
        """Waits until the server has read all that was said."""
        self.say(type="beat", t=1.0)
        self.until("echo", t=1.0)

    def close(self) -> None:
        self._stack.close()

    def __enter__(self) -> Page:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
