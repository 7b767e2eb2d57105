"""Touch surfaces and tablet apps that send TUIO 1.1 or 2.0 over UDP, TCP or WebSocket.

UDP has one thread and one plain socket: a thread per packet, as ready-made OSC servers have it,
neither keeps the order of packets nor keeps up with a few thousand of them a second. Connections
live in a second thread (see `sandbox.devices.tuio.tuio_streams`), which is there only if asked for.
"""

from __future__ import annotations

import contextlib
import errno
import math
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Literal, get_args

from models.errors import DeviceError
from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.devices.tuio.tuio_senders import Commit, SourceStatus, Statistics, Tuio
from sandbox.devices.tuio.tuio_streams import DEFAULT_WEBSOCKET_PORT, Streams, parse_target
from sandbox.session.closeable import Closeable
from sandbox.session.device import Device

DEFAULT_PORT = 3333
"""The UDP port that TUIO senders use unless told otherwise."""

LOOPBACK = "127.0.0.1"

Transport = Literal["udp", "tcp", "websocket", "all"]
"""How packets come: each in a datagram, with its length before it in a TCP stream, or as a binary
message of a WebSocket."""

Tap = Callable[[float, str, bytes | None], None]

QUEUE_FRAMES = 2048
"""Frames that wait for `poll`: 17 seconds of a device of 120 Hz."""

_TICK = 0.1
"""Seconds between two looks for silent sources and for `close`, when no packet comes."""

_SOCKET_BUFFER = 1 << 20
"""Bytes that the system is asked to keep for us while the thread is busy."""


