"""Options of the device `webcam`; where the camera stands is a setting of the hand."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class WebcamOptions:
    """How a camera's page is opened."""

    mirrored: bool = False
    """The picture is a mirror's."""

    quiet: bool = False
    """The page's address is printed, and no browser is opened."""
