"""TUIO over connections: TCP with a length before each packet, and WebSockets.

One thread has its own event loop. Either it listens, or it connects to one sender, and reconnects
when the connection ends; the reference implementations of senders accept connections. TUIO has no
authentication. Requests from web pages of other sites are refused, so that a page in this machine's
browser cannot send touches.
"""

from __future__ import annotations

import asyncio
import contextlib
import ipaddress
import logging
import queue
import socket
import threading
import time
from http import HTTPStatus
from typing import NamedTuple, Protocol
from urllib.parse import urlsplit

from websockets.asyncio.client import connect
from websockets.asyncio.connection import Connection
from websockets.asyncio.server import ServerConnection, serve
from websockets.exceptions import WebSocketException
from websockets.frames import CloseCode
from websockets.http11 import Request, Response

from models.errors import DeviceError
from sandbox.devices.tuio import DEFAULT_WEBSOCKET_PORT
from sandbox.devices.tuio.osc import MAX_PACKET_BYTES

MAX_CONNECTIONS = 32
"""Largest number of simultaneous connections; a sender needs one."""

SILENT = 10.0
"""Time (s) of silence after which a TCP connection may be ended to make room for another one. A
tablet that falls asleep does not end its connection."""

_TICK = 0.1
_REDIAL = 0.5
"""Time (s) between two attempts to connect to a sender."""
_LENGTH = 4
"""Number of bytes of a packet's length in a TCP stream, most significant first."""


class PacketReceiver(Protocol):
    """Receiver of packets and of the events of connections."""

    def receive(self, data: bytes, peer: str) -> None:
        """Processes a packet."""

    def disconnected(self, peer: str) -> None:
        """Called when a connection has ended."""

    def expire(self) -> None:
        """Lifts the touches of silent senders; called regularly."""

    def refuse(self, reason: str, packet: bool = False) -> None:
        """Counts a refused connection or packet."""

    def fail(self, error: Exception, where: str) -> None:
        """Called when the thread has failed and no more packets will come."""


class SenderAddress(NamedTuple):
    """Address of a sender to connect to; `scheme` is tcp, ws or wss."""

    scheme: str
    host: str
    port: int
    url: str


def parse_target(text: str) -> SenderAddress:
    """Reads `tcp://HOST:PORT` or `ws://HOST:PORT`.

    Raises:
        DeviceError: The text is neither.
    """
    try:
        parts = urlsplit(text)
        scheme, host, port = parts.scheme, parts.hostname or "", parts.port
        host.encode("idna")  # refuses names with an empty part, for which connecting would fail
    except ValueError:
        scheme, host, port = "", "", None
    if scheme not in ("tcp", "ws", "wss") or not host or port == 0:
        raise DeviceError(
            "this is not the address of a sender",
            got=text,
            expected="tcp://HOST:PORT or ws://HOST:PORT",
        )
    usual = 3333 if scheme == "tcp" else DEFAULT_WEBSOCKET_PORT
    url = text if port else text.replace(parts.netloc, f"{parts.netloc}:{usual}", 1)
    return SenderAddress(scheme, host, port or usual, url)


