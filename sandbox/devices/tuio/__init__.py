"""TUIO: touch surfaces and tablet apps that send TUIO 1.1 or 2.0 over UDP, TCP or WebSocket."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from sandbox.devices.device import DeviceEntry, DeviceKind, Place

if TYPE_CHECKING:
    from sandbox.devices.tuio.tuio import Tap, TuioDevice

DEFAULT_PORT = 3333
"""Default UDP port of TUIO senders."""

DEFAULT_WEBSOCKET_PORT = 8080
"""Default port of TUIO over WebSockets."""

STALE_AFTER = 2.0
"""Default time (s) without a packet after which the touches of a TUIO sender are lifted."""

LOOPBACK = "127.0.0.1"

Transport = Literal["udp", "tcp", "websocket", "all"]
"""Transport of packets: each in a datagram, in a TCP stream after its length, or as a binary
message of a WebSocket."""


@dataclass(frozen=True, kw_only=True)
class TuioOptions:
    """Options of the connection to TUIO senders."""

    bind: str = LOOPBACK
    """Address on which this program listens: 127.0.0.1 from this machine only, 0.0.0.0 from the
    network."""

    port: int = DEFAULT_PORT
    """UDP and TCP port; 0 takes a free one."""

    tuio_transport: Transport = "udp"
    """Transport: udp, tcp, websocket, or all three."""

    websocket_port: int = DEFAULT_WEBSOCKET_PORT
    """TCP port for TUIO over WebSockets; 0 takes a free one."""

    tuio_connect: str = ""
    """Address of a sender that waits for connections, such as tcp://HOST:3333; empty to listen."""


def open_tuio(
    options: TuioOptions, place: Place, tap: Tap | None = None, stale_after: float = STALE_AFTER
) -> TuioDevice:
    """Opens the ports for TUIO senders.

    Args:
        options: Addresses, ports and transports.
        place: Surface of the device.
        tap: Called with every packet; see `TuioDevice`.
        stale_after: Time (s) without a packet after which the touches of a sender are lifted.

    Raises:
        DeviceError: A port is taken, or the address is not one of this machine.
    """
    from sandbox.devices.tuio.tuio import TuioDevice

    return TuioDevice(
        place.surface,
        bind=options.bind,
        port=options.port,
        transport=options.tuio_transport,
        websocket_port=options.websocket_port,
        connect=options.tuio_connect,
        stale_after=stale_after,
        tap=tap,
    )


def _on_next_ports(options: TuioOptions) -> TuioOptions:
    """Options for a second sender, with the next ports; port 0 remains 0."""
    return replace(
        options,
        port=options.port and options.port + 1,
        websocket_port=options.websocket_port and options.websocket_port + 1,
    )


DEVICE = DeviceEntry(
    "touch surfaces and tablet apps that send TUIO 1.1 or 2.0",
    open_tuio,
    TuioOptions,
    DeviceKind(guessed_size=True),
    for_second=_on_next_ports,
)
