"""Opens any touch device, including the page."""

from __future__ import annotations

from typing import Any

from rich.console import Console

from sandbox.devices.files.touch_files import Opened
from sandbox.options.touch_devices import TouchOptions, open_touches


def open_touches_or_page(options: TouchOptions, seconds: float, tap: Any = None) -> Opened | None:
    """Opens the device; returns None if nobody opened the page in time."""
    if not options.is_page:
        return open_touches(options, tap)
    # This import loads the whole program, which only the page needs.
    from sandbox.play.page_touches import open_page_touches

    page = open_page_touches(options, Console(stderr=True), seconds)
    return None if page is None else Opened(page, page.surface)
