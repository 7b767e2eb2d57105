"""A server of pages in its own thread, with its own event loop; a session never waits for it."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import queue
import ssl
import threading
from abc import abstractmethod
from dataclasses import replace

from websockets.asyncio.server import ServerConnection, serve
from websockets.http11 import Request, Response

from models.errors import DeviceError
from sandbox.devices.device import Closeable
from sandbox.server.access import Access, ConnectionLimits, Counters, limited_connection

GREETING = 5.0
"""Time (s) within which a page must complete its handshake, and then send its first message."""


class ServerThread(Closeable):
    """Base class of servers of pages.

    All methods except `close` and `_start` run in the server's thread.

    Args:
        largest: Size of the largest message from a page, bytes.
        tls: Certificate and key for https; None serves http.
        token: Token of an earlier server, so that its pages can reconnect; empty creates a new one.

    Attributes:
        access: Access rules; they have the link.
        counters: Counters of refusals.
    """

    access: Access

    def __init__(self, largest: int, tls: ssl.SSLContext | None = None, token: str = "") -> None:
        self.counters = Counters()
        self._limits = ConnectionLimits(self.counters)
        self._largest, self._tls, self._token = largest, tls, token
        self._ready: queue.Queue[Access | OSError] = queue.Queue()
        self._loop = asyncio.new_event_loop()
        self._closing = asyncio.Event()
        self._thread: threading.Thread | None = None

    @property
    def url(self) -> str:
        """The link that opens the page."""
        return self.access.url

    def close(self) -> None:
        """Closes all connections and ends the thread; may be called twice."""
        if self._thread is not None and self._thread.is_alive():
            with contextlib.suppress(RuntimeError):
                self._loop.call_soon_threadsafe(self._closing.set)
            self._thread.join(timeout=5.0)

    def _start(self, name: str, host: str, port: int) -> OSError | None:
        """Starts the thread; called by the subclass. Returns the error that prevents serving."""
        self._thread = threading.Thread(target=self._run, args=(host, port), name=name, daemon=True)
        self._thread.start()
        ready = self._ready.get()
        if isinstance(ready, OSError):
            self._thread.join()
            return ready
        self.access = ready
        return None

    @abstractmethod
    async def _handle(self, connection: ServerConnection) -> None:
        """Handles the connection of a page from its first message to its end."""

    @abstractmethod
    def _process(self, connection: ServerConnection, request: Request) -> Response | None:
        """Accepts or refuses a request; returns the response, or None to open a WebSocket."""

    async def _watch(self) -> None:
        """Runs until it is cancelled when the server closes; does nothing by default."""

    async def _part(self) -> None:
        """Sends last messages before the connections are closed; does nothing by default."""

    def _refusal(self, request: Request, wants_socket: bool) -> str:
        """Returns the reason for refusing a request, in one word; empty if it is accepted."""
        hosts, origins = request.headers.get_all("Host"), request.headers.get_all("Origin")
        return self.access.refusal(
            request.path,
            hosts[0] if len(hosts) == 1 else None,
            origins[0] if origins else None,
            wants_socket,
        )

    def _run(self, host: str, port: int) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_until_complete(self._serve(host, port))
        finally:
            self._loop.close()

    async def _serve(self, host: str, port: int) -> None:
        try:
            server = await serve(
                self._handle,
                host,
                port,
                process_request=self._process,
                ssl=self._tls,
                # `ConnectionLimits` does not count a connection before its TLS handshake.
                ssl_handshake_timeout=GREETING if self._tls else None,
                compression=None,
                max_size=self._largest,
                max_queue=8,
                # Send a frame only after the previous one has left, so that it is the newest.
                write_limit=0,
                open_timeout=GREETING,
                ping_interval=5,
                ping_timeout=5,
                close_timeout=1,
                server_header=None,
                logger=_silent_logger(),
                create_connection=limited_connection(self._limits),
            )
        except OSError as error:
            self._ready.put(error)
            return
        bound = next(iter(server.sockets)).getsockname()
        access = Access(bound[0], bound[1], self._tls is not None)
        if self._token:
            access = replace(access, token=self._token)
        # Set it in this thread: a request may arrive before the other thread continues.
        self.access = access
        self._ready.put(access)
        watch = asyncio.create_task(self._watch())
        await self._closing.wait()
        watch.cancel()
        await self._part()
        server.close()
        with contextlib.suppress(asyncio.TimeoutError):
            await asyncio.wait_for(server.wait_closed(), 3.0)


def cannot_serve(what: str, host: str, port: int, error: OSError, remedy: str = "") -> DeviceError:
    """Returns the error for an address or port that is not available.

    Args:
        what: Name of the service.
        host: IP address.
        port: TCP port.
        error: The system's error.
        remedy: Remedy for the user.
    """
    return DeviceError(
        f"{what} cannot be served here",
        where=f"{host}:{port}",
        got=os.strerror(error.errno) if error.errno else str(error),
        remedy=remedy,
    )


def _silent_logger() -> logging.Logger:
    """Returns a silent logger: errors of foreign connections are counted, not printed."""
    logger = logging.Logger("hand_sandbox.page")
    logger.addHandler(logging.NullHandler())
    return logger
