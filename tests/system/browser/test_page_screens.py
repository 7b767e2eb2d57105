"""Screens that are no tablets: a phone, a mouse, a window that changes; tablets by name."""

from __future__ import annotations

import contextlib
import json
import os
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from rich.console import Console

from sandbox.play.page_play import PagePlay
from sandbox.play.pages import open_page
from sandbox.server.page_options import PageOptions
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import StudyView
from sandbox.trial.logs import EventLog
from sandbox.trial.trial_options import TrialOptions
from sandbox.words import words_in
from tests.sandbox.play.played_page import played
from tests.sandbox.server.staged_page import READY
from tests.sandbox.server.test_page_server import wait_for
from tests.support.chromium import BINARY, Browser, Tab
from tests.support.page_memory import NO_HINTS
from tools.docs.page_languages import in_study

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

ENGLISH = words_in("en")
QUICK = {"hand-sandbox:quality": "3", **NO_HINTS}
PUBLISHED = Path(__file__).resolve().parents[3] / "sandbox/views/page/src/devices.json"


@pytest.fixture
def server(tmp_path: Path) -> Iterator[PageServer]:
    server = open_page(PageOptions())
    events = EventLog(tmp_path / "events.jsonl")
    play = PagePlay(TrialOptions(device="web"), (server,), events, Console(quiet=True))
    with played(play, server):
        yield server
    server.close()
    events.close()


@contextlib.contextmanager
def opened(
    browser: Browser, url: str, size: tuple[int, int], mouse: bool = False, **storage: str
) -> Iterator[Tab]:
    tab = browser.open("about:blank", width=size[0], height=size[1], storage={**QUICK, **storage})
    if mouse:
        tab.call("Emulation.setTouchEmulationEnabled", enabled=False)
    tab.go(url)
    yield tab
    tab.close()


def sheet(tab: Tab) -> str:
    """Title of the sheet that is open."""
    return str(tab.wait("document.querySelector('.sheet h2')?.textContent"))


def scale(server: PageServer) -> float | None:
    """Scale of the table that is shown now."""
    shown = server._shown
    return shown.message.surface.scale if shown else None


def no_sheet(tab: Tab) -> bool:
    """True if nothing lies over the table."""
    return bool(tab.evaluate("document.querySelector('.sheet') === null"))


def test_a_phone_plays_at_once_on_a_scaled_table_that_does_not_count(
    browser: Browser, server: PageServer, tmp_path: Path
) -> None:
    with opened(browser, server.url, (844, 390)) as tab:
        tab.wait(READY)
        assert wait_for(lambda: scale(server) not in (None, 1.0))
        tab.wait("document.querySelector('.preparing').hidden")
        (tmp_path / "played.png").write_bytes(tab.picture())
        assert no_sheet(tab)
        shown = server._shown
        assert shown is not None and not shown.message.scored


PANELS = (
    "JSON.stringify([...document.querySelectorAll("
    "'.words, .score, .buttons button, .pill, .hint, .full, .toast')]"
    ".filter(e => e.checkVisibility({visibilityProperty: true}))"
    ".map(e => e.getBoundingClientRect())"
    ".map(r => [r.left, r.top, r.right, r.bottom]))"
)
"""Left, top, right and bottom of what lies over the table or beside it, CSS pixels."""


@pytest.mark.parametrize("language", ["en", "de"])
@pytest.mark.parametrize("size", [(844, 390), (390, 844)])
def test_on_a_phone_words_and_buttons_stand_beside_the_table(
    browser: Browser, server: PageServer, size: tuple[int, int], language: str
) -> None:
    tab = browser.open(
        "about:blank", width=size[0], height=size[1], storage={"hand-sandbox:quality": "3"}
    )
    tab.call(
        "Emulation.setUserAgentOverride", userAgent="Chromium on a phone", acceptLanguage=language
    )
    tab.go(server.url)
    tab.wait(READY)
    assert wait_for(lambda: scale(server) not in (None, 1.0))
    tab.wait("document.querySelector('.preparing').hidden")
    tab.wait("document.querySelector('.hint').checkVisibility()")
    tab.evaluate("new Promise((done) => setTimeout(done, 300))")
    assert server.screen is not None
    wide, high = server.screen.width_px, server.screen.height_px
    panels = json.loads(tab.evaluate(PANELS))
    assert len(panels) >= 6
    for left, top, right, bottom in panels:
        assert left >= 0 and top >= 0 and right <= size[0] and bottom <= size[1]
        if size[0] > size[1]:
            assert right <= size[0] - wide
        else:
            # The table ends above the row of buttons.
            assert bottom <= size[1] - high - 60 or top >= size[1] - 66
    tab.close()


