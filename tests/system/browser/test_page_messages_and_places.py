"""What the page says, when and where, and what covers what has to be touched."""

from __future__ import annotations

import io
import os
import time
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from models.frames import TouchFrame
from sandbox.server.page_server import PageServer
from sandbox.session.collision_gating import STUCK
from sandbox.session.messages import Snapshot
from sandbox.words import words_in
from tests.sandbox.server.staged_page import KEY, PPI, READY, frames, px, staged
from tests.sandbox.server.test_page_server import Stage, wait_for
from tests.support.chromium import BINARY, Browser, Tab
from tests.support.viewed import contact_at

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

ENGLISH = words_in("en")
SIZE = (1180, 820)
KNOWN = {
    f"hand-sandbox:px-per-inch:{min(SIZE)}x{max(SIZE)}@1": "132",
    "hand-sandbox:quality": "3",
}
SAID = (
    "[...document.querySelectorAll('.hint, .lift-again, .toast, .end, .curtain, .turned,"
    ".trouble, .preparing')].filter(e => e.checkVisibility({visibilityProperty: true}))"
    ".map(e => e.className.split(' ')[0]).join()"
)
"""Messages that are visible now."""
WRITTEN = """
window.written = [];
const fill = CanvasRenderingContext2D.prototype.fillText;
const clear = CanvasRenderingContext2D.prototype.clearRect;
CanvasRenderingContext2D.prototype.fillText = function (text, ...rest) {
  written.push(text);
  return fill.call(this, text, ...rest);
};
CanvasRenderingContext2D.prototype.clearRect = function (...rest) {
  written = [];
  return clear.call(this, ...rest);
};
true
"""
PREPARED = """
new Promise((done) => {
  const preparing = document.querySelector('.preparing'), asked = performance.now();
  const watch = new MutationObserver(look);
  function look() {
    if (preparing.hidden) return;
    watch.disconnect();
    done(performance.now() - asked);
  }
  watch.observe(preparing, { attributes: true });
  const again = document.querySelector('.buttons button');
  again.click();
  again.click();
  look();
})
"""
"""ms from the button, pressed twice, to the words."""


@pytest.fixture
def stage(server: PageServer) -> Stage:
    return staged(server, size_in=(8.9, 6.2))


@pytest.fixture
def tab(browser: Browser, server: PageServer) -> Iterator[Tab]:
    tab = browser.open(server.url, width=SIZE[0], height=SIZE[1], storage=KNOWN)
    yield tab
    tab.close()


def started(stage: Stage, tab: Tab) -> Snapshot:
    """The first moment of a trial, drawn."""
    tab.wait(READY)
    tab.wait("!!document.querySelector('.task').textContent")
    snapshot = stage.session.advance()
    stage.server.publish(snapshot)
    tab.wait("document.querySelector('.preparing').hidden")
    return snapshot


def drawn(tab: Tab) -> None:
    """Waits for two pictures."""
    tab.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def test_the_table_is_said_to_be_prepared_until_the_next_one_is_there(
    stage: Stage, tab: Tab
) -> None:
    started(stage, tab)
    assert tab.evaluate(PREPARED) < 300
    # The last pictures of the table before come later, and do not take it away.
    for _ in range(3):
        stage.advance()
        drawn(tab)
    assert tab.evaluate(SAID) == "preparing"
    after = staged(stage.server, size_in=(8.9, 6.2))

    def shown() -> bool:
        # A session goes on; one picture alone may come before the page has its table.
        after.advance()
        return bool(tab.evaluate("document.querySelector('.preparing').hidden"))

    assert wait_for(shown)


def with_fingers(snapshot: Snapshot, ids: list[int], inside: set[int]) -> Snapshot:
    """The fingers of the page, the first one a thumb, some inside an object."""
    hand = snapshot.hands[0]
    contacts = tuple(
        contact_at(hand.surface, i, hand.tips[label], label, "active")
        for label, i in enumerate(ids)
    )
    notices = (STUCK,) if inside else ()
    hand = replace(hand, contacts=contacts, inside=frozenset(inside))
    return replace(snapshot.with_hands(hand), notices=notices)


