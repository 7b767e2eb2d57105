"""WebKit, the engine of every browser on an iPad, driven by WebDriver in WebKitGTK's own browser.

Its WebDriver has one mouse and no fingers, so fingers are events that a script sends in the page:
what the system would do before them is not shown by it.
"""

from __future__ import annotations

import base64
import glob
import json
import os
import shutil
import signal
import socket
import subprocess
import time
import urllib.error
import urllib.request
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from tests.support.processes import PATIENCE

DRIVER = shutil.which("WebKitWebDriver") or ""
BROWSER = next(iter(sorted(glob.glob("/usr/lib/*/webkit2gtk-4.1/MiniBrowser"))), "")

TABLET = "Object.defineProperty(Navigator.prototype, 'maxTouchPoints', { get: () => 10 });"
"""Makes the page believe that the screen feels ten fingers."""

FINGERS = """
window.fingers = (kind, id, x, y) =>
  (document.elementFromPoint(x, y) ?? document.body).dispatchEvent(new PointerEvent(kind, {
    bubbles: true, cancelable: true, composed: true, pointerType: "touch", pointerId: 100 + id,
    clientX: x, clientY: y, width: 16, height: 18, isPrimary: false,
    buttons: kind === "pointerup" ? 0 : 1,
  }));
window.faults = [];
window.addEventListener("error", (e) => faults.push(e.message));
window.addEventListener("unhandledrejection", (e) => faults.push(String(e.reason)));
"""

CHANGING = """(() => {
  const dot = document.createElement("div");
  dot.style.cssText = "position: fixed; right: 0; bottom: 0; width: 1px; height: 1px; z-index: 9";
  document.body.append(dot);
  let odd = false;
  const timer = setInterval(() => (dot.style.background = (odd = !odd) ? "#222" : "#333"), 50);
  window.changing = () => (clearInterval(timer), dot.remove(), true);
  return true;
})()"""
"""Begins to change a pixel of the page; `changing()` ends it."""


class WebKit:
    """One process with one page and fingers on it. It needs a display."""

    def __init__(self, folder: Path, width: int, height: int) -> None:
        self._log = folder / "webkit.log"
        with socket.create_server(("127.0.0.1", 0)) as free:
            port = free.getsockname()[1]
        with self._log.open("w") as told:
            self._process = subprocess.Popen(
                [DRIVER, f"--port={port}"],
                stdout=told,
                stderr=told,
                env={
                    **os.environ,
                    "HOME": str(folder),
                    "XDG_RUNTIME_DIR": str(folder),
                    "GDK_BACKEND": "x11",
                    "LIBGL_ALWAYS_SOFTWARE": "1",
                    "WEBKIT_DISABLE_DMABUF_RENDERER": "1",
                    "NO_AT_BRIDGE": "1",
                },
                start_new_session=True,
            )
        self._base = f"http://127.0.0.1:{port}"
        self._session = ""
        self._wait()
        options = {"binary": BROWSER, "args": ["--automation"]}
        begun = self._ask(
            "POST",
            "/session",
            {"capabilities": {"alwaysMatch": {"webkitgtk:browserOptions": options}}},
        )
        self._session = f"/session/{begun['sessionId']}"
        self._down: dict[int, tuple[float, float]] = {}
        # The window has a frame, whose size is not known before, and takes its size after a while.
        deadline = time.monotonic() + PATIENCE
        while (inner := self.evaluate("[innerWidth, innerHeight]")) != [width, height]:
            assert time.monotonic() < deadline, f"the page has {inner}, not {[width, height]}"
            rect = self._ask("GET", "/window/rect")
            outer = {
                "width": rect["width"] + width - inner[0],
                "height": rect["height"] + height - inner[1],
            }
            self._ask("POST", "/window/rect", {"x": 0, "y": 0, **outer})
            time.sleep(0.2)

    def _wait(self) -> None:
        until = time.monotonic() + PATIENCE
        while True:
            with suppress(urllib.error.URLError):
                urllib.request.urlopen(f"{self._base}/status", timeout=PATIENCE).close()
                return
            assert self._process.poll() is None, self._log.read_text()
            assert time.monotonic() < until, "the driver does not start"
            time.sleep(0.05)

    def _ask(self, how: str, path: str, values: dict[str, Any] | None = None) -> Any:
        request = urllib.request.Request(
            f"{self._base}{self._session}{path}",
            method=how,
            data=None if values is None else json.dumps(values).encode(),
        )
        try:
            with urllib.request.urlopen(request, timeout=PATIENCE) as answer:
                return json.load(answer)["value"]
        except urllib.error.HTTPError as error:
            raise AssertionError(f"{path}: {error.read().decode()[:800]}") from None

    def go(self, url: str, storage: dict[str, str]) -> None:
        """Opens a page as on a tablet that remembers what `storage` says.

        No script can run before those of a page. So another file of the same origin is opened
        first, and the page is written over it.
        """
        place, _, query = url.partition("?")
        self._ask("POST", "/url", {"url": f"{place}app.css?{query}"})
        lines = " ".join(f"localStorage.setItem({k!r}, {v!r});" for k, v in storage.items())
        self.run(
            f"{TABLET} {FINGERS} {lines} const page = await (await fetch({url!r})).text();"
            f"history.replaceState(null, '', {url!r});"
            "document.open(); document.write(page); document.close();"
        )

    def run(self, script: str) -> Any:
        """What a function with this body returns in the page."""
        return self.evaluate(f"(async () => {{ {script} }})()")

    def evaluate(self, script: str) -> Any:
        """The value of an expression in the page."""
        return self._ask("POST", "/execute/sync", {"script": f"return {script}", "args": []})

    def touch(self, fingers: Sequence[tuple[int, float, float]]) -> None:
        """Fingers on the glass as id and CSS pixels: all that are down now."""
        now = {i: (x, y) for i, x, y in fingers}
        gone = [("pointerup", i, *p) for i, p in self._down.items() if i not in now]
        there = [
            ("pointermove" if i in self._down else "pointerdown", i, *p)
            for i, p in now.items()
            if p != self._down.get(i)
        ]
        self.evaluate(f"{json.dumps(gone + there)}.map((event) => fingers(...event)).length")
        self._down = now

    def picture(self) -> bytes:
        """Screenshot of the page, PNG.

        WebKitGTK takes it with the next picture that it presents, and presents none of a page on
        which nothing changes. So a dot in a corner changes its colour meanwhile.
        """
        self.evaluate(CHANGING)
        try:
            return base64.b64decode(self._ask("GET", "/screenshot"))
        finally:
            self.evaluate("window.changing()")

    def close(self) -> None:
        with suppress(AssertionError, OSError):
            self._ask("DELETE", "")
        os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
