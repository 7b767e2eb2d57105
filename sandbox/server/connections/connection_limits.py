"""Connection limits: a flood of unauthenticated connections cannot exhaust this machine.

A connection that has not sent the token yet is unauthenticated. A few of them are allowed; when one
more comes, the oldest is closed: our page sends its token within milliseconds, an attacker who only
occupies connections never does. Authenticated connections have their own limit. An address that
connects too often is rejected before its request is read, since reading takes a millisecond.
"""

from __future__ import annotations

import asyncio
import time

from websockets.asyncio.server import ServerConnection

from sandbox.server.connections.counters import Counters
from sandbox.server.connections.page_connection import PageConnection
from sandbox.server.connections.rate import Allowance

MOST_UNAUTHENTICATED = 64
"""Largest number of unauthenticated connections; at 1000 new ones a second each has 64 ms."""
MOST_AUTHENTICATED = 32
"""Largest number of authenticated connections: sockets of pages, and requests for files."""

ARRIVALS_PER_SECOND, ARRIVALS_AT_ONCE = 50.0, 150.0
"""Rate limit of connections from one address; loading a page needs five."""
MOST_ADDRESSES = 256
"""Number of addresses whose connections are counted; the oldest is forgotten first."""


class ConnectionLimits:
    """Tracks and limits connections; runs in the server's thread.

    Args:
        counters: Counters of rejected connections.
    """

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._arrivals: dict[str, Allowance] = {}
        # In order of arrival; True once its request was judged, and so counted.
        self._unauthenticated: dict[ServerConnection, bool] = {}
        self._authenticated: set[ServerConnection] = set()

    def __len__(self) -> int:
        return len(self._unauthenticated) + len(self._authenticated)

    def accepts(self, address: str, now: float) -> bool:
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

    def add(self, connection: ServerConnection) -> None:
        """Adds a new, unauthenticated connection; closes the oldest if there are too many."""
        self._unauthenticated[connection] = False
        if len(self._unauthenticated) > MOST_UNAUTHENTICATED:
            oldest = next(iter(self._unauthenticated))
            if not self._unauthenticated.pop(oldest):
                # Counted here, and not again when the connection ends.
                self._counters.add("pushed out by others")
            oldest.transport.abort()

    def judge(self, connection: ServerConnection) -> bool:
        """Notes that a connection's request is judged now, which counts it; False if it was closed
        in favour of others before, and so has been counted."""
        if connection not in self._unauthenticated:
            return False
        self._unauthenticated[connection] = True
        return True

    def authenticate(self, connection: ServerConnection) -> bool:
        """Marks a connection that sent the token; False if it was closed or there is no room.

        A connection that was closed in favour of others may have sent its request before. It must
        not be added again, since `remove` will not be called for it a second time.
        """
        if connection not in self._unauthenticated:
            return False
        del self._unauthenticated[connection]
        if len(self._authenticated) >= MOST_AUTHENTICATED:
            return False
        self._authenticated.add(connection)
        return True

    def remove(self, connection: ServerConnection) -> None:
        """Removes a connection that has ended."""
        self._authenticated.discard(connection)
        # A request that was judged has been counted with its reason.
        if self._unauthenticated.pop(connection, True) is False:
            self._counters.add("failed handshake")


def limited_connection(limits: ConnectionLimits) -> type[PageConnection]:
    """A connection class for `websockets.serve` that enforces these limits."""

    class LimitedConnection(PageConnection):
        _accepted = True

        def connection_made(self, transport: asyncio.BaseTransport) -> None:
            peer = transport.get_extra_info("peername") or ("",)
            self._accepted = limits.accepts(str(peer[0]), time.monotonic())
            if self._accepted:
                super().connection_made(transport)
                limits.add(self)
            else:
                transport.abort()  # type: ignore[attr-defined]

        def connection_lost(self, exc: Exception | None) -> None:
            if self._accepted:
                limits.remove(self)
                super().connection_lost(exc)

    return LimitedConnection
