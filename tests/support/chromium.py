"""A real browser, driven over its debugging protocol: no node, no driver, only a socket."""

from __future__ import annotations

import base64
import json
import os
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

from websockets.sync.client import connect

from tests.support.processes import PATIENCE

BINARY = shutil.which("chromium") or "/usr/bin/chromium"

FLAGS = (
    "--headless=new",
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--disable-gpu-vsync",
    "--enable-unsafe-swiftshader",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
    "--disable-quic",
    "--disable-extensions",
    "--mute-audio",
    "--hide-scrollbars",
    "--remote-debugging-port=0",
    "--disable-dev-shm-usage",
    "--disable-features=Translate,MediaRouter,OptimizationHints",
    "--autoplay-policy=no-user-gesture-required",
)


NAVIGATED = "Inspected target navigated or closed"
"""What Chromium says of a question to a page that went away before it could answer."""


class NavigatedError(AssertionError):
    """The page went to another address while it was asked."""


class Browser:
    """One process with a profile of its own."""

    def __init__(self, folder: Path, flags: Sequence[str] = ()) -> None:
        self._log = folder / "chromium.log"
        with self._log.open("w") as log:
            self._process = subprocess.Popen(
                [BINARY, *FLAGS, *flags, f"--user-data-dir={folder / 'profile'}", "about:blank"],
                stdout=log,
                stderr=log,
                # All of its processes are one group, so that all of them can be ended.
                start_new_session=True,
            )
        said = folder / "profile" / "DevToolsActivePort"
        until = time.monotonic() + PATIENCE
        while not (said.exists() and said.read_text().count("\n")):
            assert self._process.poll() is None, self._log.read_text()
            assert time.monotonic() < until, "the browser does not start"
            time.sleep(0.02)
        port, path = said.read_text().split("\n")[:2]
        self._stack = ExitStack()
        self._socket = self._stack.enter_context(
            connect(
                f"ws://127.0.0.1:{port}{path}",
                max_size=None,
                compression=None,
                open_timeout=PATIENCE,
                ping_interval=None,
            )
        )
        self._last = 0
        self.events: list[dict[str, Any]] = []

    def send(self, method: str, session: str | None = None, **values: Any) -> None:
        """Asks, without waiting for an answer."""
        self._last += 1
        asked = {"id": self._last, "method": method, "params": values}
        self._socket.send(json.dumps(asked | ({"sessionId": session} if session else {})))

    def call(self, method: str, session: str | None = None, **values: Any) -> dict[str, Any]:
        """Asks, and waits for the answer; what happens meanwhile is in `events`."""
        self.send(method, session, **values)
        while True:
            told = json.loads(self._socket.recv(timeout=PATIENCE))
            if told.get("id") == self._last:
                if told.get("error", {}).get("message") == NAVIGATED:
                    raise NavigatedError(f"{method}: {told['error']}")
                assert "error" not in told, f"{method}: {told['error']}"
                result: dict[str, Any] = told["result"]
                return result
            self.events.append(told)

    def open(self, url: str, **screen: Any) -> Tab:
        """A new tab."""
        return Tab(self, url, **screen)

    def close(self) -> None:
        self._stack.close()
        os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()


