"""Finds the address of this machine that a tablet in the same network can reach."""

from __future__ import annotations

import ipaddress
import socket

from models.errors import DeviceError

LOOPBACK = "127.0.0.1"


def local_network_address() -> str:
    """The IPv4 address of the network card that other machines are reached through.

    Raises:
        DeviceError: This machine is in no network.
    """
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            # Connecting a datagram socket sends nothing; it only chooses the card. The address is
            # one of those set aside for documentation (RFC 5737), so nobody has it.
            probe.connect(("192.0.2.1", 9))
            address = str(probe.getsockname()[0])
        except OSError:
            address = "0.0.0.0"
    if ipaddress.ip_address(address).is_unspecified or ipaddress.ip_address(address).is_loopback:
        raise DeviceError(
            "this machine is in no network that a tablet could share",
            where="--tablet",
            remedy="Join a Wi-Fi network, or say the address by --lan ADDRESS",
        )
    return address


def checked_address(text: str) -> str:
    """An IP address to bind.

    Raises:
        DeviceError: It is none, or means every card at once.
    """
    try:
        address = ipaddress.ip_address(text)
    except ValueError:
        raise DeviceError(
            "this is no IP address", where="--lan", got=text, expected="such as 192.168.1.20"
        ) from None
    if address.is_unspecified:
        raise DeviceError(
            "the page is served on one address, not on all of them",
            where="--lan",
            got=text,
            expected="the address of one network card",
            remedy="`--tablet` finds it",
        )
    return str(address)
