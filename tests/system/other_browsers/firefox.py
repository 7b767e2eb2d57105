"""Firefox, driven over WebDriver BiDi, which it speaks itself: no driver, only a socket."""

from __future__ import annotations

import base64
import json
import os
import re
import shutil
import signal
import subprocess
import time
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any

from websockets.sync.client import connect

from tests.support.processes import PATIENCE

BINARY = shutil.which("firefox-esr") or shutil.which("firefox") or ""

PREFERENCES: dict[str, bool | int | str] = {
    # A tablet's screen, on which ten fingers are seen.
    "dom.w3c_touch_events.enabled": 1,
    "dom.maxtouchpoints.testing.value": 10,
    "webgl.force-enabled": True,
    # Nothing that asks hosts by itself.
    "app.normandy.enabled": False,
    "app.update.enabled": False,
    "datareporting.policy.dataSubmissionEnabled": False,
    "toolkit.telemetry.enabled": False,
    "network.captive-portal-service.enabled": False,
    "network.connectivity-service.enabled": False,
    "browser.safebrowsing.malware.enabled": False,
    "browser.safebrowsing.phishing.enabled": False,
    "services.settings.server": "data:,",
}


class Firefox:
    """One process with a profile of its own, one page and fingers on it. It needs a display.

    Attributes:
        events: What happened in the page, as WebDriver BiDi tells it: errors of scripts
            (`log.entryAdded`) and requests (`network.beforeRequestSent`).
    """

    def __init__(
        self,
        folder: Path,
        width: int,
        height: int,
        preferences: dict[str, bool | int | str] | None = None,
        *,
        headless: bool = False,
    ) -> None:
        wanted = PREFERENCES | (preferences or {})
        lines = [f"user_pref({json.dumps(k)}, {json.dumps(v)});" for k, v in wanted.items()]
        (folder / "user.js").write_text("\n".join(lines))
        log = folder / "firefox.log"
        with log.open("w") as told:
            self._process = subprocess.Popen(
                [BINARY, "--remote-debugging-port", "0", "--profile", str(folder)]
                + ["--headless"] * headless
                + ["about:blank"],
                stdout=told,
                stderr=told,
                # It draws in software, and keeps nothing in the home folder.
                env={**os.environ, "HOME": str(folder), "LIBGL_ALWAYS_SOFTWARE": "1"},
                start_new_session=True,
            )
        until = time.monotonic() + PATIENCE
        while not (said := re.search(r"WebDriver BiDi listening on (ws://\S+)", log.read_text())):
            assert self._process.poll() is None, log.read_text()
            assert time.monotonic() < until, "the browser does not start"
            time.sleep(0.05)
        self._stack = ExitStack()
        self._socket = self._stack.enter_context(
            connect(f"{said[1]}/session", max_size=None, open_timeout=PATIENCE, ping_interval=None)
        )
        self._last = 0
        self._down: dict[int, tuple[float, float]] = {}
        self.events: list[dict[str, Any]] = []
        self.call("session.new", capabilities={})
        self.call("session.subscribe", events=["log.entryAdded", "network.beforeRequestSent"])
        self._page = self.call("browsingContext.getTree")["contexts"][0]["context"]
        self.call(
            "browsingContext.setViewport",
            context=self._page,
            viewport={"width": width, "height": height},
        )

    def call(self, method: str, **values: Any) -> dict[str, Any]:
        """Asks, and waits for the answer; what happens meanwhile is in `events`."""
        self._last += 1
        self._socket.send(json.dumps({"id": self._last, "method": method, "params": values}))
        while True:
            told: dict[str, Any] = json.loads(self._socket.recv(timeout=PATIENCE))
            if told.get("id") == self._last:
                assert told["type"] == "success", f"{method}: {told}"
                result: dict[str, Any] = told["result"]
                return result
            self.events.append(told)

    def go(self, url: str, storage: dict[str, str]) -> None:
        """Opens a page that remembers what `storage` says."""
        lines = " ".join(f"localStorage.setItem({k!r}, {v!r});" for k, v in storage.items())
        self.call(
            "script.addPreloadScript",
            functionDeclaration=f"() => {{ try {{ {lines} }} catch {{}} }}",
        )
        self.call("browsingContext.navigate", context=self._page, url=url, wait="complete")

    def evaluate(self, script: str) -> Any:
        """The value of an expression in the page."""
        told = self.call(
            "script.evaluate",
            # As text, since BiDi has a notation of its own for values.
            expression=f"JSON.stringify({script}) ?? 'null'",
            target={"context": self._page},
            awaitPromise=True,
        )
        assert told["type"] == "success", told
        return json.loads(told["result"]["value"])

    def touch(self, fingers: Sequence[tuple[int, float, float]]) -> None:
        """Fingers on the glass as id and CSS pixels: all that are down now."""
        now = {i: (x, y) for i, x, y in fingers}
        steps: dict[int, list[dict[str, Any]]] = {}
        for i in sorted({*now, *self._down}):
            if i not in now:
                steps[i] = [{"type": "pause"}, {"type": "pointerUp", "button": 0}]
            elif now[i] != self._down.get(i):
                x, y = now[i]
                move = {"type": "pointerMove", "duration": 0, "x": round(x), "y": round(y)}
                press = {"type": "pointerDown", "button": 0, "width": 16, "height": 18}
                steps[i] = [move, {"type": "pause"} if i in self._down else press]
        if steps:
            self.call(
                "input.performActions",
                context=self._page,
                actions=[
                    {
                        "type": "pointer",
                        "id": f"finger {i}",
                        "parameters": {"pointerType": "touch"},
                        "actions": actions,
                    }
                    for i, actions in steps.items()
                ],
            )
        self._down = now

    def happened(self, method: str) -> list[dict[str, Any]]:
        """Parameters of every event of a kind."""
        return [e["params"] for e in self.events if e.get("method") == method]

    def picture(self) -> bytes:
        """Screenshot of the page, PNG."""
        told = self.call("browsingContext.captureScreenshot", context=self._page)
        return base64.b64decode(told["data"])

    def close(self) -> None:
        self._stack.close()
        os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
