"""The border of the screen: whether a hand is on it, and where it has to stop."""

from __future__ import annotations

import numpy as np

from models.arithmetic.arrays import Array
from models.surface import Surface

EDGE = 0.003
"""m, least distance of a finger from the border of the screen."""


def beyond_border(places: Array, surface: Surface) -> float:
    """Distance in m by which fingers at places (n, 2) m would have to touch beyond the border."""
    xy = _on_surface(places, surface)
    return float(max(EDGE - min(xy.min(), (surface.size - xy).min()), 0.0))


def stopped_at_border(places: Array, surface: Surface) -> Array:
    """Places (n, 2) m, moved together so far that no finger is beyond the border."""
    xy = _on_surface(places, surface)
    inwards = np.maximum(EDGE - xy.min(axis=0), 0.0)
    inwards -= np.maximum(xy.max(axis=0) - (surface.size - EDGE), 0.0)
    return surface.to_world(xy + inwards)[:, :2] if inwards.any() else places


def _on_surface(places: Array, surface: Surface) -> Array:
    return surface.to_surface(np.column_stack([places, np.zeros(len(places))]))
