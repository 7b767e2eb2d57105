"""Full screen by a button on every page; over TLS, pages can be installed."""

from __future__ import annotations

import gzip
import json
import os
import shutil
import subprocess
from pathlib import Path

import pytest

from sandbox.server.page_server import PageServer, tls_context
from sandbox.server.protocol import Sheet, StudyView
from sandbox.server.static import StaticFiles
from sandbox.words import words_in
from tests.sandbox.server.staged_page import HEIGHT, KNOWN, READY, TASKS, WIDTH, staged
from tests.support.chromium import BINARY, Browser, Tab

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

ENGLISH = words_in("en")
NAMED = "document.querySelector('.full').ariaLabel"
SHOWN = (
    "(() => {{ const ask = window.matchMedia.bind(window);"
    " window.matchMedia = (query) => query.includes('display-mode')"
    " ? {{ matches: query.includes({mode!r}) }} : ask(query); }})()"
)
"""How the page is shown, which this Chromium cannot be told."""
FULL = "!!document.fullscreenElement"


def press(tab: Tab) -> None:
    """A person presses the button, as browsers ask for."""
    x, y = tab.evaluate(
        "(() => { const b = document.querySelector('.full').getBoundingClientRect();"
        " return [b.x + b.width / 2, b.y + b.height / 2] })()"
    )
    tab.touch([(1, x, y)])
    tab.touch([])


@pytest.mark.parametrize("who", ["player", "spectator", "participant"])
def test_a_button_shows_every_page_in_full_screen_and_back(browser: Browser, who: str) -> None:
    study = StudyView("en", {}, ["task"]) if who == "participant" else None
    server = PageServer(tasks=TASKS, study=study)
    if study:
        server.show_sheet(Sheet(1, "text", "", "Welcome.", [], {}, 0.0))
    else:
        staged(server)
    more = "&role=spectator" if who == "spectator" else ""
    tab = browser.open(server.url + more, width=WIDTH, height=HEIGHT, storage=KNOWN)
    try:
        tab.wait(READY)
        assert tab.evaluate(NAMED) == ENGLISH["full_screen"]
        press(tab)
        tab.wait(FULL)
        tab.wait(f"{NAMED} === {ENGLISH['leave_full_screen']!r}")
        press(tab)
        tab.wait(f"!({FULL})")
        tab.wait(f"{NAMED} === {ENGLISH['full_screen']!r}")
    finally:
        tab.close()
        server.close()


def test_only_a_page_over_tls_can_be_installed_and_its_start_address_has_no_token() -> None:
    files = StaticFiles()
    for origin, installable in (("wss://a:1", True), ("ws://a:1", False)):
        page = files.response("/", origin, "SECRET").body
        assert (b'href="manifest.json?token=SECRET"' in page) is installable
        assert b"{{" not in page
    manifest = files.response("/manifest.json", "wss://a:1", "SECRET")
    assert manifest.headers["Content-Type"] == "application/manifest+json"
    assert b"SECRET" not in manifest.body
    told = json.loads(manifest.body)
    assert told["start_url"] == told["scope"] == "/"


@pytest.mark.skipif(shutil.which("openssl") is None, reason="openssl makes the certificate")
def test_a_browser_takes_the_manifest_of_a_page_over_tls(browser: Browser, tmp_path: Path) -> None:
    key, certificate = tmp_path / "key.pem", tmp_path / "certificate.pem"
    command = "openssl req -x509 -newkey rsa:2048 -nodes -days 2 -subj /CN=127.0.0.1 -keyout"
    files = [str(key), "-out", str(certificate)]
    subprocess.run([*command.split(), *files], check=True, capture_output=True)
    server = PageServer(tasks=TASKS, tls=tls_context(str(certificate), str(key)))
    staged(server)
    tab = browser.open("about:blank", width=WIDTH, height=HEIGHT, storage=KNOWN)
    try:
        tab.call("Security.setIgnoreCertificateErrors", ignore=True)
        tab.go(server.url)
        tab.wait(READY)
        found = tab.call("Page.getAppManifest")
        assert found["errors"] == []
        assert server.access.token in found["url"]
        start = json.loads(found["data"])["start_url"]
        # What is installed finds the token where the person has chosen to keep it.
        tab.evaluate("dispatchEvent(new Event('appinstalled')); true")
        assert tab.evaluate("localStorage.getItem('hand-sandbox:token')") == server.access.token
        assert start == "/"
    finally:
        tab.close()
        server.close()


def test_an_installed_page_finds_back_and_another_tab_does_not(browser: Browser) -> None:
    server = PageServer(tasks=TASKS)
    staged(server)
    kept = {**KNOWN, "hand-sandbox:token": server.access.token}
    plain = server.url.partition("?")[0]
    try:
        for mode, found in (("standalone", True), ("browser", False)):
            tab = browser.open("about:blank", width=WIDTH, height=HEIGHT, storage=kept)
            tab.call("Page.addScriptToEvaluateOnNewDocument", source=SHOWN.format(mode=mode))
            tab.go(plain)
            if found:
                tab.wait(READY)
                assert tab.evaluate("location.search") == ""
            else:
                tab.wait(f"document.body.innerText.includes({ENGLISH['return_title']!r})")
            tab.close()
    finally:
        server.close()


def test_a_browser_gets_the_page_compressed_and_no_other_client_does() -> None:
    files = StaticFiles()
    total = 0
    for name in ("/three.js", "/app.js", "/app.css", "/early.js", "/"):
        plain = files.response(name, "ws://a:1", "SECRET")
        small = files.response(name, "ws://a:1", "SECRET", accepted="gzip, deflate, br")
        assert "Content-Encoding" not in plain.headers
        assert int(small.headers["Content-Length"]) == len(small.body)
        compressed = small.headers.get("Content-Encoding") == "gzip"
        assert (gzip.decompress(small.body) if compressed else small.body) == plain.body
        total += len(small.body)
    assert total < 220_000
