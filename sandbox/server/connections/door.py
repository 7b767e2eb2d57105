"""How many may stand at the server's door at once: no flood of connections uses up this machine.

Whoever has not shown the token yet is a stranger. There is room for a few of them, and when one
more comes, the one that has stood there longest goes: a page of ours needs milliseconds to show
its token, those who only want to keep others out do not show any. Who has shown it is a guest. An
address that connects all the time is not even listened to, since listening takes a millisecond.
"""

from __future__ import annotations

import asyncio
import time

from websockets.asyncio.server import ServerConnection

from sandbox.server.connections.attentive import Attentive
from sandbox.server.connections.counters import Counters
from sandbox.server.connections.rate import Allowance

MOST_STRANGERS = 64
"""Connections without a valid request so far; at 1000 a second each has 64 ms."""
MOST_GUESTS = 32
"""Connections with the token: sockets of pages, and files that are being fetched."""

ARRIVALS_PER_SECOND, ARRIVALS_AT_ONCE = 50.0, 150.0
"""Connections from one address; a page that loads needs five."""
MOST_ADDRESSES = 256
"""Whose arrivals are remembered; the one that came first is forgotten first."""


class Door:
    """Knows who stands there; all of it runs in the server's thread.

    Args:
        counters: Of those who are sent away.
    """

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._arrivals: dict[str, Allowance] = {}
        # In the order in which they came; a dict is an ordered set.
        self._strangers: dict[ServerConnection, None] = {}
        self._guests: set[ServerConnection] = set()

    def __len__(self) -> int:
        return len(self._strangers) + len(self._guests)

    def answers(self, address: str, now: float) -> bool:
        """Whether somebody from an address who has just connected, at s, is listened to at all."""
        allowance = self._arrivals.get(address)
        if allowance is None:
            if len(self._arrivals) >= MOST_ADDRESSES:
                del self._arrivals[next(iter(self._arrivals))]
            allowance = Allowance(ARRIVALS_PER_SECOND, ARRIVALS_AT_ONCE, now)
            self._arrivals[address] = allowance
        if allowance.take(now):
            return True
        self._counters.add("too many connections")
        return False

    def come(self, connection: ServerConnection) -> None:
        """Somebody who is listened to."""
        self._strangers[connection] = None
        if len(self._strangers) > MOST_STRANGERS:
            oldest = next(iter(self._strangers))
            if oldest.request is None:
                # Counted here, and no second time when the connection is gone.
                self._counters.add("pushed out by others")
            del self._strangers[oldest]
            oldest.transport.abort()

    def let_in(self, connection: ServerConnection) -> bool:
        """Somebody has shown the token; whether it still stands here and there is room.

        Who was pushed out may have asked before. Nobody would hear of it leaving a second time,
        and its place would be taken for good.
        """
        if connection not in self._strangers:
            return False
        del self._strangers[connection]
        if len(self._guests) >= MOST_GUESTS:
            return False
        self._guests.add(connection)
        return True

    def leave(self, connection: ServerConnection) -> None:
        """A connection has ended."""
        self._guests.discard(connection)
        if connection in self._strangers:
            del self._strangers[connection]
            # A request that was refused has been counted with its reason.
            if connection.request is None:
                self._counters.add("failed handshake")


def watched(door: Door) -> type[Attentive]:
    """A kind of connection that goes through a door, for `websockets.serve`."""

    class Watched(Attentive):
        _heard = True

        def connection_made(self, transport: asyncio.BaseTransport) -> None:
            peer = transport.get_extra_info("peername") or ("",)
            self._heard = door.answers(str(peer[0]), time.monotonic())
            if self._heard:
                super().connection_made(transport)
                door.come(self)
            else:
                transport.abort()  # type: ignore[attr-defined]

        def connection_lost(self, exc: Exception | None) -> None:
            if self._heard:
                door.leave(self)
                super().connection_lost(exc)

    return Watched
