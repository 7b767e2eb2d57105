"""Sends commands to another program, which may be slow or not running, without blocking.

A separate thread owns one socket. There are two kinds of commands. Of the commands for moments,
only the newest is queued for each hand; older commands are dropped and counted. Orders are few, and
all of them are queued. After a lost connection the thread reconnects: at once if the other program
had accepted data, otherwise after increasing pauses.

Known behaviour of Maya's command port: it answers every command or none, and ends answers with a
newline and a zero byte. Up to Maya 2025 its thread can die *while answering*, after the command was
executed. Therefore answers are read and discarded. An answer, or the end of the connection, only
means that the next command may be sent. Without an answer, the next command is sent after
`patience`.
"""

from __future__ import annotations

import select
import socket
import threading
import time
from collections import Counter, deque
from collections.abc import Callable, Sequence

from models.errors import DeviceError, InputError

FIRST_PAUSE, LONGEST_PAUSE = 0.1, 2.0
"""Shortest and longest time (s) between attempts to connect; it doubles after each attempt."""
PATIENCE = 0.05
"""Time (s) to wait for an answer if there were answers before: three frames at 60 Hz."""
FIRST_PATIENCE = 1.0
"""Time (s) to wait for the answer to the greeting. The answer shows the kind of port."""
LINGER = 0.05
"""Time (s) to wait after the greeting's answer. A port that dies while answering closes within it.
"""
DEATH_PATIENCE = 5.0
"""Time (s) to wait for the end of a connection if the last connection ended with its first command.
"""
SEND_TIMEOUT = 2.0
"""Time (s) after which a program that accepts no data counts as disconnected."""
CONNECT_TIMEOUT = 2.0
"""Time (s) to wait for a connection."""
STOP_SLICE = 0.1
"""Time (s) between two checks for a request to end, during a wait."""
SMALL_BUFFER = 8192
"""Size of the system's send buffer in bytes; a larger one would only delay data."""
MOST_ORDERS = 16
"""Largest number of queued orders; a session has one order for each hand."""
_GREETING, _ORDER = "greeting", "order"

Moment = Callable[[], list[str]]
"""Function that makes the commands of one moment of a hand."""


def parse_address(text: str, default_host: str = "127.0.0.1") -> tuple[str, int]:
    """Parses `HOST:PORT`, `:PORT` or `PORT`.

    Raises:
        InputError: The text has none of these forms.
    """
    host, _, port = text.strip().rpartition(":")
    host = host.strip("[]") or default_host
    if (
        not port.isascii()
        or not port.isdecimal()
        or not 1 <= int(port) <= 65535
        or not _is_host(host)
    ):
        raise InputError(
            "not an address",
            where="--maya, --blender",
            got=text,
            expected="HOST:PORT, such as 127.0.0.1:7002",
        )
    return host, int(port)


def _is_host(host: str) -> bool:
    """True if a computer can have this name; False for example for a name with an empty part."""
    try:
        return bool(host.encode("idna"))
    except UnicodeError:
        return False


