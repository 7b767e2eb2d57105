"""Plays box-to-goal by touches on the page in Chromium; observes the outcome and script errors."""

from __future__ import annotations

import os
import tempfile
from pathlib import Path

from sandbox.server import clients
from sandbox.server.page_server import PageServer
from tests.sandbox.server.staged_page import (
    HEIGHT,
    KNOWN,
    PPI,
    READY,
    TASKS,
    WIDTH,
    play_through,
    staged,
)
from tests.sandbox.server.test_page_server import wait_for
from tests.support.chromium import BINARY, Browser
from tests.support.processes import PATIENCE
from tools.gate.rows import Observed

FINGERS = 3
SURFACE_IN = (9.0, 6.0)
"""Touch rectangle of the page, inches."""


def play() -> Observed:
    """Plays once; returns success, number of fingers that were down, and number of script errors.

    Times and states are not returned, since they depend on when the browser sends touches.
    """
    if not os.path.exists(BINARY):
        return {"error": "Debian's chromium is missing"}
    # A page on a busy machine may send nothing for longer than a second.
    clients.SILENT_TOUCHED = PATIENCE
    server = PageServer(tasks=TASKS)
    with tempfile.TemporaryDirectory() as folder:
        browser = Browser(Path(folder))
        try:
            tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
            stage = staged(server, size_in=SURFACE_IN)
            tab.wait(READY)
            assert wait_for(lambda: stage.server.wait_for_player(0.0))
            stage.advance()
            tab.wait("document.querySelector('.task').textContent !== ''")
            corner = (WIDTH - SURFACE_IN[0] * PPI) / 2, (HEIGHT - SURFACE_IN[1] * PPI) / 2
            fingers = play_through(stage, tab, corner, FINGERS)
            tab.wait("document.querySelector('.end-words').textContent !== ''")
            errors = len(tab.events("Runtime.exceptionThrown"))
            success = stage.session.scorer.score.success
            return {"success": success, "fingers": fingers, "script errors": errors}
        finally:
            browser.close()
            server.close()
