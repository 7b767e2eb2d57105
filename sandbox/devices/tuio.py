"""Touch surfaces and tablet apps that send TUIO 1.1 over UDP.

One thread and one plain socket: a thread per packet, as ready-made OSC servers have it, neither
keeps the order of packets nor keeps up with a few thousand of them a second.
"""

from __future__ import annotations

import errno
import socket
import threading
import time
from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from types import TracebackType
from typing import Self

from models.errors import DeviceError
from models.frames import Contact, TouchFrame
from models.surface import Surface
from sandbox.devices.tuio11 import Commit, SourceStatus, Statistics, Tuio11

DEFAULT_PORT = 3333
"""The UDP port that TUIO senders use unless told otherwise."""

LOOPBACK = "127.0.0.1"

QUEUE_FRAMES = 2048
"""Frames that wait for `poll`: 17 seconds of a device of 120 Hz."""

_TICK = 0.1
"""Seconds between two looks for silent sources and for `close`, when no packet comes."""

_SOCKET_BUFFER = 1 << 20
"""Bytes that the system is asked to keep for us while the thread is busy."""


class TuioDevice:
    """A UDP port on which any number of TUIO 1.1 senders report touches.

    All senders share the surface, so every frame holds the touches of all of them; their ids are
    made unique. What is wrong with packets is counted in `statistics`, never raised.

    Args:
        surface: Gives the size of what the senders call 0 to 1.
        bind: IPv4 address of the network card to listen on. The default can only be reached from
            this machine; 0.0.0.0 listens to everybody who can reach it.
        port: UDP port; 0 lets the system choose, and `port` tells which.
        stale_after: Seconds of silence after which the touches of a source are lifted.
        queue_frames: Frames kept for `poll`; when full, the oldest is dropped and counted.

    Raises:
        DeviceError: The port is taken, or the address is not one of this machine.
    """

    name = "tuio"

    def __init__(
        self,
        surface: Surface,
        *,
        bind: str = LOOPBACK,
        port: int = DEFAULT_PORT,
        stale_after: float = 2.0,
        queue_frames: int = QUEUE_FRAMES,
    ) -> None:
        if not 0.0 < stale_after < float("inf"):
            raise DeviceError(
                "a source cannot be stale after this time", got=stale_after, expected="seconds > 0"
            )
        if queue_frames < 1:
            raise DeviceError(
                "the queue must hold a frame at least", got=queue_frames, expected="1 or more"
            )
        self._surface = surface
        self._tuio = Tuio11(stale_after)
        self._queue: deque[TouchFrame] = deque(maxlen=queue_frames)
        self._dropped = 0
        self._failure: DeviceError | None = None
        self._closing = threading.Event()
        self._news = threading.Condition()
        self._socket = _listen(bind, port)
        self.bind, self.port = self._socket.getsockname()
        self._start = time.monotonic()
        self._thread = threading.Thread(target=self._receive, name="tuio", daemon=True)
        self._thread.start()

    @property
    def address(self) -> str:
        """Where it listens, as HOST:PORT."""
        return f"{self.bind}:{self.port}"

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
            return not self._queue and not self._thread.is_alive()

    def poll(self, now: float = 0.0) -> Sequence[TouchFrame]:
        """Every frame committed since the last call, oldest first; `now` is ignored.

        Raises:
            DeviceError: The socket has failed since, and all frames before that were fetched.
        """
        with self._news:
            frames = list(self._queue)
            self._queue.clear()
            if not frames and self._failure is not None:
                raise self._failure
        return frames

    def wait(self, timeout: float) -> bool:
        """Blocks until `poll` has something to say, at most `timeout` seconds."""
        with self._news:
            return self._news.wait_for(
                lambda: bool(self._queue) or self._failure is not None, timeout
            )

    def close(self) -> None:
        """Stops listening; frames received before can still be polled."""
        self._closing.set()
        self._thread.join()
        self._socket.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def _receive(self) -> None:
        """The thread: takes packets until closed."""
        try:
            next_look = 0.0
            while not self._closing.is_set():
                try:
                    data, (host, port) = self._socket.recvfrom(65_536)
                except TimeoutError:
                    data = None
                now = time.monotonic() - self._start
                with self._news:
                    commits = [] if data is None else self._tuio.feed(data, f"{host}:{port}", now)
                    if now >= next_look:
                        commits += self._tuio.expire(now)
                        next_look = now + _TICK
                    self._publish(commits, now)
        except Exception as error:  # a thread must not die unheard: the next poll raises this
            with self._news:
                self._failure = DeviceError(
                    f"listening to touches has failed: {error}",
                    where=f"UDP {self.address}",
                    remedy="Start again; if it stays, check the network connection",
                )
                self._failure.__cause__ = error
                self._news.notify_all()

    def _publish(self, commits: list[Commit], now: float) -> None:
        for commit in commits:
            self._dropped += len(self._queue) == self._queue.maxlen
            self._queue.append(touch_frame(commit, self._surface, now))
        if commits:
            self._news.notify_all()


def touch_frame(commit: Commit, surface: Surface, now: float) -> TouchFrame:
    """A frame in metres from touches in 0..1 of the surface.

    Touches of a silent source leave like lifted ones, not as cancelled: the likeliest story is a
    lifted finger whose last packet was lost, and what it held must be let go of.
    """
    width, height = (float(length) for length in surface.size)
    contacts = tuple(
        Contact(touch.id, touch.x * width, touch.y * height) for touch in commit.touches
    )
    return TouchFrame(now, contacts, source=commit.source)


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
