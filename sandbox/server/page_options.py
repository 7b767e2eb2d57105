"""Options of commands that serve the browser page."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from cyclopts import Parameter

from sandbox.trial.headings import COMMON, PAGE


@dataclass(frozen=True, kw_only=True)
class PageOptions:
    """Options of the page's server."""

    tablet: Annotated[bool, Parameter(group=COMMON)] = False
    """Play on a tablet in the same network: prints a QR code to scan. Same as --device web, on this
    machine's network address."""

    lan: Annotated[str | None, Parameter(group=PAGE, metavar="ADDRESS")] = None
    """Address on which the page is served, in place of the one that --tablet finds."""

    page_port: Annotated[int, Parameter(group=PAGE)] = 0
    """TCP port of the page; 0 takes a free one. With a fixed port the link stays the same, and an
    open page reconnects when the program is restarted."""

    tls_cert: Annotated[str | None, Parameter(group=PAGE, metavar="FILE")] = None
    """Certificate for https, with --tls-key. Tablets refuse self-signed certificates."""

    tls_key: Annotated[str | None, Parameter(group=PAGE, metavar="FILE")] = None
    """Key of the certificate."""

    @property
    def page_host(self) -> str:
        """Address on which the page is served."""
        from sandbox.server.address import LOOPBACK, checked_address, local_network_address

        if self.lan:
            return checked_address(self.lan)
        return local_network_address() if self.tablet else LOOPBACK
