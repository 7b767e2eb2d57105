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


@pytest.mark.needs("site")
def test_no_docstring_is_taken_for_a_numbered_list() -> None:
    """A docstring such as "m." would be the thirteenth item of a list."""
    lists = 'class="loweralpha', 'class="upperalpha', 'class="lowerroman', 'class="upperroman'
    texts = {page.name: page.read_text(encoding="utf-8") for page in pages()}
    assert [name for name, text in texts.items() if any(one in text for one in lists)] == []


@pytest.mark.needs("site")
@pytest.mark.parametrize("package", ["models", "encoders", "tasks", "sandbox"])
def test_signatures_name_types_as_the_sources_do(package: str) -> None:
    text = (SITE / "api" / f"{package}.html").read_text(encoding="utf-8")
    for machinery in ("ForwardRef", "numpy.ndarray", "~typing", "factory&gt;"):
        assert machinery not in text


@pytest.mark.needs("site")
def test_the_search_page_says_what_to_type_until_something_is_searched_for(
    browser: Browser, address: str
) -> None:
    tab = browser.open(address + "search.html", width=390, height=844)
    tab.wait("document.readyState === 'complete'")
    assert "Try baseline seeds" in tab.text()
    assert tab.evaluate("document.querySelector('form.words label').htmlFor") == "words"
    tab.go(address + "search.html?q=baseline")
    tab.wait("document.querySelectorAll('#search-results li').length > 0")
    assert "Try baseline seeds" not in tab.text()
    assert tab.evaluate("document.getElementById('words').value") == "baseline"
    tab.close()


@pytest.mark.needs("site")
def test_drawings_are_dark_on_dark_pages_and_as_they_are_on_light_ones(
    browser: Browser, address: str
) -> None:
    tab = browser.open(address + "docs/physics.html", width=1440, height=900)
    for scheme, filtered in (("dark", True), ("light", False)):
        feature = {"name": "prefers-color-scheme", "value": scheme}
        tab.call("Emulation.setEmulatedMedia", features=[feature])
        tab.wait("document.readyState === 'complete'")
        how = tab.evaluate("getComputedStyle(document.querySelector('article img')).filter")
        assert ("invert" in how) == filtered
    tab.close()


@pytest.mark.needs("site")
def test_ids_of_gymnasium_keep_their_parts_whole_on_a_phone(browser: Browser, address: str) -> None:
    tab = browser.open(address + "tasks/carry-together.html", width=390, height=844)
    tab.wait("document.readyState === 'complete'")
    lines = tab.evaluate(
        "(() => { const word = [...document.querySelectorAll('td code .pre')]"
        ".find((e) => e.textContent === 'hand_sandbox/CarryTogether-v1');"
        "const range = document.createRange(); range.selectNodeContents(word);"
        "return new Set([...range.getClientRects()].map((r) => Math.round(r.top))).size })()"
    )
    assert lines == 2
    icon = tab.evaluate("document.querySelector('link[rel~=icon]').href")
    assert icon.endswith("favicon.svg")
    tab.close()
