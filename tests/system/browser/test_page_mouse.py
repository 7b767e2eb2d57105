"""Mouse and keys in a real browser are one finger or a whole hand, as in the program's window."""

from __future__ import annotations

import contextlib
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sandbox.devices.mouse.mouse import WHEEL_FACTOR, default_hand
from sandbox.session.messages import Snapshot
from sandbox.words import words_in
from tests.sandbox.server.test_page_server import wait_for
from tests.support.chromium import BINARY, Browser
from tests.support.processes import PATIENCE
from tests.system.browser.away_page import DRAWN, PlayedPage, playing
from tests.system.browser.seen_words import seen, watch

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

ENGLISH = words_in("en")
CTRL, SHIFT = 2, 8
MIDDLE = (400.0, 300.0)
"""CSS pixels, middle of the page and of its table."""


class Desk:
    """A page that is played with mouse and keys."""

    def __init__(self, page: PlayedPage) -> None:
        self.page = page

    def mouse(self, kind: str, at: tuple[float, float], **more: Any) -> None:
        button = "none" if kind in ("mouseWheel",) or not more.get("buttons", 1) else "left"
        self.page.tab.call(
            "Input.dispatchMouseEvent",
            **{"type": kind, "x": at[0], "y": at[1], "button": button, "clickCount": 1, **more},
        )

    def drag(
        self, start: tuple[float, float], end: tuple[float, float], modifiers: int = 0
    ) -> None:
        for kind, at, buttons in (
            ("mousePressed", start, 1),
            ("mouseMoved", end, 1),
            ("mouseReleased", end, 0),
        ):
            self.mouse(kind, at, button="left", buttons=buttons, modifiers=modifiers)

    def key(self, key: str) -> None:
        self.page.tab.call("Input.dispatchKeyEvent", type="keyDown", key=key, text=key)
        self.page.tab.call("Input.dispatchKeyEvent", type="keyUp", key=key)

    def fingers(self) -> dict[int | None, np.ndarray]:
        """(2,) m of every finger that is down, by label."""
        moment: Any = self.page.server._moment
        snapshot: Snapshot = moment[2]
        return {c.label: np.array([c.x, c.y]) for hand in snapshot.hands for c in hand.contacts}

    def labels(self, *labels: int) -> bool:
        return wait_for(lambda: sorted(k for k in self.fingers() if k is not None) == list(labels))


@pytest.fixture
def desk(browser: Browser, tmp_path: Path) -> Iterator[Desk]:
    with at_desk(browser, tmp_path) as desk:
        yield desk


@contextlib.contextmanager
def at_desk(browser: Browser, folder: Path, task: str = "box-to-goal") -> Iterator[Desk]:
    with playing(browser, folder, task) as page:
        page.tab.call("Emulation.setTouchEmulationEnabled", enabled=False)
        page.tab.wait(DRAWN)
        desk = Desk(page)
        desk.mouse("mouseMoved", MIDDLE, buttons=0)
        yield desk


def test_a_key_puts_down_the_same_hand_as_in_the_window_and_lifts_it(desk: Desk) -> None:
    desk.key("3")
    assert desk.labels(0, 1, 2)
    wanted = default_hand(3)
    fingers = desk.fingers()
    for label in (1, 2):
        step = fingers[label] - fingers[0]
        assert step == pytest.approx(wanted[label] - wanted[0], abs=1e-3)
    desk.key("2")
    assert desk.labels(0, 1)
    desk.key("2")
    assert desk.labels()
    desk.key("5")
    assert desk.labels(0, 1, 2, 3, 4)
    desk.key(" ")
    assert desk.labels()


def test_a_drag_beside_the_fingers_moves_the_hand_and_one_of_a_finger_moves_it_alone(
    desk: Desk,
) -> None:
    desk.key("2")
    assert desk.labels(0, 1)
    before = desk.fingers()
    desk.drag((300.0, 500.0), (340.0, 500.0))

    def moved(label: int) -> float:
        return float((desk.fingers()[label] - before[label])[0])

    # 40 CSS pixels at 80 to an inch.
    assert wait_for(lambda: moved(0) == pytest.approx(0.0127, abs=1e-4))
    assert moved(1) == pytest.approx(0.0127, abs=1e-4)
    # Nothing is lifted at the end, and the button is up.
    assert desk.labels(0, 1)


