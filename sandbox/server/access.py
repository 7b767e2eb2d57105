"""Access to a page's server: checks of token, origin and host name, and limits of connections.

Any page in any browser of this machine can reach the server's address (on a tablet's network: any
device). So every request must contain the token from the link or QR code. A foreign `Host` is a
sign of DNS rebinding; a foreign `Origin` is that of a foreign page.

A tablet tries to reconnect as long as its page is open, and a restarted program has the same
address if the port is fixed. So the token of a fixed port is stored in a file that only this user
can read. If the file is deleted, the next start makes another token.

A connection is unauthenticated until it has sent the token. Only some unauthenticated connections
are allowed; a further one closes the oldest. The program's page sends its token within
milliseconds, but an attacker who occupies connections never does. Authenticated connections have
their own limit. An address that connects too often is rejected before its request is read, since
reading takes a millisecond.
"""

from __future__ import annotations

import asyncio
import hmac
import os
import re
import secrets
import threading
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import parse_qs, urlsplit

from websockets.asyncio.server import ServerConnection

from models.errors import InputError
from sandbox.server.protocol import Allowance

TOKEN_BYTES = 16
TOKEN_NAME = "token"
TOKENLESS = ("/", "/?role=spectator")
"""The only requests that are answered without a token: the page shows these addresses in the
address bar. The answer is a page that reads the token stored in its browser tab."""


@dataclass(frozen=True)
class Access:
    """Access rules of one server.

    Attributes:
        host: IP address to which the server is bound.
        port: Port of the server.
        secure: True if the server uses TLS.
        token: Token that a request must contain.
        names: Further host names of the machine.
    """

    host: str
    port: int
    secure: bool = False
    token: str = field(default_factory=lambda: secrets.token_urlsafe(TOKEN_BYTES))
    names: tuple[str, ...] = ()

    @property
    def hosts(self) -> frozenset[str]:
        """Accepted values of the `Host` header."""
        names = {self.host, *self.names}
        if self.host in ("127.0.0.1", "::1"):
            names.add("localhost")
        usual = 443 if self.secure else 80
        # An IPv6 address is in brackets; the scheme's default port may be left out.
        plain = {f"[{n}]" if ":" in n else n for n in names}
        return frozenset(
            {f"{n}:{self.port}" for n in plain} | (plain if self.port == usual else set())
        )

    @property
    def url(self) -> str:
        """The link that opens the page, with the token."""
        scheme = "https" if self.secure else "http"
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"{scheme}://{host}:{self.port}/?{TOKEN_NAME}={self.token}"

    def refusal(self, path: str, host: str | None, origin: str | None, socket: bool) -> str:
        """Returns the reason for refusing a request, in one word; empty if it is accepted.

        Args:
            path: The request's target, with its query.
            host: The `Host` header.
            origin: The `Origin` header; required only for a WebSocket.
            socket: True if the request asks for a WebSocket.
        """
        if host not in self.hosts:
            return "host"
        scheme = "https" if self.secure else "http"
        if origin is not None and origin not in {f"{scheme}://{h}" for h in self.hosts}:
            return "origin"
        if socket and origin is None:
            return "origin"
        return "" if self.knows_token(path) else "token"

    def is_return_page(self, path: str, socket: bool) -> bool:
        """True if a request without a token may get the page that reads the token in its tab."""
        return not socket and path in TOKENLESS

    def knows_token(self, path: str) -> bool:
        """True if a request's target contains the token."""
        try:
            given = parse_qs(urlsplit(path).query, max_num_fields=8).get(TOKEN_NAME, [""])
        except ValueError:
            return False
        return len(given) == 1 and hmac.compare_digest(given[0].encode(), self.token.encode())


_TOKEN = re.compile(r"[A-Za-z0-9_-]{20,64}")