class Sender:
    """A connection that is opened again after every loss.

    Args:
        host: Host of the other program.
        port: TCP port.
        greeting: Commands sent first on every connection.
        patience: s, see `PATIENCE`.

    Attributes:
        trouble: The last error; empty without an error.
    """

    def __init__(
        self, host: str, port: int, greeting: Sequence[str] = (), patience: float = PATIENCE
    ) -> None:
        self.host, self.port = host, port
        self._greeting, self._patience = tuple(greeting), patience
        self._news = threading.Condition()
        self._newest: dict[str, Moment] = {}
        self._orders: deque[str] = deque()
        self._counts: Counter[str] = Counter()
        self._closing = False
        self._busy = self._answers = self._heard = self._dies = False
        self._said_again: set[str] = set()
        self._greeted = 0
        self.connected = threading.Event()
        self.trouble = ""
        self._thread = threading.Thread(target=self._run, name="stream", daemon=True)
        self._thread.start()

    @property
    def counts(self) -> dict[str, int]:
        """Numbers of sent and dropped moments, orders, connections and answers, by description."""
        with self._news:
            return dict(self._counts)

    def show(
        self, hand: str, moment: Moment, wait: float = 0.0, stop: threading.Event | None = None
    ) -> bool:
        """Queues a moment of a hand; an older moment in the queue is dropped.

        Args:
            hand: Name of the hand.
            moment: Function that makes the commands; it is called in the sender's thread, and only
                if the moment is sent.
            wait: Time to wait until the last moment is sent, s; 0 may drop it.
            stop: Event that ends the wait.

        Returns:
            True if no moment was dropped.
        """
        with self._news:
            until = time.monotonic() + wait
            while hand in self._newest and not (stop is not None and stop.is_set()):
                left = until - time.monotonic()
                if left <= 0.0:
                    break
                self._news.wait_for(lambda: hand not in self._newest, min(left, STOP_SLICE))
            free = hand not in self._newest
            if not free:
                self._counts["moments dropped"] += 1
            self._newest[hand] = moment
            self._news.notify_all()
        return free

    def order(self, command: str) -> None:
        """Queues a command that must not be lost; it is sent after the queued moments.

        Raises:
            DeviceError: Too many orders are queued.
        """
        with self._news:
            if len(self._orders) >= MOST_ORDERS:
                raise DeviceError("too many orders wait to be sent", where=self._where)
            self._orders.append(command)
            self._news.notify_all()

    def flush(self, seconds: float) -> bool:
        """Waits until everything is sent; returns False after a timeout."""
        with self._news:
            return self._news.wait_for(lambda: not (self._pending or self._busy), seconds)

    def close(self) -> None:
        """Ends connection and thread; queued commands are lost. May be called twice."""
        with self._news:
            self._closing = True
            self._news.notify_all()
        self._thread.join(timeout=5.0)

    @property
    def _where(self) -> str:
        return f"{self.host}:{self.port}"

    @property
    def _pending(self) -> bool:
        return bool(self._newest or self._orders)

    def _count(self, what: str, n: int = 1) -> None:
        with self._news:
            self._counts[what] += n

    def _run(self) -> None:
        pause = FIRST_PAUSE
        while not self._closing:
            commands = 0
            try:
                with socket.create_connection((self.host, self.port), CONNECT_TIMEOUT) as channel:
                    self._count("connections")
                    self._prepare(channel)
                    self.connected.set()
                    commands = self._talk(channel)
            except OSError as error:
                self.trouble = f"{type(error).__name__}: {error}"[:200]
            finally:
                self.connected.clear()
            if commands != 1:
                # The next connection may be to another program, which needs the greeting. But if
                # exactly one command was sent, it is to the same port, which dies while answering.
                # If this port got the greeting each time, no other command would ever be sent.
                self._greeted = 0
            if commands:
                pause = FIRST_PAUSE
                continue
            with self._news:
                self._news.wait_for(lambda: self._closing, pause)
            pause = min(2.0 * pause, LONGEST_PAUSE)

    def _prepare(self, channel: socket.socket) -> None:
        # Each command must be a separate packet: Maya may not understand merged or split commands.
        channel.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        channel.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, SMALL_BUFFER)
        channel.settimeout(SEND_TIMEOUT)

    def _talk(self, channel: socket.socket) -> int:
        """Sends until the connection ends; returns the number of commands sent."""
        sent = 0
        while True:
            with self._news:
                if self._closing:
                    return sent
                key, moment = self._take()
                if not key:
                    self._news.wait_for(lambda: self._pending or self._closing, 0.2)
            commands = moment()
            if not self._drain(channel):
                # The connection had ended before the commands were sent, so none is lost.
                self._give_back(key, commands)
                return sent
            for i, command in enumerate(commands):
                try:
                    alive = self._send(channel, command, key == _GREETING)
                except OSError:
                    self._give_back(key, commands[i:])
                    raise
                sent += 1
                if alive:
                    continue
                self._dies = sent == 1
                # If several commands were sent without an answer, it is unknown which of them the
                # other program executed. It does no harm to send the last command again, once.
                unsure = sent > 1 and not self._heard and key not in self._said_again
                self._said_again = {key} if unsure else set()
                self._give_back(key, commands[i if unsure else i + 1 :])
                self._done(key, commands if not unsure else [])
                return sent
            self._said_again.discard(key)
            self._done(key, commands)

    def _take(self) -> tuple[str, Moment]:
        """Chooses the next commands to send, with their kind or hand.

        Moments come before orders, since an order may end the display.
        """
        self._busy = True
        if self._greeted < len(self._greeting):
            self._greeted += 1
            return _GREETING, _ready([self._greeting[self._greeted - 1]])
        for key in self._newest:
            return key, self._newest.pop(key)
        if self._orders:
            return _ORDER, _ready([self._orders.popleft()])
        self._busy = False
        return "", _ready([])

    def _done(self, key: str, commands: list[str]) -> None:
        with self._news:
            self._busy = False
            if not commands:
                return
            if key != _GREETING:
                self._counts["orders sent" if key == _ORDER else "moments sent"] += 1
            self.trouble = ""
            self._news.notify_all()

    def _give_back(self, key: str, commands: list[str]) -> None:
        """Queues unsent commands again, unless there is a newer moment of the hand."""
        with self._news:
            self._busy = False
            if not commands:
                return
            self._news.notify_all()
            if key == _GREETING:
                self._greeted = 0
            elif key == _ORDER:
                self._orders.extendleft(reversed(commands))
            elif key in self._newest:
                self._counts["moments dropped"] += 1
            else:
                self._newest[key] = _ready(commands)
            self._news.notify_all()

    def _send(self, channel: socket.socket, command: str, first: bool) -> bool:
        """Sends a command, and reads an expected answer; True if the connection is open."""
        channel.sendall(command.encode("ascii") + b"\n")
        if self._dies:
            return self._drain(channel, DEATH_PATIENCE, DEATH_PATIENCE)
        if first:
            return self._drain(channel, FIRST_PATIENCE, LINGER)
        return self._drain(channel, self._patience if self._answers else 0.0)

    def _drain(self, channel: socket.socket, wait: float = 0.0, linger: float = 0.0) -> bool:
        """Reads and discards answers; returns False if the connection has ended.

        Args:
            channel: The socket.
            wait: s to wait for the first answer.
            linger: s to wait after an answer for the end of the connection.
        """
        until = time.monotonic() + wait
        self._heard = False
        while True:
            left = max(0.0, until - time.monotonic())
            readable, _, _ = select.select([channel], [], [], left)
            if not readable:
                if wait > 0.0 and not self._heard:
                    self._count("answers missing")
                return True
            try:
                data = channel.recv(65536)
            except ConnectionError as error:
                self.trouble = f"{type(error).__name__}: {error}"[:200]
                data = b""
            if not data:
                self._answers = True
                self._count("connections ended by the other side")
                return False
            self._count("bytes of answers thrown away", len(data))
            # Read further answers without waiting.
            self._answers = self._heard = True
            until = time.monotonic() + linger


def _ready(commands: list[str]) -> Moment:
    return lambda: commands