class Tab:
    """A page in the browser, on a screen of a size, with fingers on it."""

    def __init__(
        self,
        browser: Browser,
        url: str,
        width: int = 640,
        height: int = 480,
        storage: dict[str, str] | None = None,
        context: str = "",
    ) -> None:
        self._browser = browser
        # Each in a context of its own: nothing is remembered from another test.
        self._context = context or browser.call("Target.createBrowserContext")["browserContextId"]
        self._size = width, height
        self._target = browser.call(
            "Target.createTarget", url="about:blank", browserContextId=self._context
        )["targetId"]
        self._session = browser.call("Target.attachToTarget", targetId=self._target, flatten=True)[
            "sessionId"
        ]
        self.resize(width, height)
        self.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=10)
        for domain in ("Network", "Runtime", "Page", "Log"):
            self.call(f"{domain}.enable")
        if storage:
            lines = [f"localStorage.setItem({k!r}, {v!r});" for k, v in storage.items()]
            self.call(
                "Page.addScriptToEvaluateOnNewDocument",
                source=f"try {{ {' '.join(lines)} }} catch {{}}",
            )
        self._down: dict[int, dict[str, Any]] = {}
        self.go(url)

    def call(self, method: str, **values: Any) -> dict[str, Any]:
        return self._browser.call(method, self._session, **values)

    def go(self, url: str) -> None:
        self.call("Page.navigate", url=url)

    def reload(self) -> None:
        """Loads the page anew; returns once the page before is gone."""
        self.evaluate("window.isBefore = true; location.reload()")
        self.wait("!window.isBefore")

    def resize(self, width: int, height: int) -> None:
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=True,
        )

    def evaluate(self, script: str) -> Any:
        """The value of an expression in the page."""
        told = self.call(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in told, told["exceptionDetails"]
        return told["result"].get("value")

    def wait(self, script: str, seconds: float = PATIENCE) -> Any:
        """Waits until an expression is true, and what it asks about is there."""
        until = time.monotonic() + seconds
        asked = f"(() => {{ try {{ return {script} }} catch {{ return false }} }})()"
        while True:
            with suppress(NavigatedError):
                if value := self.evaluate(asked):
                    return value
            assert time.monotonic() < until, f"never came true: {script}; {self.text()[:600]}"
            time.sleep(0.02)

    def text(self) -> str:
        """Text of the page."""
        return str(self.evaluate("document.body ? document.body.innerText : ''"))

    def tap(self, words: str) -> None:
        """Clicks a button by its words."""
        self.wait(
            "(() => { const b = [...document.querySelectorAll('button')].find(b => "
            f"b.innerText.trim().startsWith({words!r}) && b.offsetParent !== null); "
            "if (b) b.click(); return !!b; })()"
        )

    def touch(
        self,
        fingers: Sequence[tuple[int, float, float]],
        radii: Mapping[int, tuple[float, float]] | None = None,
    ) -> None:
        """Fingers on the glass as id and CSS pixels: all that are down now; some have radii."""
        now: dict[int, dict[str, float]] = {}
        for i, x, y in fingers:
            across, down = (radii or {}).get(i, (8.0, 8.0))
            now[i] = {"x": x, "y": y, "id": i, "radiusX": across, "radiusY": down}
        gone = [p for i, p in self._down.items() if i not in now]
        new = [p for i, p in now.items() if i not in self._down]
        moved = [p for i, p in now.items() if i in self._down and p != self._down[i]]
        for kind, points in (("touchEnd", gone), ("touchMove", moved), ("touchStart", new)):
            if points:
                self.call("Input.dispatchTouchEvent", type=kind, touchPoints=points)
        self._down = now

    def cancel(self) -> None:
        """The system takes all fingers away."""
        self.call("Input.dispatchTouchEvent", type="touchCancel", touchPoints=[])
        self._down = {}

    def crash(self) -> None:
        """Ends the process of the page, whose history and session storage stay."""
        self._browser.send("Page.crash", self._session)
        self._down = {}

    def beside(self) -> Callable[[], object]:
        """Opens another tab in this one's window, which hides this one; returns what closes it."""
        other = self._browser.call(
            "Target.createTarget", url="about:blank", browserContextId=self._context
        )["targetId"]
        self._browser.call("Target.activateTarget", targetId=other)
        return lambda: self._browser.call("Target.closeTarget", targetId=other)

    def show(self) -> None:
        """Shows this tab of its window."""
        self._browser.call("Target.activateTarget", targetId=self._target)

    def events(self, method: str) -> list[dict[str, Any]]:
        """Parameters of everything of a kind that happened in this tab."""
        return [
            e["params"]
            for e in self._browser.events
            if e.get("method") == method and e.get("sessionId") == self._session
        ]

    def picture(self) -> bytes:
        """Screenshot of the page, PNG."""
        return base64.b64decode(self.call("Page.captureScreenshot", format="png")["data"])

    def same_browser(self, url: str) -> Tab:
        """Another tab of the same person's browser, which remembers what this one does."""
        return Tab(self._browser, url, *self._size, context=self._context)

    def close(self) -> None:
        self._browser.call("Target.closeTarget", targetId=self._target)
        # Now and then Chromium does not answer for a page that was in VR; it ends with its browser.
        with suppress(TimeoutError):
            self._browser.call("Target.disposeBrowserContext", browserContextId=self._context)
