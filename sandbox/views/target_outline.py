"""Outline of where a hand should be, while something holds it back.

Only parts that are visibly away from their place are outlined, and only beside the hand itself: a
line across the skin would look like a stain.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageChops, ImageDraw, ImageFilter

from models.arithmetic import Array
from sandbox.views import palette
from sandbox.views.lens import Lens

LINE = 1 / 180
"""Width of the line in heights of the picture."""
SPECK = 3
"""px; a thinner piece is the rest of a triangle, not a part of the hand."""


def draw_outline(
    picture: Image.Image, lens: Lens, away: Sequence[Array], hands: Sequence[Array]
) -> Image.Image:
    """A picture with the outline of hands' parts where they should be.

    Args:
        picture: RGB.
        lens: The camera of the picture.
        away: Triangles (n, 3, 3) m of the parts at the places where they should be.
        hands: Triangles (n, 3, 3) m of the hands where they are.
    """
    parts = _silhouette(lens, away)
    parts = parts.filter(ImageFilter.MinFilter(SPECK)).filter(ImageFilter.MaxFilter(SPECK))
    if parts.getbbox() is None:
        return picture
    width = 2 * round(LINE * lens.size[1]) + 1
    line = ImageChops.subtract(parts.filter(ImageFilter.MaxFilter(width)), parts)
    line = ImageChops.subtract(line, _silhouette(lens, hands))
    out = picture.copy()
    out.paste(palette.bytes_of(palette.TARGET)[:3], mask=line)
    return out


def _silhouette(lens: Lens, meshes: Sequence[Array]) -> Image.Image:
    """Mask of triangles, 255 inside of them."""
    mask = Image.new("L", lens.size)
    pen = ImageDraw.Draw(mask)
    for triangles in meshes:
        pixels, ahead = lens.project(triangles)
        for corners in pixels[ahead.all(axis=1) & _towards(pixels)].reshape(-1, 6).tolist():
            pen.polygon(corners, fill=255)
    return mask


def _towards(pixels: Array) -> NDArray[np.bool_]:
    """(n,) whether triangles (n, 3, 2) px show their outer side: half of a closed surface does."""
    one, other = pixels[:, 1] - pixels[:, 0], pixels[:, 2] - pixels[:, 0]
    return np.asarray(one[:, 0] * other[:, 1] < one[:, 1] * other[:, 0])