def test_a_phone_that_looks_on_leaves_its_place(browser: Browser, server: PageServer) -> None:
    with opened(browser, server.url, (844, 390)) as tab:
        tab.wait(READY)
        tab.tap(ENGLISH["settings"])
        tab.tap(ENGLISH["look_on"])
        tab.wait("location.search.includes('spectator')")
        tab.wait(READY)
        assert "token" not in tab.evaluate("location.search")
        assert tab.evaluate("document.querySelector('.buttons').hidden")


def test_a_screen_that_only_seems_small_is_played_in_true_size_once_it_is_measured(
    browser: Browser, server: PageServer
) -> None:
    with opened(browser, server.url, (844, 390)) as tab:
        tab.wait(READY)
        assert wait_for(lambda: scale(server) not in (None, 1.0))
        tab.tap(ENGLISH["settings"])
        tab.tap(ENGLISH["measure_screen"])
        assert sheet(tab) == ENGLISH["card_title"]
        # A guess that was not compared with a card is not taken for a measurement.
        tab.tap(ENGLISH["card_fits"])
        assert sheet(tab) == ENGLISH["card_title"]
        assert server.screen is not None
        assert not server.screen.calibrated
        tab.evaluate(
            "(() => { const slider = document.querySelector('.slider');"
            " slider.value = 70; slider.dispatchEvent(new Event('input')); })()"
        )
        tab.tap(ENGLISH["card_fits"])
        assert wait_for(lambda: scale(server) == 1.0)


def test_no_phone_is_offered_a_scaled_table_in_a_study(browser: Browser) -> None:
    server = PageServer(study=StudyView("en", {}, ["task", "goal"]))
    try:
        with opened(browser, server.url, (844, 390)) as tab:
            tab.wait("!!document.querySelector('.dot')")
            assert wait_for(lambda: server.screen is not None)
            assert server.screen is not None and server.screen.fit == ""
        with opened(browser, server.url, (1280, 800), mouse=True) as tab:
            tab.wait(READY)
            assert server.screen is not None and server.screen.fit == ""
    finally:
        server.close()


def test_with_a_mouse_the_table_fills_the_window_and_counts(
    browser: Browser, server: PageServer, tmp_path: Path
) -> None:
    with opened(browser, server.url, (2560, 1440), mouse=True) as tab:
        tab.wait(READY)
        tab.wait("document.querySelector('.preparing').hidden")
        (tmp_path / "mouse.png").write_bytes(tab.picture())
        shown = server._shown
        assert shown is not None and shown.message.scored
        surface = shown.message.surface
        assert surface.width_in * surface.scale * 110 == pytest.approx(2560, rel=0.01)
        assert surface.height_in * surface.scale * 110 == pytest.approx(1440, rel=0.01)
        # What is touched is what is drawn there: a press in the middle is the middle of the table.
        for kind in ("mousePressed", "mouseMoved"):
            tab.call(
                "Input.dispatchMouseEvent",
                type=kind,
                x=1280,
                y=720,
                button="left",
                buttons=1,
                clickCount=1,
            )
        middle = surface.width_in / 2 * 0.0254, surface.height_in / 2 * 0.0254

        def pressed() -> bool:
            moment = server._moment
            contacts = moment[2].hands[0].contacts if moment else ()
            if not contacts:
                return False
            assert (contacts[0].x, contacts[0].y) == pytest.approx(middle, abs=1e-3)
            return True

        assert wait_for(pressed)


def test_a_window_that_became_too_small_is_told_to_be_larger_and_keeps_its_trial(
    browser: Browser, server: PageServer
) -> None:
    with opened(browser, server.url, (1280, 800), mouse=True) as tab:
        tab.wait(READY)
        tab.wait("document.querySelector('.preparing').hidden")
        at = {"x": 640, "y": 500, "button": "left", "buttons": 1, "clickCount": 1}
        tab.call("Input.dispatchMouseEvent", type="mousePressed", **at)
        assert wait_for(lambda: bool(server._moment) and server._moment[2].time > 0.3)
        scene = server.next_scene()
        tab.call("Input.dispatchMouseEvent", type="mouseReleased", **{**at, "buttons": 0})
        tab.resize(900, 600)
        tab.wait("!document.querySelector('.turned').hidden")
        assert ENGLISH["window_smaller"] in tab.text()
        tab.resize(1280, 800)
        tab.wait("document.querySelector('.turned').hidden")
        assert server.next_scene() == scene


