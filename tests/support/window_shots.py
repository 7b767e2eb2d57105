"""What a window shows, and where a place of the surface is in it."""

from __future__ import annotations

import glfw
import numpy as np
from numpy.typing import ArrayLike
from PIL import Image

from sandbox.views.window import Window


def screenshot(window: Window) -> Image.Image:
    """The picture that the window shows now, RGB."""
    if window._picture is None:
        return window._blank(glfw.get_framebuffer_size(window._context.handle))
    return window._picture.copy()


def pixel_of(window: Window, xy: ArrayLike) -> tuple[float, float]:
    """Window coordinates of a point (2,) m on the surface, once the window has drawn a picture."""
    lens = window._renderer.lens if window._renderer else None
    assert lens is not None, "the window has drawn nothing yet"
    pixel, _ = lens.project(window._touched.to_world(xy))
    x, y = pixel / np.array(lens.size) * glfw.get_window_size(window._context.handle)
    return float(x), float(y)
