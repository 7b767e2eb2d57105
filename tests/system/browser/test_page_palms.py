"""Buttons under a hand that plays: palms press none, and what was pressed by accident is undone."""

from __future__ import annotations

import os
import random
import time
from pathlib import Path

import pytest

from sandbox.words import words_in
from tests.sandbox.server.test_page_server import wait_for
from tests.support.chromium import BINARY, Browser, Tab
from tests.system.browser.away_page import DRAWN, HEIGHT, WIDTH, playing

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

ENGLISH = words_in("en")
CONTROLS = ("Again", "Tasks", "Settings", "")
"""Words of all buttons on the table; the last is that for full screen."""
NOTHING_OPEN = "document.querySelector('.veil, .anew:not([hidden])') === null"
AT = """
(() => {{
  const button = [...document.querySelectorAll('.hud .buttons button, .full')].find(
    (b) => b.innerText.trim() === {words!r});
  const box = button.getBoundingClientRect();
  return [box.left + box.width / 2, box.top + box.height / 2];
}})()
"""


def rest(tab: Tab, at: tuple[float, float], radius: float, seconds: float) -> None:
    """A contact of a size rests on the page, and is lifted."""
    tab.touch([(9, *at)], {9: (radius, radius)})
    time.sleep(seconds)
    tab.touch([])


def place(tab: Tab, words: str) -> tuple[float, float]:
    """The middle of a button, CSS pixels."""
    x, y = tab.evaluate(AT.format(words=words))
    return x, y


@pytest.mark.parametrize("tries", [12, pytest.param(100, marks=pytest.mark.full)])
def test_palms_that_rest_on_buttons_lose_no_trial(
    browser: Browser, tmp_path: Path, tries: int
) -> None:
    drawn = random.Random(7)
    with playing(browser, tmp_path) as page:
        page.begin()
        page.tab.touch([])
        scene = page.scene
        for i in range(tries):
            x, y = place(page.tab, CONTROLS[i % len(CONTROLS)])
            at = x + drawn.uniform(-8, 8), y + drawn.uniform(-8, 8)
            rest(page.tab, at, drawn.uniform(40, 80), 0.8)
            assert page.tab.evaluate(
                "document.querySelector('.veil, .anew:not([hidden])') === null"
            )
        assert page.scene == scene
        assert page.tab.evaluate("innerWidth") == WIDTH


def test_a_button_on_the_table_has_to_be_held_and_again_is_undone_by_a_touch(
    browser: Browser, tmp_path: Path
) -> None:
    pending = "!document.querySelector('.anew').hidden"
    with playing(browser, tmp_path) as page:
        page.begin()
        # The page may draw later than the server plays: before it has begun, a tap is enough.
        page.tab.wait(f"!document.body.innerText.includes({ENGLISH['first_touch']!r})")
        page.tab.touch([])
        scene, again = page.scene, place(page.tab, ENGLISH["again"])
        rest(page.tab, again, 8.0, 0.05)
        page.tab.wait(
            f"document.querySelector('.toast').textContent === {ENGLISH['hold_button']!r}"
        )
        assert not page.tab.evaluate(pending)
        rest(page.tab, again, 8.0, 0.6)
        page.tab.wait(pending)
        assert wait_for(lambda: page.pause == "menu")
        stood = page.stops()
        page.touch_again()
        page.tab.wait("document.querySelector('.anew').hidden")
        assert wait_for(lambda: page.time > stood + 0.2)
        assert page.scene == scene
        page.tab.touch([])
        rest(page.tab, again, 8.0, 0.6)
        assert wait_for(lambda: page.scene > scene)
        # Before it has begun, a trial has nothing to lose.
        page.tab.wait(DRAWN)
        scene = page.scene
        rest(page.tab, again, 8.0, 0.6)
        assert wait_for(lambda: page.scene > scene, 2.0)
        # A tap is enough, too.
        page.tab.wait(DRAWN)
        scene = page.scene
        rest(page.tab, again, 8.0, 0.05)
        assert wait_for(lambda: page.scene > scene)


def test_buttons_stand_in_the_margin_of_a_table_that_does_not_fill_the_screen(
    browser: Browser, tmp_path: Path
) -> None:
    with playing(browser, tmp_path) as page:
        page.tab.wait(DRAWN)
        held = "document.querySelector('.buttons').classList.contains('on-table')"
        assert page.tab.evaluate(held)
        table = page.server._shown
        assert table is not None
        wide = table.message.surface.width_in * 80.0
        for width, height in ((1400, HEIGHT), (1200, 900)):
            page.tab.resize(width, height)
            page.tab.wait(f"innerWidth === {width} && !{held}")
            x, y = place(page.tab, "Again")
            assert x > (width + wide) / 2 or y > (height + HEIGHT) / 2
