"""Colours of the hand, the same in films, windows, pages and files. sRGB, 0 to 1."""

from __future__ import annotations

import numpy as np

from models.arithmetic import Array

Colour = tuple[float, float, float]

PALE: Colour = (0.910, 0.735, 0.630)
WARM: Colour = (0.880, 0.560, 0.470)
SHADE: Colour = (0.62, 0.42, 0.36)
"""Colours of skin, of skin where blood shows through, and the factor on either in a deep crease."""
NAIL: Colour = (0.93, 0.71, 0.65)
CUFF: Colour = (0.93, 0.94, 0.95)
SLEEVE: Colour = (0.16, 0.20, 0.27)


def tone_colours(tone: Array) -> Array:
    """Colours (..., 3) of skin tones (..., 2): warmth and brightness, 0 to 1."""
    pale, warm, shade = (np.array(c) for c in (PALE, WARM, SHADE))
    lit = pale + (warm - pale) * tone[..., :1]
    # Shadow in flesh is not grey: light that went through it comes out red.
    return np.asarray(lit * (1.0 - (1.0 - tone[..., 1:]) * (1.0 - shade)))


def linear(colour: Array) -> Array:
    """Converts sRGB values to linear light, both 0 to 1 (IEC 61966-2-1)."""
    return np.where(colour <= 0.04045, colour / 12.92, ((colour + 0.055) / 1.055) ** 2.4)
