"""The touch rectangle of screens, from the sizes that their pages report."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from sandbox.server.protocol.protocol import Screen

LARGEST = (10.32, 7.74)
"""in, of the touch rectangle: that of the largest tablets. On a larger screen it lies in the
middle, since a hand reaches no further."""


def rectangle(screen: Screen, hands: int = 1) -> dict[str, Any]:
    """The touch rectangle of a screen, as settings: all of it, up to the largest tablet's.

    Two hands on it have the width of two tablets.
    """
    inches = (screen.width_px / screen.px_per_in, screen.height_px / screen.px_per_in)
    most = (hands * LARGEST[0], LARGEST[1])
    size = tuple(round(min(side, end), 4) for side, end in zip(inches, most, strict=True))
    return {"surface_in": size, "surface_calibrated": screen.calibrated}


def common(rectangles: Sequence[dict[str, Any]]) -> dict[str, Any]:
    """The touch rectangle that all of some screens have room for, as settings."""
    sizes = [r["surface_in"] for r in rectangles]
    return {
        "surface_in": tuple(min(sides) for sides in zip(*sizes, strict=True)),
        "surface_calibrated": all(r["surface_calibrated"] for r in rectangles),
    }
