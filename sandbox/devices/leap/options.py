"""Options of the device `leap`."""

from __future__ import annotations

from dataclasses import dataclass

from sandbox.devices.leap.leap import DEFAULT_ADDRESS


@dataclass(frozen=True)
class LeapOptions:
    """How a Leap's service is reached."""

    leap: str = DEFAULT_ADDRESS
    """WebSocket address of leapd or of the Ultraleap bridge."""
