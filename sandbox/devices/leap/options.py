"""Options of the device `leap`."""

from __future__ import annotations

from dataclasses import dataclass

DEFAULT_ADDRESS = "ws://127.0.0.1:6437/v6.json"
"""WebSocket address of a service on this machine."""


@dataclass(frozen=True)
class LeapOptions:
    """How a Leap's service is reached."""

    leap: str = DEFAULT_ADDRESS
    """WebSocket address of leapd or of the Ultraleap bridge."""
