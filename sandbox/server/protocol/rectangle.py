"""The touch rectangle of screens, from the sizes that their pages report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from models.surface import PRESETS
from sandbox.server.protocol.protocol import LIFT_STRIP_PX, PageScreen

LARGEST = (10.32, 7.74)
"""in, largest touch rectangle, that of the largest tablets. On a larger screen it lies in the
centre, since a hand does not reach further."""

LEAST = PRESETS["ipad2"]
"""in, touch rectangle that has room for every task."""


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
    return {"size_in": size, "calibrated": screen.calibrated}


def scaled(screen: PageScreen, lifts: bool = False) -> dict[str, Any]:
    """The touch rectangle of a screen that its table fills, whatever its inches, as settings.

    The table is as large as the largest tablet's where that leaves it at least as large as the
    paper's, so that every task fits; the result counts for a mouse, and not on a phone.
    """
    width, height = room(screen, lifts)
    (most_w, most_h), (least_w, least_h) = LARGEST, LEAST
    scale = min(max(width / most_w, height / most_h), width / least_w, height / least_h)
    size = min(width / scale, most_w), min(height / scale, most_h)
    return {
        "size_in": tuple(round(side, 4) for side in size),
        # At another scale there is no size that could be wrong.
        "calibrated": True,
        "scale": scale,
        "scored": screen.fit == "mouse",
    }


def common(rectangles: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The largest touch rectangle that fits on all of some screens, as settings."""
    sizes = [r["size_in"] for r in rectangles]
    return {
        "size_in": tuple(min(sides) for sides in zip(*sizes, strict=True)),
        "calibrated": all(r["calibrated"] for r in rectangles),
    }
