"""Options of commands that serve the page; the machine's address in the network; QR codes."""

from __future__ import annotations

import io
import ipaddress
import socket
from dataclasses import dataclass
from typing import Annotated

from cyclopts import Parameter

from models.errors import DeviceError
from sandbox.trial.trial_options import COMMON, PAGE

LOOPBACK = "127.0.0.1"


def local_network_address() -> str:
    """Returns the IPv4 address of the network card that connects to other machines.

    Raises:
        DeviceError: This machine is not connected to a network.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            # Connecting a datagram socket sends nothing; it only chooses the network card. The
            # address is reserved for documentation (RFC 5737).
            probe.connect(("192.0.2.1", 9))
            address = str(probe.getsockname()[0])
        except OSError:
            address = "0.0.0.0"
    if ipaddress.ip_address(address).is_unspecified or ipaddress.ip_address(address).is_loopback:
        raise DeviceError(
            "this machine is not connected to a network that a tablet could join",
            where="--tablet",
            remedy="Join a Wi-Fi network, or name the address with --lan ADDRESS",
        )
    return address


def checked_address(text: str) -> str:
    """Checks an IP address to bind.

    Raises:
        DeviceError: The text is not an IP address, or is the address of all network cards.
    """
    try:
        address = ipaddress.ip_address(text)
    except ValueError:
        raise DeviceError(
            "this is not an IP address", where="--lan", got=text, expected="such as 192.168.1.20"
        ) from None
    if address.is_unspecified:
        raise DeviceError(
            "the page can only be served on one address, not on all of them",
            where="--lan",
            got=text,
            expected="the address of one network card",
            remedy="`--tablet` finds this address",
        )
    return str(address)


def code(url: str) -> str:
    """Returns a QR code of a link in block characters, for a terminal of any background colour."""
    # Imported here, since most commands show no code.
    import segno

    out = io.StringIO()
    segno.make(url, error="m").terminal(out, compact=True, border=2)
    return out.getvalue()


def hints(host: str) -> list[str]:
    """Returns advice on settings of a tablet, and on a page that does not open."""
    if host == LOOPBACK:
        return ["Only this machine can open it; `--tablet` opens it for a tablet."]
    return [
        "iPad: switch off Settings > Multitasking & Gestures > Four & Five Finger Gestures, and "
        "set Display & Brightness > Auto-Lock to Never.",
        "If the page does not open: are both in the same Wi-Fi? Does a firewall on this machine "
        "block the port?",
    ]


@dataclass(frozen=True, kw_only=True)
class PageOptions:
    """Options of the page's server."""

    tablet: Annotated[bool, Parameter(group=COMMON)] = False
    """Play on a tablet in the same network: prints a QR code to scan. The same as --device web, but
    served on this machine's network address."""

    lan: Annotated[str | None, Parameter(group=PAGE, metavar="ADDRESS")] = None
    """Address on which the page is served, instead of the address that --tablet finds."""

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

        if self.lan:
            return checked_address(self.lan)
        return local_network_address() if self.tablet else LOOPBACK