class Streams:
    """Connections of senders, handled in a thread.

    Args:
        receiver: Receiver of the packets.
        bind: Address to listen on for WebSockets.
        tcp: Bound socket to listen on for TCP; it is closed at the end. None does not listen for
            TCP.
        websocket_port: Port for WebSockets; 0 takes a free one, None does not listen for them.
        target: Address of a sender to connect to, instead of listening.

    Raises:
        DeviceError: An address or port is not available.
    """

    def __init__(
        self,
        receiver: PacketReceiver,
        bind: str = "127.0.0.1",
        tcp: socket.socket | None = None,
        websocket_port: int | None = None,
        target: SenderAddress | None = None,
    ) -> None:
        self._receiver = receiver
        self.bind, self.websocket_port = bind, websocket_port
        self._tcp = tcp
        self._target = target
        self._connections = 0
        self._heard: dict[asyncio.StreamWriter, float] = {}
        self._ready: queue.Queue[Exception | None] = queue.Queue()
        self._loop = asyncio.new_event_loop()
        self._closing = asyncio.Event()
        self._thread = threading.Thread(target=self._run, name="tuio-streams", daemon=True)
        self._thread.start()
        problem = self._ready.get()
        if problem is not None:
            self._thread.join()
            raise DeviceError(
                f"this address cannot be listened on: {problem}",
                where=f"WebSockets at {bind}:{websocket_port}",
                expected="an IPv4 address of this machine and a free port from 0 to 65535",
                remedy="Close the program that has the port, or choose another with --port",
            ) from problem

    def is_alive(self) -> bool:
        """True while packets can still arrive."""
        return self._thread.is_alive()

    def close(self) -> None:
        """Ends all connections and the thread; may be called twice."""
        with contextlib.suppress(RuntimeError):  # the loop is closed already
            self._loop.call_soon_threadsafe(self._closing.set)
        self._thread.join(timeout=10.0)

    # -- everything below runs in the thread ---------------------------------------------------

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        try:
            self._loop.run_until_complete(self._work())
        except Exception as error:  # passed on, since it would end only this thread
            self._receiver.fail(error, "TCP")
        finally:
            self._loop.close()

    async def _work(self) -> None:
        async with contextlib.AsyncExitStack() as stack:
            try:
                await self._listen(stack)
            except (OSError, OverflowError, UnicodeError) as error:
                self._ready.put(error)
                return
            self._ready.put(None)
            calling = asyncio.create_task(self._call()) if self._target else None
            while not self._closing.is_set():
                self._receiver.expire()
                with contextlib.suppress(TimeoutError):
                    await asyncio.wait_for(self._closing.wait(), _TICK)
            tasks = [t for t in asyncio.all_tasks() if t is not asyncio.current_task()]
            if calling is not None:
                calling.cancel()
            for task in tasks:
                if task.get_name() == "tuio-tcp":
                    task.cancel()
            await asyncio.gather(*([calling] if calling else []), return_exceptions=True)

    async def _listen(self, stack: contextlib.AsyncExitStack) -> None:
        if self._tcp is not None:
            stack.callback(self._tcp.close)
            tcp = await asyncio.start_server(self._answer_tcp, sock=self._tcp)
            stack.callback(tcp.close)
        if self.websocket_port is not None:
            web = await serve(
                self._answer_websocket,
                self.bind,
                self.websocket_port,
                process_request=self._judge,
                compression=None,
                max_size=MAX_PACKET_BYTES,
                max_queue=64,
                open_timeout=5,
                ping_interval=5,
                ping_timeout=5,
                close_timeout=1,
                server_header=None,
                logger=_silent_logger(),
            )
            await stack.enter_async_context(web)
            self.websocket_port = next(iter(web.sockets)).getsockname()[1]

    async def _call(self) -> None:
        """Connects to the sender, and again whenever the connection ends."""
        target = self._target
        assert target is not None
        while True:
            with contextlib.suppress(OSError, WebSocketException, TimeoutError):
                if target.scheme == "tcp":
                    reader, writer = await asyncio.wait_for(
                        asyncio.open_connection(target.host, target.port), 5.0
                    )
                    await self._read_tcp(reader, writer, f"tcp {target.host}:{target.port}")
                else:
                    async with connect(
                        target.url,
                        compression=None,
                        max_size=MAX_PACKET_BYTES,
                        open_timeout=5,
                        ping_interval=5,
                        ping_timeout=5,
                        close_timeout=1,
                        proxy=None,
                        logger=_silent_logger(),
                    ) as connection:
                        await self._read_websocket(connection, f"{target.host}:{target.port}")
            await asyncio.sleep(_REDIAL)

    async def _answer_tcp(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        task = asyncio.current_task()
        assert task is not None
        task.set_name("tuio-tcp")
        host, port = writer.get_extra_info("peername")[:2]
        if self._connections >= MAX_CONNECTIONS and not self._end_silent_connection():
            self._receiver.refuse("too many connections")
            writer.close()
            return
        self._connections += 1
        try:
            # `close` cancels this task; asyncio's own server would print a traceback.
            with contextlib.suppress(asyncio.CancelledError):
                await self._read_tcp(reader, writer, f"tcp {host}:{port}")
        finally:
            self._connections -= 1

    def _end_silent_connection(self) -> bool:
        """Ends the TCP connection that has been silent for longest.

        Returns False if no connection has been silent for `SILENT`.
        """
        silent = min(self._heard, key=lambda writer: self._heard[writer], default=None)
        if silent is None or time.monotonic() - self._heard[silent] < SILENT:
            return False
        del self._heard[silent]
        silent.transport.abort()
        return True

    async def _read_tcp(
        self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, peer: str
    ) -> None:
        """Receives packets until the connection ends or the data are not TUIO."""
        try:
            with contextlib.suppress(asyncio.IncompleteReadError, OSError):  # a closed connection
                while True:
                    self._heard[writer] = time.monotonic()
                    size = int.from_bytes(await reader.readexactly(_LENGTH), "big")
                    if not 0 < size <= MAX_PACKET_BYTES:
                        # The start of the next packet is unknown.
                        self._receiver.refuse(f"a packet of {size} bytes in a stream", packet=True)
                        break
                    self._receiver.receive(await reader.readexactly(size), peer)
        finally:
            self._heard.pop(writer, None)
            self._receiver.disconnected(peer)
            writer.close()

    async def _answer_websocket(self, connection: ServerConnection) -> None:
        host, port = connection.remote_address[:2]
        await self._read_websocket(connection, f"{host}:{port}")

    async def _read_websocket(self, connection: Connection, address: str) -> None:
        peer = f"ws {address}"
        self._connections += 1
        try:
            with contextlib.suppress(WebSocketException, OSError):
                async for packet in connection:
                    if isinstance(packet, str):
                        self._receiver.refuse("a text message on a WebSocket", packet=True)
                    else:
                        self._receiver.receive(packet, peer)
            ended = connection.protocol.close_sent
            if ended is not None and ended.code == CloseCode.MESSAGE_TOO_BIG:
                self._receiver.refuse("a message is too large", packet=True)
        finally:
            self._connections -= 1
            self._receiver.disconnected(peer)

    def _judge(self, connection: ServerConnection, request: Request) -> Response | None:
        """Accepts or refuses a request for a WebSocket."""
        hosts, origins = request.headers.get_all("Host"), request.headers.get_all("Origin")
        reason = refusal(hosts, origins)
        if not reason and self._connections >= MAX_CONNECTIONS:
            reason = "too many connections"
        if not reason:
            return None
        self._receiver.refuse(reason)
        return connection.respond(HTTPStatus.FORBIDDEN, "This address takes TUIO.\n")


def refusal(hosts: list[str], origins: list[str]) -> str:
    """Reason for refusing a request for a WebSocket; empty if it is accepted.

    A host name that is neither an address nor localhost is a sign of DNS rebinding. A foreign
    `Origin` is that of a web page in a browser on this machine; other programs send no `Origin`.

    Args:
        hosts: Values of the `Host` header.
        origins: Values of the `Origin` header.
    """
    if len(hosts) != 1 or not _is_address(_host_of(f"//{hosts[0]}")):
        return "a foreign host name"
    if len(origins) > 1:
        return "a foreign origin"
    if origins and _host_of(origins[0]) not in (
        "localhost",
        "127.0.0.1",
        _host_of(f"//{hosts[0]}"),
    ):
        return "a foreign origin"
    return ""


def _host_of(url: str) -> str:
    try:
        return urlsplit(url).hostname or ""
    except ValueError:
        return ""


def _is_address(host: str) -> bool:
    if host == "localhost":
        return True
    try:
        ipaddress.ip_address(host)
    except ValueError:
        return False
    return True


def _silent_logger() -> logging.Logger:
    """Returns a silent logger: errors of foreign connections are counted, not printed."""
    logger = logging.Logger("hand_sandbox.tuio")
    logger.addHandler(logging.NullHandler())
    return logger
