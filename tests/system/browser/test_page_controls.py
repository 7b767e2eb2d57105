"""What lies around the table in a real browser: the lift control, the hint, dialogs, messages."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest

from models.frames import TouchFrame
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import LIFT_STRIP_PX, ItemView, PageScreen, Sheet, StudyView, TaskName
from sandbox.server.screen import LARGEST, rectangle
from sandbox.session.messages import Snapshot
from tasks.score import Status
from tests.sandbox.server.staged_page import KEY, KNOWN, PPI, READY, frames, staged
from tests.sandbox.server.test_page_server import Stage, wait_for
from tests.support.chromium import BINARY, Browser, Tab
from tests.system.browser.away_page import DRAWN, REST, PlayedPage, playing

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

SCREENS = {
    "iPad": (1024, 768, 132.0),
    "iPad, upright": (768, 1024, 132.0),
    "iPad mini": (1133, 744, 163.0),
    "iPad Pro": (1366, 1024, 132.0),
    "Android tablet": (1280, 800, 149.0),
    "laptop": (1440, 900, 110.0),
    "monitor": (2560, 1440, 109.0),
}
"""Width and height in CSS pixels, and pixels per inch."""
BOX = """
(() => {
  const box = document.querySelector('.lift-strip').getBoundingClientRect();
  return [box.left, box.right];
})()
"""


def known(width: int, height: int, ppi: float) -> dict[str, str]:
    """What a page on a screen remembers whose person has measured it, and seen no hint."""
    low, high = sorted((width, height))
    return {
        f"hand-sandbox:px-per-inch:{low}x{high}@1": str(ppi),
        "hand-sandbox:quality": "3",
    }


def lifting(browser: Browser, server: PageServer, name: str) -> tuple[Tab, Stage, float, float]:
    """A page with a task that lifts; left and right of its touch rectangle."""
    width, height, ppi = SCREENS[name]
    size = rectangle(PageScreen(ppi, width, height, True), lifts=True)
    stage = staged(server, task="stack", **size)
    tab = browser.open(server.url, width=width, height=height, storage=known(*SCREENS[name]))
    tab.wait(READY)
    tab.wait("!document.querySelector('.lift-strip').hidden")
    wide = size["size_in"][0] * ppi
    left = max((width - wide) / 2, LIFT_STRIP_PX)
    return tab, stage, left, left + wide


def lifted_to(found: list[TouchFrame], lift: float) -> bool:
    """True if the newest frame has this position of the lift control."""
    return bool(found) and found[-1].lift == pytest.approx(lift)


@pytest.mark.parametrize("name", SCREENS)
def test_the_lift_control_is_beside_the_touch_rectangle_on_every_screen(
    browser: Browser, server: PageServer, name: str
) -> None:
    width, height, ppi = SCREENS[name]
    tab, stage, left, right = lifting(browser, server, name)
    first, last = tab.evaluate(BOX)
    assert first >= 0.0 and last <= left + 0.01
    assert last - first == LIFT_STRIP_PX
    assert right <= width + 0.01
    # A finger right beside it is at the border of the rectangle, and one on it is none.
    middle = height / 2
    tab.touch([(1, left + 1.0, middle), (2, first + 3.0, middle)])
    down = frames(stage, lambda found: bool(found) and len(found[-1].contacts) == 1)[-1]
    assert down.contacts[0].x == pytest.approx(1.0 / ppi * 0.0254, abs=1e-5)
    tab.touch([])
    tab.close()


def test_a_screen_that_is_wide_enough_gives_nothing_of_its_rectangle_to_the_lift_control() -> None:
    wide = PageScreen(109.0, 2560, 1440, True)
    assert rectangle(wide, lifts=True) == rectangle(wide)
    assert rectangle(wide)["size_in"] == LARGEST


def test_the_lift_control_is_a_slider_that_keys_and_wheel_move(
    browser: Browser, server: PageServer
) -> None:
    tab, stage, _, _ = lifting(browser, server, "iPad")
    asked = "document.querySelector('[role=slider]').getAttribute('{}')"
    assert tab.evaluate(asked.format("aria-orientation")) == "vertical"
    assert tab.evaluate(asked.format("aria-label")) == "lift"
    assert tab.evaluate("document.querySelector('[role=slider]').tabIndex") == 0
    now = asked.format("aria-valuenow")
    assert tab.evaluate(now) == "0"
    for key, value in (("ArrowUp", "5"), ("PageUp", "25"), ("ArrowDown", "20"), ("PageDown", "0")):
        tab.call("Input.dispatchKeyEvent", type="keyDown", key=key)
        tab.call("Input.dispatchKeyEvent", type="keyUp", key=key)
        tab.wait(f"{now} === '{value}'")
        frames(stage, lambda found: lifted_to(found, int(value) / 100))  # noqa: B023
    tab.call("Input.dispatchMouseEvent", type="mouseWheel", x=500, y=400, deltaX=0, deltaY=-250)
    tab.wait(f"Number({now}) > 20")
    tab.close()


def press(tab: Tab, key: str, code: int) -> None:
    """A key, with the number that browsers scroll by."""
    for kind in ("rawKeyDown", "keyUp"):
        tab.call("Input.dispatchKeyEvent", type=kind, key=key, code=key, windowsVirtualKeyCode=code)


def roll(tab: Tab, by: float, **more: int) -> None:
    """The wheel, over the middle of the page."""
    at = {"x": 500, "y": 400, "deltaX": 0, "deltaY": by, **more}
    tab.call("Input.dispatchMouseEvent", type="mouseWheel", **at)


LIFT = "document.querySelector('.lift').getAttribute('aria-valuenow')"

AT_REST = """new Promise((done) => {
    const veil = document.querySelector('.veil');
    let before = -1;
    let same = 0;
    const look = () => {
        same = veil.scrollTop === before ? same + 1 : 0;
        before = veil.scrollTop;
        if (same === 10) done(true);
        else requestAnimationFrame(look);
    };
    look();
})"""
"""A script that ends when the menu's sheet has stood still for ten frames."""