def test_what_a_finger_has_to_do_is_said_beside_it_and_nowhere_else(
    stage: Stage, tab: Tab, tmp_path: Path
) -> None:
    snapshot = started(stage, tab)
    tab.wait(f"{SAID} === 'hint'")
    tab.evaluate(WRITTEN)
    tab.touch([(1, 500.0, 400.0), (2, 600.0, 420.0)])
    last = frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 2)[-1]
    ids = [c.id for c in last.contacts]
    stage.server.publish(with_fingers(snapshot, ids, {1}))
    tab.wait(f"written.includes({ENGLISH['move_apart']!r})")
    drawn(tab)
    (tmp_path / "inside.png").write_bytes(tab.picture())
    assert tab.evaluate(SAID) == ""
    stage.server.publish(with_fingers(snapshot, ids, set()))
    tab.wait(f"!written.includes({ENGLISH['move_apart']!r})")
    tab.wait(f"{SAID} === 'hint'")
    # What keeps from playing is said alone.
    stage.server.publish(with_fingers(snapshot, ids, {1}))
    tab.wait(f"written.includes({ENGLISH['move_apart']!r})")
    stage.server.close()
    tab.wait(f"{SAID} === 'curtain'")
    tab.wait(f"!written.includes({ENGLISH['move_apart']!r})")


def test_a_second_hand_is_told_beside_it_that_there_is_one_hand_at_a_time(
    stage: Stage, tab: Tab
) -> None:
    snapshot = started(stage, tab)
    tab.evaluate(WRITTEN)
    tab.touch([(1, 300.0, 400.0), (2, 900.0, 420.0)])
    last = frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 2)[-1]
    ids = [c.id for c in last.contacts]
    hand = snapshot.hands[0]
    states = ("active", "ignored")
    contacts = tuple(
        contact_at(hand.surface, i, hand.tips[k], (0, None)[k], state)
        for k, (i, state) in enumerate(zip(ids, states, strict=True))
    )

    def told() -> bool:
        # A session goes on.
        stage.server.publish(snapshot.with_hands(replace(hand, contacts=contacts)))
        return bool(tab.evaluate(f"written.includes({ENGLISH['one_hand']!r})"))

    assert wait_for(told)
    tab.touch([(1, 300.0, 400.0)])
    stage.server.publish(with_fingers(snapshot, ids[:1], set()))
    tab.wait(f"!written.includes({ENGLISH['one_hand']!r})")


def grip_at(
    stage: Stage,
    tab: Tab,
    snapshot: Snapshot,
    ids: list[int],
    passed: float,
    off: float,
    pushed: float = 0.0,
) -> bool:
    """Draws a solid hand whose labels are in doubt; true if its player is asked to lift it.

    Args:
        stage: The stage.
        tab: The page.
        snapshot: A moment of the session.
        ids: Ids of the page's touches.
        passed: s since the snapshot.
        off: m by which the touches have moved to the right.
        pushed: m by which the box has.
    """
    hand = snapshot.hands[0]
    place = hand.tips[0] + [off, 0.0, 0.0]
    contacts = tuple(contact_at(hand.surface, i, place, None, "active") for i in ids)
    doubtful = replace(hand, contacts=contacts, solid=frozenset({0, 1}))
    box = stage.session.scene.model.joint("box").qposadr[0]
    qpos = snapshot.qpos.copy()
    qpos[box] += pushed
    now = snapshot.time + passed
    stage.server.publish(replace(snapshot.with_hands(doubtful), qpos=qpos, time=now))
    drawn(tab)
    return bool(tab.evaluate("!document.querySelector('.lift-again').hidden"))


