"""A player's page that goes away in a real browser, and finds back to the same place."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from sandbox.server import clients
from sandbox.server.page_server import PageServer
from sandbox.words import words_in
from tests.sandbox.server.test_page_server import wait_for
from tests.support.chromium import BINARY, Browser
from tests.system.browser.away_page import (
    DRAWN,
    HEIGHT,
    READY,
    REST,
    WIDTH,
    Absence,
    PlayedPage,
    absence,
    contacts,
    go_back,
    hide,
    lose_network,
    playing,
    reload,
    replays,
    results,
    throw_away,
    turn,
)

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

full = pytest.mark.full
ENGLISH = words_in("en")


@pytest.mark.parametrize(
    ("kind", "seconds"),
    [
        pytest.param(reload, 0.0, id="reload"),
        pytest.param(go_back, 1.0, id="back"),
        pytest.param(throw_away, 1.0, id="thrown away"),
        pytest.param(turn, 1.0, id="turned"),
        pytest.param(hide, 1.0, id="hidden for 1 s"),
        pytest.param(hide, 10.0, id="hidden for 10 s", marks=full),
    ],
)
def test_a_page_finds_back_to_its_trial_in_which_time_stood_still(
    browser: Browser, tmp_path: Path, kind: Callable[[PlayedPage], Absence], seconds: float
) -> None:
    with playing(browser, tmp_path) as page:
        page.begin()
        seen = absence(page, kind, seconds)
        assert seen.same_trial and seen.stood_still
        assert page.server.seated == 1
        token = page.server.access.token
        assert token not in page.tab.evaluate("location.href")
        assert not page.tab.events("Runtime.exceptionThrown")
    result = results(tmp_path)[0]
    assert max(gap["lasted_s"] for gap in result["absences"]) > seconds
    assert replays(tmp_path)


@pytest.mark.parametrize("seconds", [3.0, pytest.param(10.0, marks=full)])
def test_fingers_that_rest_while_the_network_is_gone_go_on_as_the_same_contacts(
    browser: Browser, tmp_path: Path, seconds: float
) -> None:
    with playing(browser, tmp_path) as page:
        page.begin()
        seen = absence(page, lose_network, seconds)
        assert seen.same_trial and seen.stood_still and seen.by_itself
    assert len(contacts(tmp_path)) == len(REST)
    gaps = results(tmp_path)[0]["absences"]
    assert max(gap["lasted_s"] for gap in gaps) > seconds - clients.SILENT_TOUCHED
    assert replays(tmp_path)


def test_a_page_whose_connection_is_lost_says_so_and_draws_the_hand_faint(
    browser: Browser, tmp_path: Path
) -> None:
    with playing(browser, tmp_path) as page:
        page.begin()
        page.network.close()
        page.tab.wait("!document.querySelector('.curtain').hidden")
        assert "Connection lost" in page.tab.text()
        # So it says after ten failures.
        page.tab.wait(f"document.body.innerText.includes({ENGLISH['no_answer']!r})")
        assert not page.tab.events("Runtime.exceptionThrown")


def test_a_second_page_gets_the_seat_only_after_the_player_was_away_for_long(
    browser: Browser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with playing(browser, tmp_path) as page:
        page.begin()
        second = page.open()
        second.wait(READY)
        second.wait("document.body.innerText.includes('another page plays')")
        assert absence(page, go_back, 1.0).same_trial
        assert page.server.seated == 1
        monkeypatch.setattr(clients, "SEAT_TIMEOUT", 0.5)
        page.tab.go("about:blank")
        second.wait("!document.body.innerText.includes('another page plays')")
        assert wait_for(lambda: page.scene == 2)
        second.wait(DRAWN)
        second.close()


def test_who_looks_on_reads_that_the_player_is_away(browser: Browser, tmp_path: Path) -> None:
    with playing(browser, tmp_path) as page:
        page.begin()
        projector = page.open("&role=spectator")
        projector.wait(READY)
        going = hide(page)
        next(going)
        projector.wait("document.body.innerText.includes('The player is away')")
        next(going, None)
        projector.wait("document.body.innerText.includes('with the player')")
        projector.close()


def test_a_screen_that_stays_turned_gets_a_new_table_when_the_player_wants_it(
    browser: Browser, tmp_path: Path
) -> None:
    with playing(browser, tmp_path) as page:
        page.begin()
        page.tab.touch([])
        page.tab.resize(HEIGHT, WIDTH)
        page.tab.wait("document.body.innerText.includes('Turn it back')")
        page.tab.tap("Start anew like this")
        assert wait_for(lambda: page.scene == 2)
        page.tab.wait(DRAWN + " && document.querySelector('.turned').hidden")
        assert wait_for(lambda: page.pause == "start")


def test_however_long_the_program_was_away_a_page_with_a_refused_token_says_so_and_stops(
    browser: Browser, tmp_path: Path
) -> None:
    with playing(browser, tmp_path) as page:
        page.begin()
        page.server.close()
        page.tab.wait(f"document.body.innerText.includes({ENGLISH['goodbye']!r})")
        other = another(page.server)
        try:
            page.tab.wait(f"document.body.innerText.includes({ENGLISH['link_invalid']!r})")
            tried = len(page.tab.events("Network.webSocketCreated"))
            page.tab.evaluate("new Promise((done) => setTimeout(done, 1500))")
            assert len(page.tab.events("Network.webSocketCreated")) == tried
        finally:
            other.close()


def test_at_the_end_of_the_program_every_page_says_goodbye_and_comes_back_with_the_program(
    browser: Browser, tmp_path: Path
) -> None:
    with playing(browser, tmp_path) as page:
        page.begin()
        second = page.open()
        second.wait(READY)
        page.server.close()
        for tab in (page.tab, second):
            tab.wait(f"document.body.innerText.includes({ENGLISH['goodbye']!r})")
        # The words stay, whatever it tries meanwhile.
        page.tab.evaluate("new Promise((done) => setTimeout(done, 4000))")
        assert ENGLISH["goodbye"] in page.tab.text()
        again = another(page.server, page.server.access.token)
        try:
            page.tab.wait(READY)
        finally:
            again.close()
        second.close()


def test_a_browser_that_opens_the_link_again_takes_its_own_seat(
    browser: Browser, tmp_path: Path
) -> None:
    with playing(browser, tmp_path) as page:
        page.begin()
        again = page.tab.same_browser(page.url)
        again.wait(DRAWN)
        assert not again.evaluate("document.querySelector('.buttons').hidden")
        page.tab.wait(f"document.body.innerText.includes({ENGLISH['in_another_tab']!r})")
        assert page.server.seated == 1
        again.touch(REST)
        before = page.time
        assert wait_for(lambda: page.time > before + 0.2)
    # Its touches are not taken for those of the tab before.
    assert len(contacts(tmp_path)) == 2 * len(REST)


def another(server: PageServer, token: str = "") -> PageServer:
    """The program started anew, in the place of a server that was closed; without a token given,
    with another one."""
    other = PageServer(port=server.access.port, token=token)
    other.access = replace(other.access, names=server.access.names)
    return other


def test_fingers_that_were_taken_away_are_told_to_lift(browser: Browser, tmp_path: Path) -> None:
    with playing(browser, tmp_path) as page:
        page.tab.wait(DRAWN)
        page.tab.evaluate(
            "window.written = []; const fill = CanvasRenderingContext2D.prototype.fillText;"
            "CanvasRenderingContext2D.prototype.fillText = function (text, ...rest) {"
            "written.push(text); return fill.call(this, text, ...rest); }; true"
        )
        page.begin()
        page.tab.evaluate("dispatchEvent(new Event('blur'))")
        page.tab.wait("written.includes('Lift your fingers and touch again')")
        page.touch_again()
        page.tab.evaluate("written.length = 0")
        page.tab.wait("written.length > 4")
        assert not page.tab.evaluate("written.includes('Lift your fingers and touch again')")


def test_a_page_that_was_reloaded_with_a_menu_open_before_the_first_touch_plays_at_the_next(
    browser: Browser, tmp_path: Path
) -> None:
    with playing(browser, tmp_path) as page:
        page.tab.wait(DRAWN)
        page.tab.tap(ENGLISH["settings"])
        assert wait_for(lambda: page.pause == "menu")
        # Choosing a language reloads the page.
        page.tab.tap(ENGLISH["language"])
        page.tab.tap("Deutsch")
        page.tab.wait("document.documentElement.lang === 'de'")
        page.begin()


def pinch(page: PlayedPage, first: float, last: float) -> None:
    """Two fingers that go apart or together, from one half distance to another, px."""
    for step in range(11):
        half = first + (last - first) * step / 10
        page.tab.touch([(1, WIDTH / 2 - half, 300.0), (2, WIDTH / 2 + half, 300.0)])
    page.tab.touch([])


def test_a_table_that_is_left_zoomed_says_so_and_waits_until_two_fingers_undo_it(
    browser: Browser, tmp_path: Path
) -> None:
    scale = "window.visualViewport.scale"
    with playing(browser, tmp_path) as page:
        # A browser of a desktop ignores the meta tag that keeps a page from being zoomed.
        page.tab.call(
            "Emulation.setDeviceMetricsOverride",
            width=WIDTH,
            height=HEIGHT,
            deviceScaleFactor=1,
            mobile=False,
            screenWidth=WIDTH,
            screenHeight=HEIGHT,
        )
        page.begin()
        page.tab.touch([])
        page.tab.tap(ENGLISH["tasks"])
        page.tab.wait("!!document.querySelector('.veil')")
        pinch(page, 20.0, 160.0)
        page.tab.wait(f"{scale} > 1.5")
        assert page.tab.evaluate("document.querySelector('.turned').hidden")
        page.tab.evaluate("document.querySelector('.end-row .button').click()")
        page.tab.wait("!document.querySelector('.turned').hidden")
        assert page.tab.evaluate("document.querySelector('.turned').innerText") == ENGLISH["zoomed"]
        # It stands in the part that is seen.
        left, right = page.tab.evaluate(
            "(() => { const box = document.querySelector('.turned').getBoundingClientRect();"
            "const { offsetLeft, width } = visualViewport;"
            "return [box.left - offsetLeft, offsetLeft + width - box.right]; })()"
        )
        assert left == pytest.approx(right, abs=2.0) and left > 0.0
        assert wait_for(lambda: page.pause == "away")
        stood = page.stops()
        page.touch_again()
        page.tab.touch([])
        assert page.stops() == stood
        pinch(page, 300.0, 20.0)
        page.tab.wait(f"{scale} === 1 && document.querySelector('.turned').hidden")
        assert wait_for(lambda: page.pause == "back")
        page.touch_again()
        assert wait_for(lambda: page.time > stood + 0.2)


def test_a_task_without_room_is_played_once_the_screen_is_turned(
    browser: Browser, tmp_path: Path
) -> None:
    with playing(browser, tmp_path) as page:
        page.tab.wait(DRAWN)
        first = page.scene
        page.tab.resize(480, WIDTH)
        assert wait_for(lambda: page.scene > first), page.tab.text()
        page.tab.wait(DRAWN)
        page.tab.tap("Tasks")
        page.tab.tap("Stack vertical")
        page.tab.wait("!document.querySelector('.trouble').hidden")
        assert "then there is enough room" in page.tab.text()
        before = page.scene
        page.tab.resize(WIDTH, 480)
        assert wait_for(lambda: page.scene > before), page.tab.text()
        page.tab.wait("document.querySelector('.trouble').hidden && " + DRAWN)
