"""Errors of drawing pictures."""

from __future__ import annotations

from models.errors import HandSandboxError

DEBIAN_PACKAGES = "libgl1 libegl1 libegl-mesa0 libgl1-mesa-dri libglx-mesa0"
"""Packages of Debian and Ubuntu for pictures without a graphics card; libosmesa6 is the
fallback."""


class GraphicsError(HandSandboxError):
    """Neither OpenGL nor a screen to draw with is available; everything else works without."""


class FilmError(HandSandboxError):
    """A film or a picture could not be written."""
