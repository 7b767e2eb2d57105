"""The page in browsers that are not Chromium: Firefox, and WebKit, which every iPad has."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import numpy as np
import pytest
from PIL import Image

from sandbox.server import clients
from sandbox.server.page_server import PageServer
from sandbox.words import words_in
from tests.sandbox.server.staged_page import (
    HEIGHT,
    KNOWN,
    PPI,
    READY,
    TASKS,
    WIDTH,
    play_through,
    staged,
    until,
)
from tests.sandbox.server.test_page_server import Stage, wait_for
from tests.support.processes import PATIENCE
from tests.support.screen import HEIGHT as SCREEN_HEIGHT
from tests.support.screen import WIDTH as SCREEN_WIDTH
from tests.support.screen import screen
from tests.system.other_browsers.firefox import Firefox
from tests.system.other_browsers.webkit import WebKit

SURFACE = (9.0, 6.0)
"""Inches of the touch rectangle, beside which the buttons have room."""
CORNER = (WIDTH - SURFACE[0] * PPI) / 2, (HEIGHT - SURFACE[1] * PPI) / 2

MEASURED = KNOWN | {f"hand-sandbox:px-per-inch:{SCREEN_HEIGHT}x{SCREEN_WIDTH}@1": str(PPI)}
"""What the page remembers, and that this screen was measured."""


@pytest.fixture(scope="module", autouse=True)
def display() -> Iterator[None]:
    with screen():
        yield


@pytest.fixture(autouse=True)
def slow_page(monkeypatch: pytest.MonkeyPatch) -> None:
    """A page on a busy machine may say nothing for longer than a second, fingers down."""
    monkeypatch.setattr(clients, "SILENT_TOUCHED", PATIENCE)


@pytest.fixture
def server() -> Iterator[PageServer]:
    server = PageServer(tasks=TASKS)
    yield server
    server.close()


def solved(stage: Stage, glass: Any, picture: Path) -> None:
    """Plays a box to its goal, with a look at what is drawn before and after."""
    until(glass, READY)
    assert wait_for(lambda: stage.server.wait_for_player(0.0))
    stage.advance()
    until(glass, "document.querySelector('.reason').textContent.includes('mm from the goal')")
    assert play_through(stage, glass, CORNER, 3) == 3
    assert stage.session.scorer.score.success, stage.session.scorer.score
    until(glass, "document.querySelector('.end-words').textContent.startsWith('Done in')")

    def orange() -> float:
        """Share of the screen that has the colour of a box at its goal. A canvas that stays empty
        has none."""
        picture.write_bytes(glass.picture())
        drawn = np.asarray(Image.open(picture).convert("RGB"), int)
        is_orange = (drawn[..., 0] > 180) & (drawn[..., 1] < 150) & (drawn[..., 2] < 120)
        return float(is_orange.mean())

    # The hand may still be over the box: as a ghost, which pales its colour, or solid.
    assert wait_for(lambda: orange() > 0.01)


@pytest.mark.needs("firefox")
def test_fingers_in_firefox_bring_the_box_to_its_goal(server: PageServer, tmp_path: Path) -> None:
    stage = staged(server, size_in=SURFACE)
    page = Firefox(tmp_path, WIDTH, HEIGHT)
    try:
        page.go(server.url, MEASURED)
        solved(stage, page, tmp_path / "firefox.png")
        assert not [e["text"] for e in page.happened("log.entryAdded") if e["level"] == "error"]
        asked = [e["request"]["url"] for e in page.happened("network.beforeRequestSent")]
        own = f"{server.access.host}:{server.access.port}"
        assert any("app.js" in url for url in asked)
        assert {urlsplit(url).netloc for url in asked} <= {own, ""}
    finally:
        page.close()


@pytest.mark.needs("webkit")
def test_fingers_in_webkit_bring_the_box_to_its_goal(server: PageServer, tmp_path: Path) -> None:
    stage = staged(server, size_in=SURFACE)
    page = WebKit(tmp_path, WIDTH, HEIGHT)
    try:
        page.go(server.url, MEASURED)
        solved(stage, page, tmp_path / "webkit.png")
        assert page.evaluate("window.faults") == []
    finally:
        page.close()


@pytest.mark.needs("firefox")
def test_a_browser_that_cannot_draw_in_3d_says_so(server: PageServer, tmp_path: Path) -> None:
    staged(server)
    page = Firefox(tmp_path, WIDTH, HEIGHT, {"webgl.disabled": True}, headless=True)
    try:
        page.go(server.url, MEASURED)
        until(page, "document.querySelector('[role=alert].preparing')")
        said = page.evaluate("document.querySelector('.preparing').textContent")
        assert said == words_in("en")["no_drawing"]
        until(page, "earlySocket.readyState >= WebSocket.CLOSING")
        assert not [e["text"] for e in page.happened("log.entryAdded") if e["level"] == "error"]
    finally:
        page.close()