class TuioDevice(Device, Closeable):
    """A port on which any number of TUIO senders report touches, in version 1.1 or 2.0.

    All senders share the surface, so every frame holds the touches of all of them; their ids are
    made unique. What is wrong with packets is counted in `statistics`, never raised.

    Args:
        surface: Gives the size of what the senders call 0 to 1.
        bind: IPv4 address of the network card to listen on. The default can only be reached from
            this machine; 0.0.0.0 listens to everybody who can reach it.
        port: UDP or TCP port; 0 lets the system choose, and `port` tells which.
        transport: What to listen for. `all` takes TCP at the same port, and WebSockets at theirs.
        websocket_port: Port for WebSockets; 0 lets the system choose.
        connect: A sender that waits to be called, as the reference implementations do for TCP and
            WebSockets: `tcp://HOST:PORT` or `ws://HOST:PORT`. It is called again until it answers.
            Empty: listen.
        tap: Is told of every packet: time (s), peer, bytes; None: the connection has ended. Called
            from a thread that must not be held up.
        stale_after: Seconds of silence after which the touches of a source are lifted.
        queue_frames: Frames kept for `poll`; when full, the oldest is dropped and counted.

    Raises:
        DeviceError: The port is taken, or the address is not one of this machine.

    Attributes:
        clock_origin: s of the machine's monotonic clock at which the time of its frames is 0.
        news: Set while there is a frame to fetch.
    """

    name = "tuio"
    news: threading.Event
    clock_origin: float

    def __init__(
        self,
        surface: Surface,
        *,
        bind: str = LOOPBACK,
        port: int = DEFAULT_PORT,
        transport: Transport = "udp",
        websocket_port: int = DEFAULT_WEBSOCKET_PORT,
        connect: str = "",
        stale_after: float = 2.0,
        queue_frames: int = QUEUE_FRAMES,
        tap: Tap | None = None,
    ) -> None:
        if transport not in get_args(Transport):
            raise DeviceError(
                "there is no such transport",
                got=transport,
                expected=", ".join(get_args(Transport)),
            )
        if not 0.0 < stale_after < float("inf"):
            raise DeviceError(
                "a source cannot be stale after this time", got=stale_after, expected="seconds > 0"
            )
        if queue_frames < 1:
            raise DeviceError(
                "the queue must hold a frame at least", got=queue_frames, expected="1 or more"
            )
        self._surface = surface
        self._tuio = Tuio(stale_after)
        self._queue: deque[TouchFrame] = deque(maxlen=queue_frames)
        self._dropped = 0
        self._failure: DeviceError | None = None
        self._closing = threading.Event()
        self._news = threading.Condition()
        self.news = threading.Event()
        self._tap = tap
        self.clock_origin = time.monotonic()
        self._next_look = 0.0
        self._socket: socket.socket | None = None
        self._thread: threading.Thread | None = None
        self._streams: Streams | None = None
        self.bind, self.port, self.websocket_port = bind, port, websocket_port
        self._open(transport, connect)

    def _open(self, transport: Transport, connect: str) -> None:
        """Listens, or calls the sender."""
        if connect:
            self._streams = Streams(self, target=parse_target(connect))
            self._address = connect
            return
        try:
            if transport in ("udp", "all"):
                self._socket = _listen(self.bind, self.port)
                self.bind, self.port = self._socket.getsockname()
            if transport != "udp":
                ports = (
                    self.port if transport in ("tcp", "all") else None,
                    self.websocket_port if transport in ("websocket", "all") else None,
                )
                self._streams = Streams(self, self.bind, *ports)
                self.port = self._streams.tcp_port or self.port
                self.websocket_port = self._streams.websocket_port or self.websocket_port
        except DeviceError:
            self.close()
            raise
        shown = self.websocket_port if transport == "websocket" else self.port
        self._address = f"{self.bind}:{shown}"
        if self._socket is not None:
            self._thread = threading.Thread(target=self._receive, name="tuio", daemon=True)
            self._thread.start()

    @property
    def address(self) -> str:
        """Where it listens, as HOST:PORT, or whom it calls."""
        return self._address

    @property
    def transports(self) -> str:
        """What it listens to, for people."""
        listens = [
            "UDP" if self._socket is not None else "",
            "TCP" if self._streams is not None and self._streams.tcp_port is not None else "",
            f"WebSocket at port {self.websocket_port}"
            if self._streams is not None and self._streams.websocket_port is not None
            else "",
        ]
        return ", ".join(filter(None, listens))

    @property
    def statistics(self) -> Statistics:
        """A copy of the counters."""
        with self._news:
            return replace(self._tuio.statistics, dropped=self._dropped)

    @property
    def sources(self) -> tuple[SourceStatus, ...]:
        """All senders heard of, silent ones marked stale."""
        with self._news:
            return self._tuio.sources

    @property
    def finished(self) -> bool:
        """True once closed or broken, and every frame fetched."""
        with self._news:
            return not self._queue and not self._alive

    def poll(self, now: float = 0.0) -> Sequence[TouchFrame]:
        """Every frame committed since the last call, oldest first; `now` is ignored.

        Raises:
            DeviceError: The socket has failed since, and all frames before that were fetched.
        """
        with self._news:
            frames = list(self._queue)
            self._queue.clear()
            self.news.clear()
            if not frames and self._failure is not None:
                raise self._failure
        return frames

    def wait(self, seconds: float) -> bool:
        """Blocks until `poll` has something to say, at most `seconds`."""
        with self._news:
            return self._news.wait_for(
                lambda: bool(self._queue) or self._failure is not None, seconds
            )

    def close(self) -> None:
        """Stops listening; frames received before can still be polled."""
        self._closing.set()
        if self._streams is not None:
            self._streams.close()
        if self._thread is not None:
            self._thread.join()
        if self._socket is not None:
            self._socket.close()

    def receive(self, data: bytes, peer: str) -> None:
        """Takes in a packet; called from any thread."""
        with self._news:
            now = self._now()
            if self._tap is not None:
                self._tap(now, peer, data)
            self._publish(self._tuio.feed(data, peer, now), now)

    def hung_up(self, peer: str) -> None:
        """A connection has ended: the touches of those who spoke through it are cancelled."""
        with self._news:
            now = self._now()
            if self._tap is not None:
                self._tap(now, peer, None)
            self._publish(self._tuio.leave(peer), now)

    def look(self) -> None:
        """Lifts the touches of those who have been silent for too long."""
        with self._news:
            now = self._now()
            if now >= self._next_look:
                self._next_look = now + _TICK
                self._publish(self._tuio.expire(now), now)

    def refuse(self, reason: str, packet: bool = False) -> None:
        """Counts a connection that was not let in, or a packet that no reader ever saw."""
        with self._news:
            counts = self._tuio.statistics
            if packet:
                counts.packets += 1
                counts.refuse_packet(reason)
            else:
                counts.refuse_connection(reason)

    def fail(self, error: Exception, where: str) -> None:
        """What was listening is broken; the next `poll` says so."""
        with self._news:
            self._failure = DeviceError(
                f"listening to touches has failed: {error}",
                where=where,
                remedy="Start again; if it stays, check the network connection",
            )
            self._failure.__cause__ = error
            self._news.notify_all()

    @property
    def _alive(self) -> bool:
        threads = [self._thread, self._streams]
        return any(thread is not None and thread.is_alive() for thread in threads)

    def _now(self) -> float:
        return time.monotonic() - self.clock_origin

    def _receive(self) -> None:
        """The thread of UDP: takes packets until closed."""
        assert self._socket is not None
        try:
            while not self._closing.is_set():
                with contextlib.suppress(TimeoutError):
                    data, (host, port) = self._socket.recvfrom(65_536)
                    self.receive(data, f"{host}:{port}")
                self.look()
        except Exception as error:  # a thread must not die unheard: the next poll raises this
            self.fail(error, f"UDP {self.address}")

    def _publish(self, commits: list[Commit], now: float) -> None:
        for commit in commits:
            self._dropped += len(self._queue) == self._queue.maxlen
            self._queue.append(touch_frame(commit, self._surface, now))
        if commits:
            self.news.set()
            self._news.notify_all()


def touch_frame(commit: Commit, surface: Surface, now: float) -> TouchFrame:
    """A frame in metres from touches in 0..1 of the surface.

    Touches of a silent source leave like lifted ones, not as cancelled: the likeliest story is a
    lifted finger whose last packet was lost, and what it held must be let go of.

    A touch that is measured as wide and high is as large as the circle of the same area.
    """
    width, height = (float(length) for length in surface.size)
    contacts = []
    for touch in commit.touches:
        size = None
        if touch.width and touch.height:
            size = math.sqrt(touch.width * width * touch.height * height)
        contacts.append(Contact(touch.id, touch.x * width, touch.y * height, size, touch.label))
    return TouchFrame(now, tuple(contacts), None, commit.cancelled, commit.source)


def _listen(bind: str, port: int) -> socket.socket:
    """An open UDP socket whose `recvfrom` returns at least every tick."""
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _SOCKET_BUFFER)
        sock.settimeout(_TICK)
        sock.bind((bind, port))
    except (OSError, OverflowError, UnicodeError) as error:
        sock.close()
        raise DeviceError(
            f"this address cannot be listened on: {error}",
            where=f"UDP {bind}:{port}",
            expected="an IPv4 address of this machine and a free port from 0 to 65535",
            remedy="Close the program that has the port, or choose another with --port"
            if getattr(error, "errno", None) == errno.EADDRINUSE
            else "0.0.0.0 stands for all addresses of this machine",
        ) from error
    return sock
