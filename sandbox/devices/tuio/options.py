"""Options of the device `tuio`."""

from __future__ import annotations

from dataclasses import dataclass

from sandbox.devices.tuio.tuio import DEFAULT_PORT, LOOPBACK, Transport
from sandbox.devices.tuio.tuio_streams import DEFAULT_WEBSOCKET_PORT


@dataclass(frozen=True)
class TuioOptions:
    """How TUIO senders are reached."""

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
