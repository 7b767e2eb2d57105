"""Warmth and brightness of the skin at every vertex, instead of a texture.

Warmth (0 to 1) is high where blood shows through: at fingertips and knuckles, and on the palmar
side. Brightness (0 to 1) is high except in creases and in the shadow of other flesh.
"""

from __future__ import annotations

import numpy as np

from models.arithmetic import Array
from training.skin.field import HandField
from training.skin.shapes import step

CREASE_DARKNESS = 0.44
"""Loss of brightness in the deepest crease."""
DEEPEST = 0.0006
"""Depth (m) of the deepest crease."""
HOLLOWS = ((0.0025, 0.30), (0.006, 0.25), (0.012, 0.18))
"""Distances (m) from the skin within which other flesh casts a shadow, each with the largest loss
of brightness by this shadow."""


def tone_of(field: HandField, vertices: Array, normals: Array) -> Array:
    """Warmth and brightness (n, 2), 0 to 1, of points on the skin."""
    return np.stack(
        [_warmth(field, vertices, normals), _brightness(field, vertices, normals)], axis=1
    )


def _warmth(field: HandField, p: Array, out: Array) -> Array:
    # The palmar side is a little warm, except for the wrist.
    warm = 0.26 * step(-out[:, 2], 0.0, 0.8) * step(p[:, 1], 0.004, 0.030)

    def near(place: Array, reach: float, strength: float) -> None:
        nonlocal warm
        warm = np.maximum(
            warm, strength * np.exp(-np.sum((p - place) ** 2, axis=1) / (2 * reach**2))
        )

    for finger, chain in enumerate(field.fingers):
        last = chain[-1]
        near(last.at(0, 1.0, -0.2), 0.0085, 0.80)
        if finger == 0:
            near(chain[1].at(0, 0.0, 0.7), 0.0085, 0.50)
            near(chain[1].at(0, 0.5, 0.7), 0.0065, 0.62)
            continue
        near(chain[0].at(0, 0.0, 1.0), 0.0075, 0.55)
        near(chain[1].at(0, 0.0, 0.8), 0.0060, 0.72)
        near(chain[2].at(0, 0.0, 0.8), 0.0045, 0.55)
    near(field.fingers[0][0].at(0.4, 0.45, -1.0), 0.013, 0.40)
    near(np.array([0.034, 0.040, -0.018]), 0.015, 0.38)
    return np.clip(warm, 0.0, 1.0)


def _brightness(field: HandField, p: Array, out: Array) -> Array:
    bright = np.ones(len(p))
    for reach, most in HOLLOWS:
        free = np.clip(field(p + reach * out) / reach, 0.0, 1.0)
        bright *= 1.0 - most * (1.0 - free)
    crease = field.relief(p) / DEEPEST
    return np.clip(bright * (1.0 - CREASE_DARKNESS * crease), 0.0, 1.0)
