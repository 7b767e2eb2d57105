"""Options of the device `evdev`."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, kw_only=True)
class EvdevOptions:
    """How a touch screen or trackpad of this Linux machine is opened."""

    grab: bool = False
    """The touches are hidden from the desktop, so that a trackpad does not move the pointer."""
