"""The built site in a real browser: it asks no other host and fits every screen."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest
from html5lib import HTMLParser

from tests.support.chromium import BINARY, Browser
from tests.support.needs import AXE, SITE, require
from tests.system.browser.test_page_for_everybody import SERIOUS

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

PAGES = (
    "index.html",
    "README.html",
    "tasks/index.html",
    "tasks/box-to-goal.html",
    "docs/studies.html",
    "docs/architecture.html",
    "docs/results.html",
    "api/sandbox.html",
)
WIDTHS = (390, 820, 1440)
ELSEWHERE = """
performance.getEntriesByType("resource").map(({ name }) => name)
  .filter((name) => !name.startsWith(location.origin) && !name.startsWith("data:"))
"""
MOST_BYTES = 1_000_000


class Quiet(SimpleHTTPRequestHandler):
    """Serves files and says nothing."""

    def log_message(self, *args: Any) -> None:
        """Prints no line for a request."""


@pytest.fixture(scope="module")
def address() -> Iterator[str]:
    require("site")
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(SITE)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}/"
    server.shutdown()
    server.server_close()


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    browser = Browser(tmp_path_factory.mktemp("chromium"))
    yield browser
    browser.close()


@pytest.mark.needs("site")
@pytest.mark.parametrize("page", PAGES)
def test_a_page_fits_every_screen_and_asks_no_other_host(
    browser: Browser, address: str, page: str
) -> None:
    for width in WIDTHS:
        tab = browser.open(address + page, width=width, height=900)
        tab.wait("document.readyState === 'complete'")
        assert tab.evaluate("document.documentElement.scrollWidth") <= width
        assert tab.evaluate(ELSEWHERE) == []
        tab.close()


@pytest.mark.needs("site", "axe")
@pytest.mark.parametrize("page", PAGES)
def test_axe_finds_nothing_serious_on_the_site(browser: Browser, address: str, page: str) -> None:
    tab = browser.open(address + page, width=1440, height=900)
    tab.wait("document.readyState === 'complete'")
    tab.evaluate(f"{AXE.read_text(encoding='utf-8')}; true")
    assert tab.evaluate(SERIOUS) == []
    tab.close()


def pages() -> list[Path]:
    """Pages of the site, without files that it offers for download."""
    return [path for path in Path(SITE).rglob("*.html") if "_downloads" not in path.parts]


@pytest.mark.needs("site")
def test_every_page_is_smaller_than_a_megabyte() -> None:
    assert len(pages()) > 40
    assert [p.name for p in pages() if p.stat().st_size > MOST_BYTES] == []


@pytest.mark.needs("site")
def test_every_page_is_html_without_an_error() -> None:
    errors = {}
    for page in pages():
        parser = HTMLParser()
        parser.parse(page.read_text(encoding="utf-8"))
        if parser.errors:
            errors[page.name] = parser.errors
    assert errors == {}
