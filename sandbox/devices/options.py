"""Options of devices that have no options of their own, and of files and outside devices."""

from __future__ import annotations

from dataclasses import dataclass

from tasks.user import UserConfiguration


@dataclass(frozen=True)
class NoOptions:
    """Options of a device without any."""


@dataclass(frozen=True)
class PlayedOptions:
    """Options of a file that is played, and of somebody's own device."""

    user: UserConfiguration | None = None
    """The simulated user who made the recording; None for a person, and where it is unknown."""