def test_a_grip_that_moves_something_is_not_asked_to_lift(stage: Stage, tab: Tab) -> None:
    snapshot = started(stage, tab)
    tab.touch([(1, 400.0, 500.0), (2, 460.0, 520.0)])
    last = frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 2)[-1]
    ids = [c.id for c in last.contacts]
    began = time.monotonic()
    while (passed := time.monotonic() - began) < 3.0:
        moved = 0.01 * passed
        assert not grip_at(stage, tab, snapshot, ids, passed, off=moved, pushed=moved)


def test_words_after_a_failed_grip_stand_right_above_or_below_the_fingers(
    stage: Stage, tab: Tab
) -> None:
    snapshot = started(stage, tab)
    for x, y in ((400.0, 500.0), (1100.0, 60.0)):
        tab.touch([(1, x, y), (2, x + 60.0, y + 20.0)])
        last = frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 2)[-1]
        ids = [c.id for c in last.contacts]

        began = time.monotonic()

        def failed() -> bool:
            passed = time.monotonic() - began  # noqa: B023
            off = min(0.01 * passed, 0.03)
            return grip_at(stage, tab, snapshot, ids, passed, off)  # noqa: B023

        assert wait_for(failed)
        drawn(tab)
        box = "document.querySelector('.lift-again').getBoundingClientRect()"
        left, right, top, bottom = (
            tab.evaluate(f"{box}.{side}") for side in ("left", "right", "top", "bottom")
        )
        assert left >= 0 and right <= SIZE[0] and top >= 0 and bottom <= SIZE[1]
        assert left < x + 60.0 and right > x
        # Clear of the rings, and near.
        ring = 0.42 * 132
        assert y - 3 * ring < bottom < y - ring or y + 20 + ring < top < y + 20 + 3 * ring
        tab.touch([])
        frames(stage, lambda found: bool(found) and not found[-1].contacts)
        stage.server.publish(snapshot)
        tab.wait("document.querySelector('.lift-again').hidden")


@pytest.mark.parametrize("seed", range(6))
def test_the_hint_covers_neither_objects_nor_goals(
    browser: Browser, server: PageServer, seed: int
) -> None:
    stage = staged(server, size_in=(8.9, 6.2), seed=seed)
    tab = browser.open(server.url, width=SIZE[0], height=SIZE[1], storage=KNOWN)
    snapshot = started(stage, tab)
    tab.wait(f"{SAID} === 'hint'")
    drawn(tab)
    box = "document.querySelector('.hint').getBoundingClientRect()"
    left, right, top, bottom = (
        tab.evaluate(f"{box}.{side}") for side in ("left", "right", "top", "bottom")
    )
    surface = stage.session.rigs[0].reconstructor.surface
    corner = (np.array(SIZE) - np.array([8.9, 6.2]) * 132) / 2
    places = [snapshot.objects["box"].position, snapshot.goals[0].position]
    for place in places:
        x, y = corner + surface.to_surface(np.asarray(place)) / 0.0254 * 132
        assert not (left < x < right and top < y < bottom), (place, (left, right, top, bottom))
    tab.close()


def test_a_hand_that_waits_leaves_objects_and_goals_free(
    stage: Stage, tab: Tab, tmp_path: Path
) -> None:
    tab.wait(READY)
    tab.wait("!!document.querySelector('.task').textContent")
    session = stage.session
    snapshot = session.snapshot()
    place = slice(*session.scene.qpos_slice(0).indices(len(snapshot.qpos)))
    pictures = []
    # Over the box, and far away.
    for away in (0.0, 1.0):
        qpos = snapshot.qpos.copy()
        target = session.rigs[0].reconstructor.commanded.copy()
        x, y, _ = snapshot.objects["box"].position
        target[:2] = x + away, y
        target[2] = 0.12
        qpos[place] = session.scene.pose_to_qpos(0, target)
        stage.server.publish(replace(snapshot, qpos=qpos), "start")
        tab.wait("document.querySelector('.preparing').hidden")
        drawn(tab)
        drawn(tab)
        (tmp_path / f"{away}.png").write_bytes(tab.picture())
        png = Image.open(io.BytesIO(tab.picture())).convert("RGB")
        pictures.append(np.asarray(png, int))
    over, clear = pictures
    red = (clear[..., 0] > 150) & (clear[..., 1] < 120) & (clear[..., 2] < 110)
    assert red.sum() > 5000
    changed = np.abs(over - clear).max(axis=-1) > 8
    # The hand is there, and not on the box, except at its border.
    assert changed.sum() > 5000
    assert (changed & red).sum() < 0.03 * red.sum()


