"""Serves the camera's page on this machine, and takes in the landmarks that it sends."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Callable, Sequence
from http import HTTPStatus
from pathlib import Path
from typing import Any
from urllib.parse import quote, urlsplit

from websockets.asyncio.server import ServerConnection
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response

from models.errors import InputError
from sandbox.devices.webcam.landmarks import PictureMessage, picture_message
from sandbox.server.page_options import LOOPBACK
from sandbox.server.server_thread import ServerThread, cannot_serve
from sandbox.server.static import TOKEN_PLACE, answered, plain

STATIC = Path(__file__).resolve().parent / "static"
ENGINE = "/engine/"
"""Where the page finds the engine and its model."""
LARGEST_MESSAGE = 1 << 16
"""Bytes of the largest message; three hands have about four thousand."""
PATIENCE = 20
"""Damaged messages after which a page is sent away: it is not ours."""
REPLACED = "Another page has taken the camera's place. This one can be closed."
ENDED = "The session is over: the camera is off. This page can be closed."

_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".mjs": "text/javascript; charset=utf-8",
    ".wasm": "application/wasm",
    ".task": "application/octet-stream",
}


class LandmarkServer(ServerThread):
    """Serves the page and the engine on 127.0.0.1, in a thread of its own.

    Args:
        engine: Folder with the engine and its model (`sandbox.devices.webcam.engine`).
        wanted: What the page is told first: the sides that the session follows, and so on.
        take: Called in the server's thread with every message of the page.
        gone: Called in the server's thread when the page has left.
        port: TCP port; 0 uses a free one.

    Raises:
        DeviceError: The port is not available.
    """

    def __init__(
        self,
        engine: Path,
        wanted: dict[str, Any],
        take: Callable[[PictureMessage], None],
        gone: Callable[[], None],
        port: int = 0,
    ) -> None:
        super().__init__(LARGEST_MESSAGE)
        self._files = _page_files(engine)
        self._wanted, self._take, self._gone = wanted, take, gone
        self._page: ServerConnection | None = None
        error = self._start("camera page", LOOPBACK, port)
        if error is not None:
            raise cannot_serve("the camera's page", LOOPBACK, port, error)

    async def _part(self) -> None:
        if self._page is not None:
            await _send_away(self._page, ENDED)

    def _process(self, connection: ServerConnection, request: Request) -> Response | None:
        """Accepts or refuses a request, and answers those for files."""
        wants_socket = request.headers.get("Upgrade", "").lower() == "websocket"
        reason = self._refusal(request, wants_socket)
        if reason:
            self.counters.add(f"wrong {reason}")
            return plain(HTTPStatus.FORBIDDEN, "This link is not valid: open the one shown last.")
        if not self._limits.authenticate(connection):
            self.counters.add("too many clients")
            return plain(HTTPStatus.SERVICE_UNAVAILABLE, "Too many pages are open.")
        if wants_socket:
            return None
        path = urlsplit(request.path).path
        return self._file("/index.html" if path == "/" else path, request.headers["Host"])

    def _file(self, name: str, host: str) -> Response:
        path = self._files.get(name)
        if path is None:
            return plain(HTTPStatus.NOT_FOUND, "Page not found.")
        try:
            body = path.read_bytes()
        except OSError:
            return plain(HTTPStatus.NOT_FOUND, "The engine is gone: sandbox devices webcam install")
        if name == "/index.html":
            body = body.replace(TOKEN_PLACE, quote(self.access.token).encode())
        policy = (
            "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; "
            f"connect-src 'self' ws://{host}; img-src data:; media-src 'self' blob:; "
            "frame-ancestors 'none'; base-uri 'none'; form-action 'none'"
        )
        headers = {"Content-Type": _TYPES[path.suffix], "Content-Security-Policy": policy}
        return answered(HTTPStatus.OK, headers, body)

    async def _handle(self, page: ServerConnection) -> None:
        """Takes in the messages of a page; the newest page is the camera's."""
        before, self._page = self._page, page
        if before is not None:
            await _send_away(before, REPLACED)
        refused = 0
        with contextlib.suppress(ConnectionClosed):
            await page.send(json.dumps({"what": "wanted", **self._wanted}))
            async for text in page:
                try:
                    self._take(picture_message(text))
                except InputError:
                    self.counters.add("malformed message")
                    refused += 1
                    if refused > PATIENCE:
                        await page.close(4004, "not our page")
        if self._page is page:
            self._page = None
            self._gone()


async def _send_away(page: ServerConnection, why: str) -> None:
    with contextlib.suppress(ConnectionClosed, asyncio.TimeoutError):
        await asyncio.wait_for(page.send(json.dumps({"what": "bye", "why": why})), 1.0)
        await asyncio.wait_for(page.close(), 2.0)


def _page_files(engine: Path) -> dict[str, Path]:
    """Path that a page may ask for -> file; nothing else is served."""
    ours = {f"/{p.name}": p for p in STATIC.iterdir() if p.suffix in _TYPES}
    return ours | {ENGINE + name: engine / name for name in served_names(engine)}


def served_names(engine: Path) -> Sequence[str]:
    """Names of the engine's files that a page may ask for, in its folder."""
    files = sorted(p for p in engine.rglob("*") if p.suffix in _TYPES)
    return [p.relative_to(engine).as_posix() for p in files]