def test_wheel_and_keys_belong_to_the_menu_that_is_open_and_not_to_the_lift_control(
    browser: Browser, tmp_path: Path
) -> None:
    with playing(browser, tmp_path, "stack") as page:
        tab = page.tab
        tab.wait(DRAWN)
        press(tab, "PageUp", 33)
        tab.wait(f"{LIFT} === '20'")
        # With ctrl, it zooms the page.
        roll(tab, -250, modifiers=2)
        tab.tap("Tasks")
        tab.wait("document.querySelector('.veil').scrollHeight > innerHeight")
        scrolled = "document.querySelector('.veil').scrollTop"
        roll(tab, 250)
        tab.wait(f"{scrolled} > 100")
        # Chromium scrolls smoothly, and a scroll under way takes no key: on a slow computer it may
        # begin again after a rest.
        for _ in range(10):
            tab.evaluate(AT_REST)
            press(tab, "PageUp", 33)
            tab.evaluate(AT_REST)
            if tab.evaluate(f"{scrolled} === 0"):
                break
        assert tab.evaluate(f"{scrolled} === 0")
        press(tab, "ArrowUp", 38)
        assert tab.evaluate(LIFT) == "20"


def test_keys_belong_to_the_form_that_is_open_and_not_to_the_lift_control(
    browser: Browser,
) -> None:
    server = PageServer(study=StudyView("en", {}, ["task"]))
    try:
        tab, _, _, _ = lifting(browser, server, "iPad")
        items = [
            ItemView("effort", "scale", "How much?", True, [], 0.0, 100.0, 5.0, "little", "much"),
            ItemView("remarks", "text", "Anything?", True, [], 0.0, 1.0, 1.0, "", ""),
        ]
        server.show_sheet(Sheet(1, "form", "", "", items, {}, 0.0))
        tab.wait("document.querySelector('.study').dataset.kind === 'form'")
        tab.evaluate("document.querySelector('.line').focus()")
        for _ in range(3):
            press(tab, "ArrowUp", 38)
        tab.wait("document.querySelector('.line').getAttribute('aria-valuenow') === '10'")
        roll(tab, -250)
        # In a text, the key goes to its beginning.
        tab.evaluate("document.querySelector('textarea').focus()")
        tab.call("Input.insertText", text="one line")
        press(tab, "ArrowUp", 38)
        tab.wait("document.querySelector('textarea').selectionStart === 0")
        assert tab.evaluate(LIFT) == "0"
        tab.close()
    finally:
        server.close()


