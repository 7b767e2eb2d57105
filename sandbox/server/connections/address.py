"""Finds the address at which a tablet in the same network can reach this machine."""

from __future__ import annotations

import ipaddress
import socket

from models.errors import DeviceError

LOOPBACK = "127.0.0.1"


def local_network_address() -> str:
    """The IPv4 address of the network card that connects to other machines.

    Raises:
        DeviceError: This machine is not connected to a network.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            # Connecting a datagram socket sends nothing; it only chooses the card. The address is
            # reserved for documentation (RFC 5737).
            probe.connect(("192.0.2.1", 9))
            address = str(probe.getsockname()[0])
        except OSError:
            address = "0.0.0.0"
    if ipaddress.ip_address(address).is_unspecified or ipaddress.ip_address(address).is_loopback:
        raise DeviceError(
            "this machine is not in a network that a tablet could join",
            where="--tablet",
            remedy="Join a Wi-Fi network, or give the address by --lan ADDRESS",
        )
    return address


def checked_address(text: str) -> str:
    """Checks an IP address to bind.

    Raises:
        DeviceError: The text is not an IP address, or means all network cards.
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
            remedy="`--tablet` finds it",
        )
    return str(address)
