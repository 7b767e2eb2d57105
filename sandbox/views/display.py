"""Tests for a screen on which a window can open, before drawing libraries are loaded."""

from __future__ import annotations

import os
import sys

VARIABLES = ("DISPLAY", "WAYLAND_DISPLAY")
"""Environment variables that name the screen on Linux; other systems always have one."""


def has_display() -> bool:
    """True if there is a screen."""
    return sys.platform != "linux" or any(os.environ.get(name) for name in VARIABLES)
