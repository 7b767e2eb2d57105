"""The touch rectangle of screens, from the sizes that their pages report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sandbox.server.protocol.protocol import LIFT_STRIP_PX, PageScreen

LARGEST = (10.32, 7.74)
"""in, largest touch rectangle, that of the largest tablets. On a larger screen it lies in the
centre, since a hand does not reach further."""


def room(screen: PageScreen, lifts: bool = False) -> tuple[float, float]:
    """Width and height of a screen that a touch rectangle may take, inches.

    Args:
        screen: The screen.
        lifts: True for a task that lifts: the lift control stands beside the rectangle.
    """
    width = max(screen.width_px - (LIFT_STRIP_PX if lifts else 0.0), 1.0)
    return width / screen.px_per_in, screen.height_px / screen.px_per_in


def rectangle(screen: PageScreen, hands: int = 1, lifts: bool = False) -> dict[str, Any]:
    """The touch rectangle of a screen, as settings: all its room, up to the largest tablet's.

    For two hands it may be as wide as two tablets. For `lifts` see `room`.
    """
    most = (hands * LARGEST[0], LARGEST[1])
    size = tuple(
        round(min(side, end), 4) for side, end in zip(room(screen, lifts), most, strict=True)
    )
    return {"surface_in": size, "surface_calibrated": screen.calibrated}


def common(rectangles: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The largest touch rectangle that fits on all of some screens, as settings."""
    sizes = [r["surface_in"] for r in rectangles]
    return {
        "surface_in": tuple(min(sides) for sides in zip(*sizes, strict=True)),
        "surface_calibrated": all(r["surface_calibrated"] for r in rectangles),
    }