def test_moves_are_sent_while_the_page_cannot_draw(browser: Browser, server: PageServer) -> None:
    stage = staged(server)
    tab = browser.open(server.url, width=640, height=480, storage={**KNOWN, KEY: str(PPI)})
    started(stage, tab)
    tab.evaluate("addEventListener('pointerdown', (e) => (window.last = e.pointerId)); true")
    tab.touch([(1, 200.0, 200.0)])
    frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 1)
    # From here on no picture is begun any more.
    tab.evaluate("window.requestAnimationFrame = () => 0; true")
    tab.evaluate("new Promise((done) => setTimeout(done, 100))")
    # Plain http knows the first kind alone.
    for raw, places in (("pointermove", (210, 220)), ("pointerrawupdate", (230, 240))):
        for x in places:
            tab.evaluate(
                f"dispatchEvent(new PointerEvent({raw!r}, {{ pointerId: last, buttons: 1,"
                f" pointerType: 'touch', clientX: {x}, clientY: 200 }}))"
            )
            frames(stage, partial(_at, x))
    tab.touch([])
    tab.close()


def test_a_number_that_a_browser_gives_again_without_an_end_is_another_contact(
    browser: Browser, server: PageServer
) -> None:
    stage = staged(server)
    tab = browser.open(server.url, width=640, height=480, storage={**KNOWN, KEY: str(PPI)})
    started(stage, tab)
    ids = []
    for x in (200, 320):
        tab.evaluate(
            f"document.elementFromPoint({x}, 200).dispatchEvent(new PointerEvent('pointerdown', {{"
            f" pointerId: 77, pointerType: 'touch', bubbles: true, clientX: {x}, clientY: 200 }}))"
        )
        found = frames(stage, partial(_at, x))
        assert len(found[-1].contacts) == 1
        ids.append(found[-1].contacts[0].id)
    assert ids[0] != ids[1]
    assert ids[0] in {i for frame in found for i in frame.cancelled}
    tab.close()


def _at(x: float, found: list[TouchFrame]) -> bool:
    """True if the finger of the newest frame is there, px."""
    return bool(found) and px(found[-1])[0][1] == x


STEADY = """
// A clock on which every chance to draw comes after 10 ms, and every picture is finished by then.
window.chances = 0;
performance.now = () => 10 * chances;
const next = window.requestAnimationFrame.bind(window);
window.requestAnimationFrame = (draw) => next(() => ((chances += 1), draw(10 * chances)));
window.pictures = 0;
const gl = WebGL2RenderingContext.prototype, sync = gl.fenceSync;
gl.drawElements = gl.drawArrays = () => undefined;
gl.clientWaitSync = function () { return this.CONDITION_SATISFIED; };
gl.fenceSync = function (...how) {
  pictures += 1;
  return sync.apply(this, how);
};
"""


def test_pictures_that_come_seldom_and_are_drawn_at_once_leave_the_quality_as_it_is(
    browser: Browser, server: PageServer
) -> None:
    stage = staged(server)
    known = {**KNOWN, KEY: str(PPI), "hand-sandbox:quality": "2"}
    tab = browser.open("about:blank", width=640, height=480, storage=known)
    tab.call("Page.addScriptToEvaluateOnNewDocument", source=STEADY)
    tab.go(server.url)
    started(stage, tab)
    before = tab.evaluate("pictures")
    while tab.evaluate("pictures") < before + 50:
        # 20 a second, by the page's clock.
        tab.wait(f"chances >= {tab.evaluate('chances') + 5}")
        stage.advance()
    assert tab.evaluate("localStorage.getItem('hand-sandbox:quality')") == "2"
    tab.close()
