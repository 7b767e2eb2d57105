"""Whether there is a screen to open a window on; asked before anything that draws is loaded."""

from __future__ import annotations

import os
import sys

VARIABLES = ("DISPLAY", "WAYLAND_DISPLAY")
"""Of which one names the screen on Linux; other systems always have one."""


def has_display() -> bool:
    """Whether there is one."""
    return sys.platform != "linux" or any(os.environ.get(name) for name in VARIABLES)
