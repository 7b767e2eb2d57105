"""Connection limits: a flood of unauthenticated connections cannot exhaust this machine.

A connection that has not sent the token yet is unauthenticated. A few of them are allowed; when one
more comes, the oldest is closed: our page sends its token within milliseconds, an attacker who only
occupies connections never does. Connections with the token have a limit of their own. An address
that connects too often is rejected before its request is read, since reading takes a millisecond.
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
"""Number of addresses whose connections are counted; the oldest is forgotten first."""


class ConnectionLimits:
    """Tracks unauthenticated connections; runs in the server's thread.

    Args:
        counters: Counters of rejected connections.
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
        """True if a new connection from an address, at a time in s, is accepted for reading."""
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
            # A refused request has been counted with its reason.
            if connection.request is None:
                self._counters.add("failed handshake")


def watched(limits: ConnectionLimits) -> type[Attentive]:
    """A connection class for `websockets.serve` that keeps these limits."""

    class Watched(Attentive):
        _heard = True

        def connection_made(self, transport: asyncio.BaseTransport) -> None:
            peer = transport.get_extra_info("peername") or ("",)
            self._heard = limits.answers(str(peer[0]), time.monotonic())
            if self._heard:
                super().connection_made(transport)
                limits.come(self)
            else:
                transport.abort()  # type: ignore[attr-defined]

        def connection_lost(self, exc: Exception | None) -> None:
            if self._heard:
                limits.leave(self)
                super().connection_lost(exc)

    return Watched