def test_the_wheel_closes_the_hand_and_with_shift_turns_it(desk: Desk) -> None:
    desk.key("2")
    assert desk.labels(0, 1)
    before = desk.fingers()
    across = before[1] - before[0]
    desk.mouse("mouseWheel", MIDDLE, deltaX=0, deltaY=500)

    def is_closed() -> bool:
        now = desk.fingers()
        ratio = np.linalg.norm(now[1] - now[0]) / np.linalg.norm(across)
        return bool(ratio == pytest.approx(WHEEL_FACTOR**-5, abs=0.01))

    assert wait_for(is_closed)
    desk.mouse("mouseWheel", MIDDLE, deltaX=0, deltaY=-500, modifiers=SHIFT)

    def is_turned() -> bool:
        now = desk.fingers()[1] - desk.fingers()[0]
        turn = np.arctan2(across[1], across[0]) - np.arctan2(now[1], now[0])
        return bool(np.rad2deg(turn) == pytest.approx(15.0, abs=0.5))

    assert wait_for(is_turned)


def test_a_finger_is_pinned_and_lifted_by_shift_and_click(desk: Desk) -> None:
    for x in (300.0, 500.0):
        desk.drag((x, 480.0), (x, 480.0), modifiers=SHIFT)
    assert wait_for(lambda: len(contacts(desk)) == 2)
    before = contacts(desk)
    desk.drag((100.0, 560.0), (140.0, 560.0), modifiers=CTRL)
    wanted = [x + 0.0127 for x in before]
    assert wait_for(lambda: contacts(desk) == pytest.approx(wanted, abs=1e-4))
    desk.drag((340.0, 480.0), (340.0, 480.0), modifiers=SHIFT)
    assert wait_for(lambda: len(contacts(desk)) == 1)
    # A press elsewhere is one more finger, which is lifted with the button.
    desk.mouse("mousePressed", (200.0, 300.0), buttons=1)
    assert wait_for(lambda: len(contacts(desk)) == 2)
    desk.mouse("mouseReleased", (200.0, 300.0), buttons=0, button="left")
    assert wait_for(lambda: len(contacts(desk)) == 1)


def contacts(desk: Desk) -> list[float]:
    """m from the left of every finger that is down."""
    moment: Any = desk.page.server._moment
    return sorted(c.x for hand in moment[2].hands for c in hand.contacts if c.state == "active")


def test_buttons_work_while_a_pinned_hand_is_down(desk: Desk) -> None:
    desk.key("3")
    assert desk.labels(0, 1, 2)
    assert not desk.page.tab.evaluate("document.body.classList.contains('touching')")


def test_one_finger_in_a_task_that_needs_two_is_told_so_where_it_is(
    browser: Browser, tmp_path: Path
) -> None:
    with playing(browser, tmp_path, "stack") as page:
        tab = page.tab
        watch(tab)
        tab.reload()
        tab.wait(DRAWN)
        until, moved = time.monotonic() + PATIENCE, 0
        while ENGLISH["use_two"] not in seen(tab):
            assert time.monotonic() < until
            moved += 1
            # To and fro: a finger that jumped would be another one.
            tab.touch([(1, 300.0 + abs(moved % 200 - 100), 560.0)])
            time.sleep(0.02)
        tab.touch([(1, 500.0, 560.0), (2, 560.0, 560.0)])


def test_the_lift_control_shows_the_height(browser: Browser, tmp_path: Path) -> None:
    with playing(browser, tmp_path, "stack") as page:
        page.begin()
        for _ in range(3):
            page.tab.call("Input.dispatchKeyEvent", type="keyDown", key="PageUp")
        # 60 % of the 120 mm of the task.
        page.tab.wait("document.querySelector('.lift-knob').textContent === '72 mm'")


def test_the_fingers_that_a_player_uses_are_chosen_by_pictures(
    browser: Browser, tmp_path: Path
) -> None:
    with playing(browser, tmp_path, "box-to-goal") as page:
        tab = page.tab
        tab.wait(DRAWN)
        tab.tap(ENGLISH["settings"])
        tab.tap(ENGLISH["fingers_used"])
        assert tab.evaluate("document.querySelectorAll('.choice svg line').length") == 20
        tab.tap("thumb, index, middle")
        shown = page.server
        assert wait_for(
            lambda: bool(shown._shown) and shown._shown.message.finger_sets == "thumb+index+middle"
        )
        # The page still shows the table before, until the next one has come.
        tab.wait("document.querySelector('.preparing').hidden")
        tab.tap(ENGLISH["settings"])
        tab.tap(ENGLISH["fingers_used"])
        chosen = "document.querySelector('.choice.current').innerText"
        tab.wait(f"{chosen} === 'thumb, index, middle'")
