"""Touch surfaces and tablet apps that send TUIO 1.1 or 2.0 over UDP, TCP or WebSocket.

UDP uses one thread and one plain socket. Ready-made OSC servers use a thread per packet: packets
then lose their order, and a few thousand packets a second are too many. Connections (TCP and
WebSocket) run in a second thread, which is started only if needed
(`sandbox.devices.tuio.tuio_streams`).
"""

from __future__ import annotations

import contextlib
import errno
import math
import os
import socket
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import get_args

from models.errors import DeviceError, InputError
from models.frames import Contact, TouchFrame
from models.plausible import ContactSizes, TouchIds
from models.reader_report import ReaderReport
from models.surface import Surface
from sandbox.devices.device import Closeable, Device
from sandbox.devices.tuio import DEFAULT_PORT, DEFAULT_WEBSOCKET_PORT, LOOPBACK, Transport
from sandbox.devices.tuio.tuio_senders import Commit, SourceStatus, Statistics, Tuio
from sandbox.devices.tuio.tuio_streams import Streams, parse_target

_SOCKETS: dict[Transport, tuple[socket.SocketKind, ...]] = {
    "udp": (socket.SOCK_DGRAM,),
    "tcp": (socket.SOCK_STREAM,),
    "websocket": (),
    "all": (socket.SOCK_DGRAM, socket.SOCK_STREAM),
}

_PORTS_TRIED = 64
"""Largest number of ports free for UDP that are tried until one is free for TCP as well."""

Tap = Callable[[float, str, bytes | None], None]

QUEUE_FRAMES = 2048
"""Number of frames that wait for `poll`: 17 seconds of a device of 120 Hz."""

_TICK = 0.1
"""Time (s) between two checks for silent sources and for `close` while no packet comes."""

_SOCKET_BUFFER = 1 << 20
"""Bytes of the socket's receive buffer, which holds packets while the thread is busy."""


