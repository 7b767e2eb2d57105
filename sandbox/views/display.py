"""Finds out whether a window can open, without loading drawing libraries; errors of graphics."""

from __future__ import annotations

import os
import sys

from models.errors import HandSandboxError

DEBIAN_PACKAGES = "libgl1 libegl1 libegl-mesa0 libgl1-mesa-dri libglx-mesa0"
"""Debian and Ubuntu packages that draw pictures without a graphics card."""

OPENGL_REMEDY = (
    f"On Debian or Ubuntu: apt-get install {DEBIAN_PACKAGES}"
    if sys.platform == "linux"
    else "Install the driver of the graphics card; over a remote desktop there is often no OpenGL"
)
"""Remedy for missing OpenGL."""
OFFSCREEN_REMEDY = OPENGL_REMEDY + (" (or libosmesa6)" if sys.platform == "linux" else "")
"""Remedy for missing OpenGL that draws without a screen."""


class GraphicsError(HandSandboxError):
    """OpenGL or a screen is missing; only windows and pictures need them."""


class FilmError(HandSandboxError):
    """A film or a picture could not be written."""


VARIABLES = ("DISPLAY", "WAYLAND_DISPLAY")
"""Environment variables that name the screen on Linux; other systems count as having a screen."""


def has_display() -> bool:
    """True if there is a screen."""
    return sys.platform != "linux" or any(os.environ.get(name) for name in VARIABLES)