SHOWN = "document.querySelector('.reason').textContent.startsWith('This is how')"
"""True while a demonstration is shown."""
EXAMPLE = "document.querySelector('.reason').textContent.startsWith('Only an example')"
"""True while a demonstration is shown within a trial."""
HINT = "document.querySelector('.hint').checkVisibility() && document.querySelector('.hint-words')"


def test_a_task_is_shown_on_its_own_table_until_the_player_touches_and_again_behind_a_button(
    browser: Browser, tmp_path: Path
) -> None:
    with playing(browser, tmp_path, "box-to-goal", hint=True) as page:
        tab = page.tab
        tab.wait(DRAWN)
        assert "either side of the box" in tab.evaluate(f"{HINT}.textContent")
        tab.wait(SHOWN)
        assert page.time == pytest.approx(0.0, abs=0.05) and page.pause == "start"
        tab.touch(REST)
        tab.wait(f"!({SHOWN})")
        assert wait_for(lambda: page.time > 0.3)
        tab.touch([])
        tab.tap("?")
        tab.wait(EXAMPLE)
        assert wait_for(lambda: page.pause == "menu")
        stood = page.stops()
        page.touch_again()
        assert wait_for(lambda: page.time > stood + 0.2)
        tab.wait(f"!({EXAMPLE})")


def test_who_has_done_a_task_is_not_shown_how(browser: Browser, server: PageServer) -> None:
    tab = browser.open(server.url, storage={KEY: str(PPI), "hand-sandbox:best:box-to-goal": "9.00"})
    tab.wait(READY)
    server.publish(shown(server), "start")
    tab.wait(DRAWN)
    assert not tab.evaluate("document.querySelector('.hint').checkVisibility()")
    asked: list[str] = []

    def demonstrates() -> bool:
        asked.extend(request.what for request in server.take_requests())
        return "demo" in asked

    def helped() -> bool:
        # On a busy machine a page may lose its connection, and with it the request: it begins anew.
        if not tab.evaluate("document.querySelector('.hint').checkVisibility()"):
            tab.tap("?")
        return demonstrates()

    assert not demonstrates()
    assert wait_for(helped)
    tab.close()


def test_a_hint_that_was_closed_in_one_task_comes_in_others(
    browser: Browser, server: PageServer
) -> None:
    visible = "document.querySelector('.hint').checkVisibility()"
    for closed, comes in (("dial", True), ("box-to-goal", False)):
        known = {KEY: str(PPI), f"hand-sandbox:hint-closed:{closed}": "yes"}
        tab = browser.open(server.url, storage=known)
        tab.wait(READY)
        server.publish(shown(server), "start")
        tab.wait(DRAWN)
        assert tab.evaluate(visible) is comes
        if comes:
            tab.tap("Got it")
            kept = "localStorage.getItem('hand-sandbox:hint-closed:box-to-goal')"
            assert tab.evaluate(kept) == "yes"
        tab.close()


def test_a_lifted_hand_stays_lifted_through_a_reload(browser: Browser, tmp_path: Path) -> None:
    with playing(browser, tmp_path, "stack") as page:
        page.begin()
        for _ in range(3):
            page.tab.call("Input.dispatchKeyEvent", type="keyDown", key="PageUp")
        now = "document.querySelector('[role=slider]').getAttribute('aria-valuenow')"
        page.tab.wait(f"{now} === '60'")
        page.tab.touch([])
        page.tab.reload()
        assert wait_for(lambda: page.pause == "back")
        page.tab.wait(DRAWN)
        assert page.tab.wait(f"{now} === '60'")


