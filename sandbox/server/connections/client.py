"""A connected page: its messages, its message credit and its rate limit."""

from __future__ import annotations

import asyncio
import contextlib
from collections import deque
from collections.abc import Callable, Sequence

from websockets.exceptions import ConnectionClosed

from models.errors import InputError
from sandbox.server.connections.counters import Counters
from sandbox.server.connections.page_connection import PageConnection
from sandbox.server.connections.rate import Allowance
from sandbox.server.protocol.frames import number_frame
from sandbox.server.protocol.protocol import CREDIT, Hello, PageScreen, Up, decode

MESSAGES_PER_SECOND, BURST = 240.0, 1200.0
"""Rate limit; touches at 120 Hz, acknowledgements at 60 Hz and beats are 185 messages a second.
When a network stalls, a page goes on for 4 s before it gives up its socket; all that it has said
then comes at once."""
PATIENCE, FORGIVEN = 240.0, 1.0
"""Number of refused messages after which the connection is closed, and how many of them are
forgiven in a second."""
MOST_WAITING = 512
"""Number of messages that wait for a page that does not read, echoes of minutes; then the
connection is aborted."""


class Client:
    """A connected page, its message credit and its position in the stream of frames.

    Args:
        connection: The open connection.
        counters: Counters of refusals.
        clock: Monotonic clock, s.

    Attributes:
        hello: The page's hello message; None before it.
        screen: Current size of its screen.
        player: True if its touches are used.
        heard: s, time of its last message.
        here: False while the page says that it is hidden or turned away.
        menu: True while its player has a menu open.
        missed: True if its last message was refused unread, as too many came.
    """

    def __init__(
        self, connection: PageConnection, counters: Counters, clock: Callable[[], float]
    ) -> None:
        self.connection = connection
        self.hello: Hello | None = None
        self.screen: PageScreen | None = None
        self.player = False
        self.heard = clock()
        self.here, self.missed, self.menu = True, False, False
        self._hidden = self.heard
        self._clock = clock
        self._counters = counters
        self._allowance = Allowance(MESSAGES_PER_SECOND, BURST, self.heard)
        self._patience = Allowance(FORGIVEN, PATIENCE, self.heard)
        self._waiting: deque[tuple[bytes, bool]] = deque()
        self._skins: tuple[bytes, ...] = ()
        self._newest: bytearray | None = None
        self._aborted = False
        self._sent = self._acknowledged = 0
        self._full = asyncio.Event()
        self._parting: asyncio.Task[None] | None = None
        self.sent_at: dict[int, float] = {}

    @property
    def stale(self) -> int:
        """Number of sent frames that are not acknowledged."""
        return self._sent - self._acknowledged

    @property
    def seen(self) -> float:
        """s, time at which its person was last able to play."""
        return self.heard if self.here else self._hidden

    def appear(self, here: bool) -> None:
        """Takes in whether the page can be played now."""
        if self.here and not here:
            self._hidden = self._clock()
        self.here = here

    def say(self, message: bytes, text: bool = True) -> None:
        """Queues a JSON message, or bytes; all are sent, in order, before any later frame."""
        if len(self._waiting) < MOST_WAITING:
            self._waiting.append((message, text))
            self._flush()
        elif not self._aborted:
            self._aborted = True
            self._counters.add("page that does not read")
            self.connection.transport.abort()

    def dress(self, skins: Sequence[bytes]) -> None:
        """Queues the hands' skins that the page does not have already."""
        for skin in skins:
            if skin and skin not in self._skins:
                self.say(skin, text=False)
        self._skins = tuple(skins)

    def offer(self, frame: bytearray | None) -> None:
        """Queues the newest frame, in place of an older one that has not been sent."""
        self._newest = frame
        self._flush()

    def got(self, number: int) -> float | None:
        """Returns the credit of a frame and of those before it.

        Returns:
            s since the frame was sent; None if unknown or acknowledged before.
        """
        if not self._acknowledged < number <= self._sent:
            return None
        self._acknowledged = number
        at = self.sent_at.get(number)
        self.sent_at = {n: t for n, t in self.sent_at.items() if n > number}
        self._flush()
        return None if at is None else self._clock() - at

    @property
    def parted(self) -> bool:
        """True once we have closed the connection."""
        return self._parting is not None

    def part(self, code: int, reason: str) -> None:
        """Starts to close the connection, without waiting for the end."""
        if self._parting is None:
            self._parting = asyncio.create_task(self.connection.close(code, reason))

    async def write(self) -> None:
        """Sends waiting messages until cancelled; a page that does not read delays only itself."""
        with contextlib.suppress(ConnectionClosed):
            while True:
                await self._full.wait()
                self._full.clear()
                while following := self._following():
                    message, text = following
                    await self.connection.send(message, text=text)

    def _flush(self) -> None:
        """Sends waiting messages as far as the socket accepts them at once."""
        while self.connection.free:
            following = self._following()
            if following is None:
                return
            self.connection.send_now(*following)
        self._full.set()

    def _following(self) -> tuple[bytes, bool] | None:
        """The next message to send, and whether it is text; None if there is none now."""
        if self._waiting:
            return self._waiting.popleft()
        if self._newest is None or self.stale >= CREDIT:
            return None
        frame, self._newest = self._newest, None
        self._sent += 1
        self.sent_at[self._sent] = self._clock()
        return number_frame(frame, self._sent), False

    def read(self, message: str | bytes) -> Up | None:
        """Checks a message; returns None if it is refused.

        Raises:
            InputError: Too many messages were refused, so the sender is not one of our pages.
        """
        self.heard = self._clock()
        reason, up = "", None
        self.missed = not self._allowance.take(self.heard)
        if self.missed:
            reason = "too many messages"
        elif isinstance(message, bytes):
            reason = "binary message"
        else:
            try:
                up = decode(message)
            except InputError:
                reason = "malformed message"
        if reason:
            self._counters.add(reason)
            if not self._patience.take(self.heard):
                raise InputError("the client sent too many invalid messages", got=reason)
        return up
