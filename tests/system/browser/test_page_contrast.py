"""Texts can be read on the picture of every task, and cover nothing that has to be seen."""

from __future__ import annotations

import io
import os
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

from sandbox.play.pages import EASIEST_FIRST
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import PageScreen
from sandbox.server.screen import rectangle
from tasks.registry import TASKS
from tests.sandbox.server.staged_page import READY, staged
from tests.sandbox.server.test_page_server import wait_for
from tests.support.chromium import BINARY, Browser, Tab

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

WIDTH, HEIGHT, PPI = 1366, 1024, 132.0
LEAST = 4.5
"""Contrast of texts, WCAG 2.2 level AA."""
KNOWN = {
    f"hand-sandbox:px-per-inch:{HEIGHT}x{WIDTH}@1": str(PPI),
    "hand-sandbox:quality": "3",
}
TEXTS = """
(() => {
  const found = [];
  for (const element of document.querySelectorAll(".hud *, .hint *, .lift *")) {
    const own = [...element.childNodes].filter((n) => n.nodeType === 3 && n.textContent.trim());
    const seen = element.checkVisibility({ visibilityProperty: true });
    if (!seen || element.matches(".voice")) continue;
    for (const text of own) {
      const range = document.createRange();
      range.selectNodeContents(text);
      const colour = getComputedStyle(element).color.match(/[\\d.]+/g).map(Number).slice(0, 3);
      for (const box of range.getClientRects())
        found.push([text.textContent, colour, [box.left, box.top, box.right, box.bottom]]);
    }
  }
  const style = document.createElement("style");
  style.textContent = ".hud *, .hint *, .lift * { color: transparent !important }";
  document.head.append(style);
  return found;
})()
"""
"""Lines of text with their colours and places; afterwards they are invisible."""


def luminance(colours: NDArray[Any]) -> NDArray[np.float64]:
    """Relative luminance of sRGB colours of 0 to 255, as WCAG defines it."""
    share = np.asarray(colours, float) / 255.0
    linear = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    return np.asarray(linear @ [0.2126, 0.7152, 0.0722])


def contrasts(tab: Tab) -> dict[str, float]:
    """Contrast of every text on the page with the pixels behind it, at the worst hundredth."""
    texts = tab.evaluate(TEXTS)
    tab.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    ground = np.asarray(Image.open(io.BytesIO(tab.picture())).convert("RGB"))
    found: dict[str, float] = {}
    for text, colour, (left, top, right, bottom) in texts:
        pixels = ground[int(top) : int(bottom) + 1, int(left) : int(right) + 1].reshape(-1, 3)
        pair = np.stack(
            [np.broadcast_to(luminance(np.array(colour)), len(pixels)), luminance(pixels)]
        )
        ratio = (pair.max(0) + 0.05) / (pair.min(0) + 0.05)
        found[text] = min(found.get(text, 21.0), round(float(np.quantile(ratio, 0.01)), 2))
    return found


OFTEN = ("chords", "gather")
"""The tasks with the lightest picture and with the most objects."""
OTHERS = [pytest.param(n, marks=pytest.mark.full) for n in EASIEST_FIRST if n not in OFTEN]


@pytest.mark.parametrize("task", [*OFTEN, *OTHERS])
def test_every_text_of_a_task_can_be_read_on_its_picture(browser: Browser, task: str) -> None:
    lifts = TASKS[task].lift_range > 0
    server = PageServer()
    try:
        stage = staged(
            server, task=task, **rectangle(PageScreen(PPI, WIDTH, HEIGHT, True), lifts=lifts)
        )
        tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
        tab.wait(READY)
        assert wait_for(lambda: server._shown is not None)
        server.publish(stage.session.advance(), "start")
        tab.wait("document.querySelector('.preparing').hidden")
        tab.wait("!document.querySelector('.hint').hidden")
        found = contrasts(tab)
        assert len(found) >= 7
        assert {text: ratio for text, ratio in found.items() if ratio < LEAST} == {}
        tab.close()
    finally:
        server.close()