@pytest.fixture
def page(browser: Browser) -> Iterator[PlayedPage]:
    with (
        tempfile.TemporaryDirectory() as folder,
        playing(browser, Path(folder), hint=True) as page,
    ):
        page.tab.wait(DRAWN)
        yield page


def test_a_menu_takes_the_focus_and_gives_it_back(page: PlayedPage) -> None:
    tab = page.tab
    tab.evaluate(
        "(() => { const b = [...document.querySelectorAll('button')]"
        ".find(b => b.innerText === 'Tasks'); b.focus(); b.click(); return true; })()"
    )
    tab.wait("document.querySelector('[role=dialog][aria-modal=true]') !== null")
    assert tab.evaluate("document.activeElement.closest('[role=dialog]') !== null")
    # Neither a key nor a screen reader reaches what is behind it.
    tab.evaluate("document.querySelector('.hud button').focus()")
    assert tab.evaluate("document.activeElement.closest('.hud') === null")
    zoom = "document.querySelector('meta[name=viewport]').content.includes('user-scalable=no')"
    assert not tab.evaluate(zoom)
    tab.tap("Close")
    tab.wait("document.querySelector('.sheet') === null")
    assert tab.evaluate("document.activeElement.innerText") == "Tasks"
    # On the table everything has its true size.
    assert tab.evaluate(zoom)


def shown(server: PageServer) -> Snapshot:
    """The first snapshot of a new trial that the page shows."""
    stage = staged(server)

    def is_shown() -> bool:
        return server._shown is not None and server._shown.message.scene == server._scenes

    assert wait_for(is_shown)
    return stage.session.advance()


def test_a_success_shows_the_best_time_and_the_next_task_and_a_tick_in_the_menu(
    browser: Browser,
) -> None:
    server = PageServer(
        tasks=[TaskName(name, "", False) for name in ("box-to-goal", "wrench-turn", "dial")]
    )
    best = {"hand-sandbox:best:wrench-turn": "3.00"}
    text = "document.querySelector('{}').textContent"
    try:
        tab = browser.open(server.url, storage=KNOWN | best)
        tab.wait(READY)
        for took, told in (
            (9.0, ""),
            (8.0, "Your best time so far"),
            (8.5, "Your best time: 8.0 s"),
        ):
            snapshot = shown(server)
            tab.wait("document.querySelector('.end').hidden")
            score = replace(snapshot.score, held=True, final=True, progress=1.0)
            server.publish(replace(snapshot, time=took, score=score))
            tab.wait("document.querySelector('.bar-fill').classList.contains('done')")
            # The picture of this moment, since the next one replaces it where it is not yet drawn.
            tab.wait(f"{text.format('.clock')}.startsWith('{took} ')")
            score = replace(score, status=Status.HELD)
            server.publish(replace(snapshot, time=took + 1.0, score=score))
            tab.wait("!document.querySelector('.end').hidden")
            assert tab.evaluate(text.format(".end-words")) == f"Done in {took} s"
            # The clock at the top, a second later, has no other time.
            assert tab.evaluate(text.format(".clock")).startswith(f"{took} ")
            assert tab.evaluate(text.format(".end-detail")) == told
        # The wrench was turned before.
        assert tab.evaluate(text.format(".end .primary")) == "Next: Dial"
        tab.tap("Watch it again")
        tab.wait("!document.querySelector('.end').classList.contains('watching')")
        tab.tap("Tasks")
        ticks = "[...document.querySelectorAll('.choice b')].map(b => b.textContent)"
        assert tab.evaluate(ticks) == ["Done in 8.0 s", "Done in 3.0 s"]
        tab.tap("Close")
        tab.tap("Next: Dial")
        asked: list[str] = []

        def is_asked() -> bool:
            asked.extend(request.value for request in server.take_requests())
            return "dial" in asked

        assert wait_for(is_asked)
        tab.close()
    finally:
        server.close()
