"""What people can switch on their device: colours and vibration."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

import pytest

from sandbox.server.page_server import PageServer
from sandbox.words import words_in
from tests.sandbox.server.staged_page import HEIGHT, KNOWN, READY, WIDTH, staged
from tests.sandbox.server.test_page_server import Stage
from tests.support.chromium import BINARY, Browser, Tab
from tests.support.viewed import contact_at, with_load

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

ENGLISH = words_in("en")
FELT = (
    "window.felt = []; Object.defineProperty(Navigator.prototype, 'vibrate',"
    " { value: (pattern) => felt.push([pattern].flat().length) > 0 });"
)
"""Writes down how many parts every vibration had."""
TAKEN = """
window.taken = 0;
const { set } = Object.getOwnPropertyDescriptor(WebSocket.prototype, "onmessage");
Object.defineProperty(WebSocket.prototype, "onmessage", {
  set(take) {
    set.call(this, (event) => {
      take(event);
      if (typeof event.data !== "string") taken += 1;
    });
  },
});
"""
"""Counts the frames that the page has taken."""


def opened(browser: Browser, server: PageServer, still: bool = False) -> tuple[Stage, Tab]:
    stage = staged(server)
    tab = browser.open("about:blank", width=WIDTH, height=HEIGHT, storage=KNOWN)
    tab.call("Page.addScriptToEvaluateOnNewDocument", source=FELT + TAKEN)
    value = "reduce" if still else "no-preference"
    tab.call(
        "Emulation.setEmulatedMedia",
        features=[{"name": "prefers-reduced-motion", "value": value}],
    )
    tab.go(server.url)
    tab.wait(READY)
    tab.wait("!!document.querySelector('.task').textContent")
    return stage, tab


def switch(tab: Tab, name: str) -> bool:
    """Switches something in the menu; whether it is on now."""
    tab.tap(ENGLISH["settings"])
    tab.tap(name)
    button = (
        f"[...document.querySelectorAll('[role=switch]')].find(b => b.innerText.includes({name!r}))"
    )
    now = tab.evaluate(f"{button}.ariaChecked")
    tab.tap(ENGLISH["close"])
    return bool(now == "true")


def grips_and_succeeds(stage: Stage, tab: Tab) -> list[int]:
    """What was felt: parts of each vibration."""
    tab.evaluate("felt.length = 0; true")
    snapshot = stage.session.advance()
    hand = snapshot.hands[0]
    contacts = tuple(contact_at(hand.surface, i, hand.tips[i], i, "active") for i in (0, 1))
    snapshot = snapshot.with_hands(replace(hand, contacts=contacts))
    held = replace(snapshot, score=replace(snapshot.score, held=True))
    # It trembles, and is one grip; the second is another one.
    for grip in (0.0, 5.0, 0.5, 5.0, 0.0, 5.0, 5.0):
        force = (grip, grip, 0.0, 0.0, 0.0)
        # A page that is busy gets the newest frame only, so that each one waits for the last.
        before = tab.evaluate("taken")
        stage.server.publish(with_load(snapshot, force, force))
        tab.wait(f"taken > {before}")
    stage.server.publish(held)
    tab.wait("document.querySelector('.bar-fill').classList.contains('done')")
    stage.server.publish(snapshot)
    tab.wait("!document.querySelector('.bar-fill').classList.contains('done')")
    return list(tab.evaluate("felt"))


def test_a_device_vibrates_when_a_hand_takes_hold_and_at_success_until_it_is_switched_off(
    browser: Browser, server: PageServer
) -> None:
    stage, tab = opened(browser, server)
    # Browsers refuse it, and complain, before the person has touched the page.
    assert grips_and_succeeds(stage, tab) == []
    tab.touch([(1, WIDTH / 2, HEIGHT / 2)])
    tab.touch([])
    assert grips_and_succeeds(stage, tab) == [1, 1, 3]
    assert not switch(tab, ENGLISH["vibration"])
    assert grips_and_succeeds(stage, tab) == []
    assert switch(tab, ENGLISH["vibration"])
    assert grips_and_succeeds(stage, tab) == [1, 1, 3]
    tab.close()


def test_nothing_vibrates_for_people_who_asked_for_less_motion(
    browser: Browser, server: PageServer
) -> None:
    stage, tab = opened(browser, server, still=True)
    tab.touch([(1, WIDTH / 2, HEIGHT / 2)])
    tab.touch([])
    assert grips_and_succeeds(stage, tab) == []
    tab.tap(ENGLISH["settings"])
    tab.wait("!!document.querySelector('[role=switch]')")
    assert ENGLISH["vibration_why"] not in tab.text()
    tab.close()


def test_colours_for_colour_blind_people_are_kept_on_the_device(
    browser: Browser, server: PageServer, tmp_path: Path
) -> None:
    stage, tab = opened(browser, server)
    stage.advance()
    chosen = "document.documentElement.dataset.colours"
    green = "getComputedStyle(document.documentElement).getPropertyValue('--green').trim()"
    assert (tab.evaluate(chosen), tab.evaluate(green)) == ("standard", "#33cc7a")
    assert switch(tab, ENGLISH["colours"])
    stage.advance()
    (tmp_path / "colours.png").write_bytes(tab.picture())
    for _ in range(2):
        assert (tab.evaluate(chosen), tab.evaluate(green)) == ("okabe-ito", "#56b4e9")
        tab.call("Page.reload")
        tab.wait(READY)
    assert not switch(tab, ENGLISH["colours"])
    assert tab.evaluate(chosen) == "standard"
    tab.close()
