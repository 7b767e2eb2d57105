"""Access control: requests need the server's token, its own origin and its own host name.

Any page in any browser of this machine can reach the server's address (on a tablet's network: any
device). So every request has to carry the token from the link or QR code. A foreign `Host` means
DNS rebinding, a foreign `Origin` a foreign page.
"""

from __future__ import annotations

import hmac
import secrets
from dataclasses import dataclass, field
from urllib.parse import parse_qs, urlsplit

TOKEN_BYTES = 16
TOKEN_NAME = "token"
TOKENLESS = ("/", "/?role=spectator")
"""The only requests that are answered without a token: the addresses that the page leaves in the
address bar. They get a page that knows nothing but how to find the token in its own tab."""


@dataclass(frozen=True)
class Access:
    """Access rules of one server.

    Attributes:
        host: IP address that the server is bound to.
        port: Its port.
        secure: True if it uses TLS.
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
        """Reason for refusing a request, in one word; empty if it is accepted.

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

    def asks_to_return(self, path: str, socket: bool) -> bool:
        """True if a request without a token may get the page that finds back by itself."""
        return not socket and path in TOKENLESS

    def knows_token(self, path: str) -> bool:
        """True if a request's target contains the token."""
        try:
            given = parse_qs(urlsplit(path).query, max_num_fields=8).get(TOKEN_NAME, [""])
        except ValueError:
            return False
        return len(given) == 1 and hmac.compare_digest(given[0].encode(), self.token.encode())
