"""Reduces a window's drawing quality until it keeps up: fewer pixels, and no shadows."""

from __future__ import annotations

from math import sqrt

from sandbox.views.renderer import LARGEST, Renderer

MOST_PIXELS = 2_600_000
"""px, largest number of drawn pixels; in a larger window the picture is stretched. Above it,
copying pictures takes longer than drawing them."""
SLOW, PATIENCE = 0.045, 4
"""s for a picture, and number of slower pictures in a row after which the quality is reduced."""
PLAIN_SHRINK = 1.6
"""Factor by which the drawing is smaller than the window at reduced quality."""


class DrawingQuality:
    """Chooses the drawing quality from the duration of pictures."""

    def __init__(self) -> None:
        self._slow, self._shrink = 0, 1.0

    def size(self, width: int, height: int) -> tuple[int, int]:
        """px, size of the picture to draw for a window of a given size, px."""
        width, height = max(width, 16), max(height, 16)
        shrink = max(
            sqrt(width * height / MOST_PIXELS), width / LARGEST, height / LARGEST, self._shrink
        )
        return max(round(width / shrink), 16), max(round(height / shrink), 16)

    def took(self, seconds: float, renderer: Renderer) -> None:
        """Notes the duration of a picture; slow ones first disable shadows, then reduce pixels.

        Text stays sharp, as it is drawn over the stretched picture.
        """
        self._slow = self._slow + 1 if seconds > SLOW else 0
        if self._slow < PATIENCE:
            return
        self._slow = 0
        if renderer.shadows:
            renderer.shadows = False
        else:
            self._shrink = PLAIN_SHRINK