def stored_token(path: Path) -> str:
    """Returns the token in a file; creates the file if it does not exist.

    Raises:
        InputError: The file has no token, can be read by other users, or cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        fresh = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
    except FileExistsError:
        return _read(path)
    except OSError as error:
        raise _not_stored(path, error) from None
    token = secrets.token_urlsafe(TOKEN_BYTES)
    try:
        with os.fdopen(fresh, "w", encoding="ascii") as file:
            file.write(token + "\n")
    except OSError as error:
        path.unlink(missing_ok=True)
        raise _not_stored(path, error) from None
    return token


def _not_stored(path: Path, error: OSError) -> InputError:
    return InputError(
        "the page's token cannot be stored",
        where=str(path),
        got=error.strerror,
        remedy="Leave out --page-port: then every start has a new token",
    )


def _read(path: Path) -> str:
    remedy = "Delete the file: the next start makes a new one"
    try:
        text, mode = path.read_text(encoding="ascii").strip(), path.stat().st_mode
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise InputError(
            "the page's token cannot be read", where=str(path), got=reason, remedy=remedy
        ) from None
    if os.name == "posix" and mode & 0o077:
        raise InputError("other users can read the page's token", where=str(path), remedy=remedy)
    if not _TOKEN.fullmatch(text):
        raise InputError("the file has no valid token", where=str(path), remedy=remedy)
    return text


class Counters:
    """Counts by reason; safe to use from all threads."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._counts: Counter[str] = Counter()

    def add(self, reason: str, n: int = 1) -> None:
        """Adds to the count of a reason."""
        with self._lock:
            self._counts[reason] += n

    def __getitem__(self, reason: str) -> int:
        with self._lock:
            return self._counts[reason]

    def as_dict(self) -> dict[str, int]:
        """Returns a copy, most frequent reason first."""
        with self._lock:
            return dict(self._counts.most_common())


MOST_UNAUTHENTICATED = 64
"""Largest number of unauthenticated connections; at 1000 new connections a second, each has 64 ms
to send the token."""
MOST_AUTHENTICATED = 32
"""Largest number of authenticated connections: sockets of pages, and requests for files."""

ARRIVALS_PER_SECOND, ARRIVALS_AT_ONCE = 50.0, 150.0
"""Rate limit of connections from one address; loading a page needs five."""
MOST_ADDRESSES = 256
"""Largest number of addresses whose connections are counted; the oldest is dropped first."""


class ConnectionLimits:
    """Tracks and limits connections; runs in the server's thread.

    Args:
        counters: Counters of rejected connections.
    """

    def __init__(self, counters: Counters) -> None:
        self._counters = counters
        self._arrivals: dict[str, Allowance] = {}
        # In order of arrival. True: the request was accepted or refused, and is already counted.
        self._unauthenticated: dict[ServerConnection, bool] = {}
        self._authenticated: set[ServerConnection] = set()

    def __len__(self) -> int:
        return len(self._unauthenticated) + len(self._authenticated)

    def accepts(self, address: str, now: float) -> bool:
        """True if a new connection from an address, at the time `now` (s), may be read."""
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
                # `remove` does not count it again, as it is no longer among the unauthenticated.
                self._counters.add("closed in favour of newer ones")
            oldest.transport.abort()

    def judge(self, connection: ServerConnection) -> bool:
        """Marks a connection whose request is now accepted or refused, and is therefore counted.

        Returns False if the connection was closed before, in favour of newer ones. It is then
        counted already.
        """
        if connection not in self._unauthenticated:
            return False
        self._unauthenticated[connection] = True
        return True

    def authenticate(self, connection: ServerConnection) -> bool:
        """Marks a connection that sent the token; False if it was closed or there are too many.

        The request of a connection may be processed after the connection was closed in favour of
        newer ones. Then it must not be added again, since `remove` is not called a second time.
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
        # Requests that were accepted or refused are already counted.
        if self._unauthenticated.pop(connection, True) is False:
            self._counters.add("failed handshake")


def limited_connection(limits: ConnectionLimits) -> type[ServerConnection]:
    """Returns a connection class for `websockets.serve` that enforces limits."""

    class LimitedConnection(ServerConnection):
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
