"""Tests for a screen on which a window can open, before drawing libraries are loaded."""

from __future__ import annotations

import os
import sys

from models.errors import HandSandboxError

DEBIAN_PACKAGES = "libgl1 libegl1 libegl-mesa0 libgl1-mesa-dri libglx-mesa0"
"""Packages of Debian and Ubuntu for pictures without a graphics card."""

OPENGL_REMEDY = (
    f"On Debian or Ubuntu: apt-get install {DEBIAN_PACKAGES}"
    if sys.platform == "linux"
    else "Install the driver of the graphics card; over a remote desktop there is often no OpenGL"
)
"""How to get OpenGL."""
OFFSCREEN_REMEDY = OPENGL_REMEDY + (" (or libosmesa6)" if sys.platform == "linux" else "")
"""How to get OpenGL that draws without a screen."""


class GraphicsError(HandSandboxError):
    """Neither OpenGL nor a screen to draw with is available; everything else works without."""


class FilmError(HandSandboxError):
    """A film or a picture could not be written."""


VARIABLES = ("DISPLAY", "WAYLAND_DISPLAY")
"""Environment variables that name the screen on Linux; other systems always have one."""


def has_display() -> bool:
    """True if there is a screen."""
    return sys.platform != "linux" or any(os.environ.get(name) for name in VARIABLES)
