"""Opens any touch device, the page too, and waits for what it says."""

from __future__ import annotations

from typing import Any

from rich.console import Console

from sandbox.options.touch_devices import Opened, TouchOptions, open_touches


def open_any(options: TouchOptions, seconds: float, tap: Any = None) -> Opened | None:
    """The device; None: it is the page, and nobody opened it in time."""
    if options.device != "web" and not options.tablet and not options.lan:
        return open_touches(options, tap)
    # The page needs the whole program behind it, which is only loaded for it.
    from sandbox.cli.common.touch_page import open_page_touches

    page = open_page_touches(options, Console(stderr=True), seconds)
    return None if page is None else Opened(page, page.surface)