def test_a_tablet_can_be_named_in_the_place_of_a_card(browser: Browser, server: PageServer) -> None:
    # An iPad Air of 11 inches lies: 2360 x 1640 pixels, 264 an inch, two to a CSS pixel.
    with opened(browser, server.url, (1180, 820)) as tab:
        tab.wait(READY)
        assert no_sheet(tab)
        tab.tap(ENGLISH["settings"])
        tab.tap(ENGLISH["measure_screen"])
        assert sheet(tab) == ENGLISH["card_title"]
        names = tab.evaluate("[...document.querySelectorAll('.devices option')].map(o => o.text)")
        air = next(name for name in names if name.startswith("iPad Air 10.9"))
        # Screens of other proportions are not offered.
        assert not any(name.startswith(("Galaxy", "Pixel")) for name in names)
        tab.evaluate(
            "(() => { const s = document.querySelector('.devices');"
            f" s.selectedIndex = {names.index(air)}; s.dispatchEvent(new Event('change')); }})()"
        )
        tab.tap(ENGLISH["card_fits"])
        assert wait_for(lambda: server.screen is not None and server.screen.calibrated)
        assert server.screen is not None
        assert server.screen.px_per_in == pytest.approx(132.0)


def test_when_a_pixel_has_another_size_an_inch_has_another_number_of_them(
    browser: Browser,
) -> None:
    server = PageServer(study=StudyView("en", {}, ["task"]))

    def told(ppi: float, calibrated: bool) -> bool:
        screen = server.screen
        assert screen is not None
        return screen.px_per_in == pytest.approx(ppi) and screen.calibrated == calibrated

    def zoom(tab: Tab, factor: float, smaller: bool) -> None:
        """As ctrl and + do; `smaller` in a browser that counts the screen in CSS pixels."""
        width, height = (round(side / factor) for side in (1280, 800))
        screen = (width, height) if smaller else (1280, 800)
        tab.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=factor,
            mobile=False,
            screenWidth=screen[0],
            screenHeight=screen[1],
        )

    known = {"hand-sandbox:px-per-inch:800x1280@1": "80"}
    try:
        with opened(browser, server.url, (1280, 800), **known) as tab:  # type: ignore[arg-type]
            tab.wait(READY)
            assert told(80.0, True)
            for smaller in (True, False):
                zoom(tab, 1.25, smaller)
                # Nobody can tell it from another monitor, so the number is a guess.
                assert wait_for(lambda: told(64.0, False)), server.screen
                zoom(tab, 1.0, smaller)
                assert wait_for(lambda: told(80.0, True)), server.screen
    finally:
        server.close()


def test_a_page_without_a_size_is_connected_once_it_has_one(browser: Browser) -> None:
    server = PageServer()
    try:
        with opened(browser, "about:blank", (1280, 800)) as tab:
            tab.call(
                "Page.addScriptToEvaluateOnNewDocument",
                source="window.wide = 0;"
                "Object.defineProperty(window, 'innerWidth', { get: () => wide });",
            )
            tab.go(server.url)
            tab.wait("wide === 0 && !!document.querySelector('.dot')")
            tab.evaluate("new Promise((done) => setTimeout(done, 500))")
            assert not server.clients and not server.counters.as_dict()
            tab.evaluate("window.wide = 1280; dispatchEvent(new Event('resize')); true")
            assert wait_for(lambda: server.screen is not None and server.screen.width_px == 1280)
            # A window that is minimized keeps the size that it is known by.
            tab.evaluate("window.wide = 0; dispatchEvent(new Event('resize')); true")
            tab.evaluate("new Promise((done) => setTimeout(done, 500))")
            assert not server.counters.as_dict()
    finally:
        server.close()


def test_published_sizes_agree_with_the_diagonals_in_the_names() -> None:
    listed = json.loads(PUBLISHED.read_text(encoding="utf-8"))["devices"]
    for device in listed:
        diagonal = (device["long_px"] ** 2 + device["short_px"] ** 2) ** 0.5
        inches = device.get("diagonal_in") or diagonal / device["ppi"]
        assert device["long_px"] > device["short_px"]
        # Makers round to a tenth of an inch, and to whole pixels an inch.
        sizes = [float(size) for size in re.findall(r'([\d.]+)"', device["name"])]
        assert any(abs(inches - size) < 0.15 for size in sizes), device["name"]


def test_on_a_large_monitor_forms_are_larger_and_a_line_is_marked_where_it_is_touched(
    browser: Browser,
) -> None:
    def box(selector: str, side: str) -> float:
        inside = f"document.querySelector({selector!r}).getBoundingClientRect()"
        return float(tab.evaluate(f"{inside}.{side}"))

    heights = []
    for size in ("1280x800", "3840x2160"):
        for name, tab in in_study(browser, "en", size):
            if name != "study_form":
                continue
            heights.append(box(".option", "height"))
            if size == "1280x800":
                continue
            left, width = box(".track", "left"), box(".track", "width")
            y = (box(".track", "top") + box(".track", "bottom")) / 2
            tab.touch([(1, left + 0.75 * width, y)])
            tab.touch([])
            middle = (box(".mark", "left") + box(".mark", "right")) / 2
            assert middle == pytest.approx(left + 0.75 * width, abs=0.01 * width)
            assert box(".item:last-child", "bottom") <= box(".foot", "top")
    assert heights[1] == pytest.approx(2 * heights[0])