class TuioDevice(Device, Closeable):
    """A port at which any number of TUIO senders report touches, in version 1.1 or 2.0.

    All senders share the surface, so every frame has the touches of all senders; their ids are made
    unique. Invalid packets raise no error; `statistics` counts them.

    Args:
        surface: The touch surface, which the senders' coordinates 0 to 1 span.
        bind: IPv4 address of this machine to listen on. The default can only be reached from this
            machine; 0.0.0.0 accepts packets from every network.
        port: UDP or TCP port; with 0 the system chooses one, which the attribute `port` then has.
        transport: Transport to listen for. `all`: UDP and TCP at `port`, and WebSockets at
            `websocket_port`.
        websocket_port: Port for WebSockets; 0 lets the system choose.
        connect: Address of a sender that accepts connections, as the reference implementations do
            for TCP and WebSockets: `tcp://HOST:PORT` or `ws://HOST:PORT`. The device connects to it
            and retries until it answers. Empty listens instead.
        tap: Called with time (s), peer and bytes of every packet; the bytes are None when the
            connection has ended. It runs in the receiving thread and must return quickly. An
            InputError that it raises ends the device: `poll` raises this error.
        stale_after: Time (s) of silence after which the touches of a source are lifted.
        queue_frames: Largest number of frames that wait for `poll`; if there are more, the oldest
            are dropped and counted.

    Raises:
        DeviceError: The port is taken, or the address is not one of this machine.

    Attributes:
        clock_origin: s on the machine's monotonic clock at which the time of its frames is 0.
        frame_ready: Event that is set while a frame can be fetched.
    """

    name = "tuio"
    frame_ready: threading.Event
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
                "unknown transport",
                got=transport,
                expected=", ".join(get_args(Transport)),
            )
        if not 0.0 < stale_after < float("inf"):
            raise DeviceError(
                "`stale_after` must be a positive time", got=stale_after, expected="seconds > 0"
            )
        if queue_frames < 1:
            raise DeviceError(
                "the queue must hold at least one frame", got=queue_frames, expected="1 or more"
            )
        self._surface = surface
        self._tuio = Tuio(stale_after)
        self._sizes = ContactSizes(self._tuio.report)
        self._ids = TouchIds(self._tuio.report)
        self._queue: deque[TouchFrame] = deque(maxlen=queue_frames)
        self._dropped = 0
        self._failure: InputError | None = None
        self._told = False
        self._closing = threading.Event()
        self._news = threading.Condition()
        self.frame_ready = threading.Event()
        self._tap = tap
        self.clock_origin = time.monotonic()
        self._next_look = 0.0
        self._socket: socket.socket | None = None
        self._thread: threading.Thread | None = None
        self._streams: Streams | None = None
        self._listens_tcp = False
        self.bind, self.port, self.websocket_port = bind, port, websocket_port
        self._open(transport, connect)

    def _open(self, transport: Transport, connect: str) -> None:
        """Begins to listen, or to connect to the sender."""
        if connect:
            self._streams = Streams(self, target=parse_target(connect))
            self._address = connect
            return
        try:
            sockets = _listen(self.bind, self.port, _SOCKETS[transport])
            for opened in sockets.values():
                self.bind, self.port = opened.getsockname()
            self._socket = sockets.get(socket.SOCK_DGRAM)
            tcp = sockets.get(socket.SOCK_STREAM)
            self._listens_tcp = tcp is not None
            if transport != "udp":
                web_port = self.websocket_port if transport in ("websocket", "all") else None
                self._streams = Streams(self, self.bind, tcp, web_port)
                self.websocket_port = self._streams.websocket_port or self.websocket_port
        except DeviceError:
            self.close()
            raise
        self._address = f"{self.bind}:{self.announced_port}"
        if self._socket is not None:
            self._thread = threading.Thread(target=self._receive, name="tuio", daemon=True)
            self._thread.start()

    @property
    def address(self) -> str:
        """HOST:PORT at which the device listens, or the address of the sender to connect to."""
        return self._address

    @property
    def announced_port(self) -> int:
        """Port of `address`: that of UDP or TCP, or else of WebSockets."""
        return self.port if self._socket is not None or self._listens_tcp else self.websocket_port

    @property
    def transports(self) -> str:
        """Transports for which the device listens, as text for people."""
        listens = [
            "UDP" if self._socket is not None else "",
            "TCP" if self._listens_tcp else "",
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
    def report(self) -> ReaderReport:
        """A copy of the report on left-out data and assumptions."""
        with self._news:
            return self._tuio.report.copy()

    @property
    def sources(self) -> tuple[SourceStatus, ...]:
        """Status of all known senders; silent ones are marked stale."""
        with self._news:
            return self._tuio.sources

    @property
    def finished(self) -> bool:
        """True if the device is closed or has failed, and `poll` has returned all frames and raised
        the failure."""
        with self._news:
            return not self._queue and not self._alive and (self._failure is None or self._told)

    def poll(self, now: float = 0.0) -> Sequence[TouchFrame]:
        """Returns all frames since the last call, oldest first; `now` is ignored.

        Raises:
            InputError: The socket or the tap has failed, and all earlier frames were returned.
        """
        with self._news:
            frames = list(self._queue)
            self._queue.clear()
            self.frame_ready.clear()
            if not frames and self._failure is not None:
                self._told = True
                raise self._failure
        return frames

    def wait(self, seconds: float) -> bool:
        """Blocks until `poll` has frames or an error, at most `seconds`."""
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
        """Processes a packet; called from any thread."""
        with self._news:
            now = self._now()
            self._pass_to_tap(now, peer, data)
            self._publish(self._tuio.feed(data, peer, now), now)

    def disconnected(self, peer: str) -> None:
        """Cancels the touches of a disconnected sender, unless it comes back at once."""
        with self._news:
            now = self._now()
            self._pass_to_tap(now, peer, None)
            self._tuio.disconnect(peer, now)

    def expire(self) -> None:
        """Lifts the touches of senders that have been silent for too long."""
        with self._news:
            now = self._now()
            if now >= self._next_look:
                self._next_look = now + _TICK
                self._publish(self._tuio.expire(now), now)

    def refuse(self, reason: str, packet: bool = False) -> None:
        """Counts a refused connection, or a packet that was refused before it was decoded."""
        with self._news:
            counts = self._tuio.statistics
            if packet:
                counts.packets += 1
                counts.count_malformed(reason)
            else:
                counts.refuse_connection(reason)

    def fail(self, error: Exception, where: str) -> None:
        """Stores a failure of the listening thread, which the next `poll` raises."""
        with self._news:
            if self._failure is not None:
                return
            self._failure = DeviceError(
                f"listening for touches has failed: {error}",
                where=where,
                remedy="Start again; if it fails again, check the network connection",
            )
            self._failure.__cause__ = error
            self._news.notify_all()

    def _pass_to_tap(self, now: float, peer: str, data: bytes | None) -> None:
        """Calls the tap; an error of the tap is raised by the next `poll`, and ends the device."""
        if self._tap is None or self._failure is not None:
            return
        try:
            self._tap(now, peer, data)
        except InputError as error:
            self._failure = error
            self._news.notify_all()

    @property
    def _alive(self) -> bool:
        threads = [self._thread, self._streams]
        return any(thread is not None and thread.is_alive() for thread in threads)

    def _now(self) -> float:
        return time.monotonic() - self.clock_origin

    def _receive(self) -> None:
        """Receives packets until closed; the body of the UDP thread."""
        assert self._socket is not None
        try:
            while not self._closing.is_set():
                with contextlib.suppress(TimeoutError):
                    data, (host, port) = self._socket.recvfrom(65_536)
                    self.receive(data, f"{host}:{port}")
                self.expire()
        except Exception as error:  # the next poll raises it, so that it is not lost
            self.fail(error, f"UDP {self.address}")

    def _publish(self, commits: list[Commit], now: float) -> None:
        if self._failure is not None:
            return
        for commit in commits:
            self._dropped += len(self._queue) == self._queue.maxlen
            frame = touch_frame(commit, self._surface, now, self._sizes)
            self._ids.look(frame)
            self._queue.append(frame)
        if commits:
            self.frame_ready.set()
            self._news.notify_all()


def touch_frame(commit: Commit, surface: Surface, now: float, sizes: ContactSizes) -> TouchFrame:
    """Converts touches in 0..1 of the surface to a frame in metres.

    Touches of a silent source are lifted, not cancelled: most likely a finger was lifted and the
    last packet was lost, so the hand must release the object.

    The width and height of a touch become its extent. Its size is the diameter of a circle of equal
    area. Impossible values for a finger or hand are left out.
    """
    width, height = (float(length) for length in surface.size)
    contacts = []
    for touch in commit.touches:
        size = extent = None
        if touch.width and touch.height:
            extent = touch.width * width, touch.height * height
            size, extent = sizes.known(math.sqrt(extent[0] * extent[1]), extent)
        contacts.append(
            Contact(touch.id, touch.x * width, touch.y * height, size, touch.label, extent)
        )
    return TouchFrame(now, tuple(contacts), None, commit.cancelled, commit.source)


def _listen(
    bind: str, port: int, kinds: Sequence[socket.SocketKind]
) -> dict[socket.SocketKind, socket.socket]:
    """Opens one socket of each kind, all at one port; port 0 takes a port that is free for all.

    During the search, a socket at a port that is free for one kind only stays open, so that the
    system does not offer this port again.
    """
    with contextlib.ExitStack() as held:
        for tries_left in reversed(range(_PORTS_TRIED)):
            sockets: dict[socket.SocketKind, socket.socket] = {}
            try:
                for kind in kinds:
                    chosen = [other.getsockname()[1] for other in sockets.values()]
                    sockets[kind] = _bound(kind, bind, chosen[0] if chosen else port)
                break
            except DeviceError:
                for opened in sockets.values():
                    held.callback(opened.close)
                if port != 0 or not sockets or not tries_left:
                    raise
    return sockets


def _bound(kind: socket.SocketKind, bind: str, port: int) -> socket.socket:
    """Opens a socket at an address; `recvfrom` of a UDP socket waits for at most `_TICK`."""
    sock = socket.socket(socket.AF_INET, kind)
    try:
        if kind == socket.SOCK_DGRAM:
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, _SOCKET_BUFFER)
            sock.settimeout(_TICK)
        elif os.name == "posix":  # elsewhere two programs could share the port
            sock.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        sock.bind((bind, port))
        if kind == socket.SOCK_STREAM:
            sock.listen()  # from here on no other program gets the port
    except (OSError, OverflowError, UnicodeError) as error:
        sock.close()
        raise DeviceError(
            f"this address cannot be listened on: {error}",
            where=f"{'UDP' if kind == socket.SOCK_DGRAM else 'TCP'} {bind}:{port}",
            expected="an IPv4 address of this machine and a free port from 0 to 65535",
            remedy="Close the program that has the port, or choose another with --port"
            if isinstance(error, OSError) and error.errno == errno.EADDRINUSE
            else "0.0.0.0 means all addresses of this machine",
        ) from error
    return sock
