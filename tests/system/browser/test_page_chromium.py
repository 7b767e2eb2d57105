"""The page in a real browser: what its fingers do, what it forgets and what it never asks for."""

from __future__ import annotations

import asyncio
import os
import socket
import time
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from models.frames import Contact
from models.surface import METRES_PER_INCH
from sandbox.server import clients
from sandbox.server.clients import SILENT_TOUCHED
from sandbox.server.page_frames import describe_scene
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import LIFT_STRIP_PX
from sandbox.server.screen import rectangle
from sandbox.words import words_in
from tests.sandbox.server.staged_page import (
    BESIDE_LIFT,
    HEIGHT,
    KNOWN,
    PPI,
    READY,
    TASKS,
    WATCHED,
    WIDTH,
    frames,
    nobody_else_was_asked,
    play_through,
    px,
    staged,
)
from tests.sandbox.server.test_page_server import Stage, wait_for
from tests.support.chromium import BINARY, Browser, Tab
from tests.support.processes import PATIENCE
from tests.support.scripted import scripted
from tests.support.viewed import contact_at, with_load

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

ENGLISH = words_in("en")


@pytest.fixture(autouse=True)
def slow_page(monkeypatch: pytest.MonkeyPatch) -> None:
    """A page on a busy machine may say nothing for longer than a second, fingers down."""
    monkeypatch.setattr(clients, "SILENT_TOUCHED", PATIENCE)


@pytest.fixture
def stage(server: PageServer) -> Stage:
    return staged(server)


@pytest.fixture
def tab(browser: Browser, server: PageServer) -> Iterator[Tab]:
    tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
    yield tab
    tab.close()


@pytest.mark.parametrize(
    "fingers", [3, pytest.param(2, marks=pytest.mark.full), pytest.param(5, marks=pytest.mark.full)]
)
def test_fingers_on_the_page_bring_the_box_to_its_goal(
    server: PageServer, tab: Tab, tmp_path: Path, fingers: int
) -> None:
    # Buttons are as large as on a tablet, the rest is half as large: they lie beside the rectangle.
    stage = staged(server, size_in=(9.0, 6.0))
    corner = (WIDTH - 9.0 * PPI) / 2, (HEIGHT - 6.0 * PPI) / 2
    tab.wait(READY)
    assert wait_for(lambda: stage.server.wait_for_player(0.0))
    stage.advance()
    tab.wait("document.querySelector('.reason').textContent.includes('mm from the goal')")
    assert play_through(stage, tab, corner, fingers) == fingers
    assert stage.session.scorer.score.success, stage.session.scorer.score
    tab.wait("document.querySelector('.end-words').textContent.startsWith('Done in')")
    (tmp_path / "success.png").write_bytes(tab.picture())
    assert (tmp_path / "success.png").stat().st_size > 10_000
    assert "drawn" in stage.server.latency.percentiles()
    assert nobody_else_was_asked(tab, stage.server)
    assert not tab.events("Runtime.exceptionThrown")


WRITTEN = """
window.written = {};
const fill = CanvasRenderingContext2D.prototype.fillText;
const dash = CanvasRenderingContext2D.prototype.setLineDash;
let dashes = 0;
CanvasRenderingContext2D.prototype.setLineDash = function (parts) {
  dashes += parts.length > 0 ? 1 : 0;
  return dash.call(this, parts);
};
CanvasRenderingContext2D.prototype.fillText = function (text, ...rest) {
  written[text] = dashes;
  dashes = 0;
  return fill.call(this, text, ...rest);
};
true
"""
"""Writes down names beside fingers, each with the number of dashed rings since the name before."""


def test_a_finger_that_is_not_sure_has_a_dashed_ring_and_a_question_mark(
    stage: Stage, tab: Tab, tmp_path: Path
) -> None:
    tab.wait(READY)
    stage.advance()
    tab.wait("document.querySelector('.task').textContent !== ''")
    tab.evaluate(WRITTEN)
    tab.touch([(1, 200.0, 300.0)])
    frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 1)
    snapshot = stage.session.advance()
    for probability, name in ((0.5, "index?"), (0.95, "index")):
        hand = snapshot.hands[0]
        contact = contact_at(hand.surface, 1, hand.tips[1], 1, "active", probability)
        hand = replace(hand, contacts=(contact,))
        stage.server.publish(snapshot.with_hands(hand))
        tab.wait(f"window.written[{name!r}] !== undefined")
        assert tab.evaluate(f"window.written[{name!r}] > 0") == name.endswith("?")
        (tmp_path / f"{probability}.png").write_bytes(tab.picture())


def test_a_finger_says_what_its_grip_has_stored_and_when_there_is_no_more_force(
    stage: Stage, tab: Tab, tmp_path: Path
) -> None:
    tab.wait(READY)
    stage.advance()
    tab.wait("document.querySelector('.task').textContent !== ''")
    tab.evaluate(WRITTEN)
    tab.touch([(1, 200.0, 300.0)])
    (finger,) = frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 1)[
        -1
    ].contacts
    snapshot = stage.session.advance()
    hand = snapshot.hands[0]
    contact = contact_at(hand.surface, finger.id, hand.tips[1], 1, "active")
    snapshot = snapshot.with_hands(replace(hand, contacts=(contact,)))
    for force, stored, used, words in (
        (2.0, 0.0, 0.0, "index"),
        (14.0, 12.6, 0.0, "index 13 N"),
        (30.0, 0.0, 1.0, "index: full force"),
    ):
        load = [(0.0, of_index, 0.0, 0.0, 0.0) for of_index in (force, stored, used)]
        stage.server.publish(with_load(snapshot, *load))
        tab.wait(f"window.written[{words!r}] !== undefined")
        (tmp_path / f"{words.partition(' ')[2] or 'none'}.png").write_bytes(tab.picture())
    tab.touch([])


def test_a_palm_is_a_patch_with_its_word_and_gets_no_name(
    stage: Stage, tab: Tab, tmp_path: Path
) -> None:
    tab.wait(READY)
    stage.advance()
    tab.wait("document.querySelector('.task').textContent !== ''")
    tab.evaluate(WRITTEN)
    fingers = [(1, 150.0, 250.0), (2, 185.0, 210.0)]
    wide, high = 45.0 / 25.4 * PPI, 60.0 / 25.4 * PPI
    tab.touch([*fingers, (3, 230.0, 330.0)], {3: (wide / 2, high / 2)})
    down = frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 3)[-1]
    *tips, palm = sorted(down.contacts, key=lambda c: c.id)
    assert palm.extent == pytest.approx((0.045, 0.060), rel=0.02)
    assert all(tip.extent == pytest.approx((16 / PPI * METRES_PER_INCH,) * 2) for tip in tips)
    session = scripted(lambda now: down.contacts)
    while session.time < 0.5:
        snapshot = session.advance()
    states = {c.id: c.state for c in snapshot.hands[0].contacts}
    assert states == {tips[0].id: "active", tips[1].id: "active", palm.id: "palm"}
    stage.server.publish(snapshot)
    tab.wait("window.written['palm'] !== undefined")
    (tmp_path / "palm.png").write_bytes(tab.picture())
    tab.touch([])


def test_a_moving_finger_is_sent_before_the_picture_that_has_its_ring(
    stage: Stage, tab: Tab
) -> None:
    tab.wait(READY)
    stage.advance()
    tab.wait("document.querySelector('.task').textContent !== ''")
    tab.evaluate(WATCHED)
    tab.touch([(1, 200.0, 200.0)])
    places = [210.25, 220.5, 230.75]
    for x in places:
        tab.touch([(1, x, 200.0)])
        tab.wait(f"told.some(([what, at]) => what === 'ring' && at === {x})")
    told = tab.evaluate("told")
    for x in places:
        message = next(i for i, t in enumerate(told) if t[:2] == ["message", x])
        ring = next(i for i, t in enumerate(told) if t[:2] == ["ring", x])
        assert message < ring
        # In the same picture, or at once, before the picture has begun.
        assert told[message][2] <= told[ring][2]
    tab.touch([])


def test_ten_fingers_keep_their_ids_and_each_is_lifted_alone(stage: Stage, tab: Tab) -> None:
    tab.wait(READY)
    stage.advance()
    places = [(i, 30.0 + 30 * i, 190.0 + 13 * i) for i in range(10)]
    tab.touch(places)
    down = frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 10)[-1]
    tab.touch([(i, x + 4, y + 2) for i, x, y in places])
    moved = frames(stage, lambda found: bool(found) and px(found[-1])[0][1] == 34.0)[-1]
    assert [c.id for c in moved.contacts] == [c.id for c in down.contacts]
    assert [p[1:] for p in px(moved)] == [(x + 4, y + 2) for _, x, y in places]
    gone = moved.contacts[3].id
    tab.touch([(i, x + 4, y + 2) for i, x, y in places if i != 3])
    one_less = frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 9)[-1]
    assert {c.id for c in moved.contacts} - {c.id for c in one_less.contacts} == {gone}
    assert not one_less.cancelled


def test_what_the_system_takes_away_is_not_lifted(stage: Stage, tab: Tab) -> None:
    tab.wait(READY)
    for take_away in (tab.cancel, lambda: tab.evaluate("dispatchEvent(new Event('blur'))")):
        tab.touch([(1, 100.0, 290.0), (2, 150.0, 290.0)])
        down = frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 2)[-1]
        take_away()
        last = frames(stage, lambda found: bool(found) and not found[-1].contacts)
        cancelled = frozenset().union(*(frame.cancelled for frame in last))
        assert cancelled == {c.id for c in down.contacts}
        tab.touch([])
    tab.touch([(1, 100.0, 290.0)])
    frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 1)
    tab.touch([])
    lifted = frames(stage, lambda found: bool(found) and not found[-1].contacts)
    assert not any(frame.cancelled for frame in lifted)


def test_a_lift_that_the_browser_loses_is_known_by_the_end_of_its_capture(
    stage: Stage, tab: Tab
) -> None:
    tab.wait(READY)
    tab.evaluate(
        "window.ends = []; for (const what of ['pointerup', 'lostpointercapture'])"
        " addEventListener(what, (e) => {"
        " ends.push(what); if (what === 'pointerup') e.stopImmediatePropagation(); }, true); true"
    )
    tab.touch([(1, 100.0, 290.0), (2, 150.0, 290.0)])
    down = frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 2)[-1]
    tab.touch([(1, 100.0, 290.0)])
    last = frames(stage, lambda found: len(found[-1:] and found[-1].contacts) == 1)
    assert tab.evaluate("ends.join()") == "pointerup,lostpointercapture"
    assert last[-1].contacts[0].id == down.contacts[0].id
    assert not any(frame.cancelled for frame in last)
    # Where the touched element is removed, the finger still rests on the glass.
    tab.evaluate(
        "addEventListener('pointermove', (e) => document.dispatchEvent(new PointerEvent("
        "'lostpointercapture', { pointerId: e.pointerId, bubbles: true })), { once: true }); true"
    )
    for x in (110.0, 120.0, 130.0):
        tab.touch([(1, x, 290.0)])
        moved = frames(stage, lambda found, x=x: bool(found) and px(found[-1])[0][1] == x)  # type: ignore[misc]
        assert moved[-1].contacts[0].id == down.contacts[0].id
    tab.touch([])
    assert frames(stage, lambda found: bool(found) and not found[-1].contacts)


POINTERS = """
window.pointer = (kind, id, x) => {
  const at = { pointerId: id, pointerType: 'touch', clientX: x, clientY: 290, bubbles: true };
  document.elementFromPoint(150, 290).dispatchEvent(new PointerEvent(`pointer${kind}`, at));
};
window.gone = false;
const state = Object.getOwnPropertyDescriptor(WebSocket.prototype, 'readyState').get;
Object.defineProperty(WebSocket.prototype, 'readyState', {
  get() { return gone ? WebSocket.CLOSED : state.call(this); },
});
true
"""
"""Pointer events of a script, and a network through which nothing is said while it is `gone`."""


def test_a_cancelled_finger_is_none_that_was_lifted_whatever_was_cancelled_unseen_before(
    stage: Stage, tab: Tab
) -> None:
    tab.wait(READY)
    tab.evaluate(POINTERS)
    tab.evaluate("pointer('down', 900, 100); true")
    (contact,) = frames(stage, lambda found: bool(found and found[-1].contacts))[-1].contacts
    tab.evaluate(
        "gone = true; for (let i = 0; i < 30; i++) "
        "{ pointer('down', 1000 + i, 150); pointer('cancel', 1000 + i, 150); } "
        "pointer('cancel', 900, 100); gone = false; pointer('down', 901, 200); true"
    )
    last = frames(
        stage, lambda found: bool(found) and [c.id for c in found[-1].contacts] != [contact.id]
    )[-1]
    assert last.cancelled == {contact.id} and len(last.contacts) == 1
    tab.evaluate("pointer('up', 901, 200); true")


def test_fingers_that_rest_are_not_taken_for_gone(
    stage: Stage, tab: Tab, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clients, "SILENT_TOUCHED", SILENT_TOUCHED)

    def rests() -> bool:
        silences = stage.server.counters["silent page"]
        tab.touch([])
        tab.touch([(1, 100.0, 290.0)])
        assert wait_for(lambda: stage.device.touched)
        time.sleep(1.5 * SILENT_TOUCHED)
        return stage.device.touched and stage.server.counters["silent page"] == silences

    tab.wait(READY)
    # A browser that gets no processor for a second is silent indeed; not each time.
    assert wait_for(rests)


def test_a_mouse_is_one_finger_and_the_rectangle_lies_in_the_middle(
    browser: Browser, server: PageServer
) -> None:
    stage = staged(server, size_in=(5.6, 4.2))
    tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
    tab.wait(READY)
    tab.wait("!!document.querySelector('.task').textContent")
    corner = (WIDTH - 5.6 * PPI) / 2, (HEIGHT - 4.2 * PPI) / 2
    for kind, x in (("mousePressed", 220), ("mouseMoved", 250), ("mouseReleased", 250)):
        tab.call(
            "Input.dispatchMouseEvent",
            type=kind,
            x=x,
            y=240,
            button="left",
            buttons=1,
            clickCount=1,
        )
    found = frames(stage, lambda found: bool(found) and not found[-1].contacts)
    places = [px(frame) for frame in found if frame.contacts]
    assert {len(place) for place in places} == {1}
    assert places[0][0][1:] == pytest.approx((220 - corner[0], 240 - corner[1]), abs=0.02)
    assert places[-1][0][1:] == pytest.approx((250 - corner[0], 240 - corner[1]), abs=0.02)
    tab.close()


def test_a_page_finds_back_when_the_server_restarts(browser: Browser, server: PageServer) -> None:
    staged(server)
    tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
    tab.wait(READY)
    server.close()
    tab.wait("document.querySelector('.dot').dataset.condition !== 'open'")
    again = PageServer(port=server.access.port, tasks=TASKS, token=server.access.token)
    try:
        stage = staged(again)
        tab.wait(READY)
        assert again.wait_for_player(PATIENCE)
        tab.touch([(1, 100.0, 290.0)])
        assert wait_for(lambda: stage.device.touched)
    finally:
        again.close()
        tab.close()


def test_a_page_does_not_wait_for_a_computer_that_never_answers(
    browser: Browser, monkeypatch: pytest.MonkeyPatch
) -> None:
    server = PageServer(tasks=TASKS)
    # It goes without a goodbye, as a computer that loses its power does.
    monkeypatch.setattr(server, "_part", partial(asyncio.sleep, 0.0))
    staged(server)
    tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
    tab.wait(READY)
    server.close()
    with socket.create_server((server.access.host, server.access.port)):
        # Connections are made here, and nobody ever says a word.
        for condition in ("connecting", "lost", "connecting", "lost"):
            assert tab.wait(f"!!document.querySelector('.dot[data-condition={condition}]')")
    tab.close()


def test_a_page_with_a_wrong_token_gets_nothing(browser: Browser, server: PageServer) -> None:
    staged(server)
    tab = browser.open(server.url + "x", width=WIDTH, height=HEIGHT, storage=KNOWN)
    tab.wait(f"document.body && document.body.innerText.includes({ENGLISH['link_invalid']!r})")
    assert tab.evaluate("document.scripts.length + document.querySelectorAll('canvas').length") == 0
    # Nor does a script that knows the address but not the token.
    tried = (
        "new Promise(r => { const s = new WebSocket(location.origin.replace('http', 'ws') + "
        "'/?token=guess'); s.onclose = e => r('closed'); s.onmessage = () => r('told') })"
    )
    assert tab.evaluate(tried) == "closed"
    assert server.counters["wrong token"] >= 2
    assert server.clients == 0
    tab.close()


def test_the_token_is_not_left_in_the_address(stage: Stage, tab: Tab) -> None:
    tab.wait(READY)
    assert tab.evaluate("location.search") == ""
    assert stage.server.access.token not in tab.evaluate("location.href")


def test_a_card_held_to_the_screen_gives_its_inches(browser: Browser, server: PageServer) -> None:
    staged(server)
    tab = browser.open(server.url, width=900, height=700, storage={"hand-sandbox:quality": "3"})
    tab.wait(READY)
    tab.tap("Settings")
    tab.tap("Measure this screen")
    tab.wait("!!document.querySelector('.card')")
    assert wait_for(lambda: server.screen is not None)
    assert not server.screen.calibrated
    tab.evaluate(
        "(() => { const s = document.querySelector('.slider'); s.value = 101.5;"
        "s.dispatchEvent(new Event('input')); })()"
    )
    card = tab.evaluate(
        "(() => { const b = document.querySelector('.card').getBoundingClientRect();"
        "return [b.width, b.height] })()"
    )
    # A card is 85.60 by 53.98 mm: on this screen, so many pixels.
    np.testing.assert_allclose(card, np.array([85.60, 53.98]) / 25.4 * 101.5, atol=0.1)
    tab.tap("It fits")
    assert wait_for(lambda: server.screen is not None and server.screen.calibrated)
    assert server.screen.px_per_in == 101.5
    inches = rectangle(server.screen)["size_in"]
    np.testing.assert_allclose(inches, [900 / 101.5, 700 / 101.5], atol=1e-3)
    asked: list[str] = []

    def tried_again() -> bool:
        asked.extend(ask.what for ask in server.take_requests())
        return "retry" in asked

    assert wait_for(tried_again)
    assert asked.count("retry") == 1
    tab.close()


def test_the_lift_control_lifts_and_is_no_finger(browser: Browser, server: PageServer) -> None:
    stage = staged(server, task="stack", **BESIDE_LIFT)
    tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
    tab.wait(READY)
    tab.wait("!document.querySelector('.lift-strip').hidden")
    left, top, width, height = tab.evaluate(
        "(() => { const b = document.querySelector('.lift').getBoundingClientRect();"
        "return [b.left, b.top, b.width, b.height] })()"
    )
    x = left + width / 2
    tab.touch([(1, 200.0, 300.0)])
    tab.touch([(1, 200.0, 300.0), (2, x, top + 0.9 * height)])
    tab.touch([(1, 200.0, 300.0), (2, x, top + 0.2 * height)])
    high = frames(stage, lambda found: bool(found) and (found[-1].lift or 0.0) > 0.7)
    assert max(len(frame.contacts) for frame in high) == 1
    tab.touch([(1, 200.0, 300.0)])
    tab.touch([(1, 210.0, 300.0)])
    corner = LIFT_STRIP_PX
    after = frames(stage, lambda found: bool(found) and px(found[-1], corner)[0][1] > 205)[-1]
    assert after.lift == high[-1].lift
    tab.close()


def test_a_lift_control_and_a_finger_that_move_together_are_one_message(
    browser: Browser, server: PageServer
) -> None:
    staged(server, task="stack", **BESIDE_LIFT)
    tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
    tab.wait(READY)
    tab.wait("!document.querySelector('.lift-strip').hidden")
    box = "document.querySelector('.lift').getBoundingClientRect()"
    x, top, height = (tab.evaluate(f"{box}.{edge}") for edge in ("left", "top", "height"))
    tab.evaluate(WATCHED)
    tab.evaluate("window.down = []; true")
    tab.evaluate("window.addEventListener('pointerdown', e => down.push(e.pointerId)); true")
    tab.touch([(1, 200.0, 300.0), (2, x + 20.0, top + 0.9 * height)])
    tab.wait("down.length === 2")
    places = [210.25, 220.5, 230.75]
    for k, at in enumerate(places):
        # A browser may split the moves of one touch frame into two tasks: here they are one.
        finger = [at + LIFT_STRIP_PX, 300.0]
        thumb = [x + 20.0, top + (0.8 - 0.1 * k) * height]
        tab.evaluate(
            f"{[finger, thumb]}.forEach(([clientX, clientY], i) => window.dispatchEvent("
            "new PointerEvent('pointermove',"
            " {pointerId: down[i], pointerType: 'touch', clientX, clientY}))); true"
        )
        tab.wait(f"told.some(([what, at]) => what === 'message' && at === {at})")
    told = tab.evaluate("told.filter(([what]) => what === 'message')")
    moved = [t for t in told if t[1] in places]
    # A page that rests repeats itself. No message has one's new place and the other's old one.
    assert len({(at, lift) for _, at, _, lift in moved}) == len(places)
    assert len({lift for _, _, _, lift in moved}) == len(places)
    tab.close()


def test_a_spectator_only_looks(browser: Browser, server: PageServer) -> None:
    stage = staged(server)
    tab = browser.open(server.url + "&role=spectator", width=WIDTH, height=HEIGHT, storage=KNOWN)
    tab.wait(READY)
    stage.advance()
    tab.wait("document.querySelector('.reason').textContent.includes('mm')")
    tab.touch([(1, 100.0, 290.0)])
    time.sleep(0.3)
    assert not stage.device.touched
    assert server.counters["not the player"] == 0
    assert tab.evaluate("document.querySelector('.buttons').hidden")
    assert server.screen is None
    tab.close()


def test_what_the_buttons_ask_for_is_heard(stage: Stage, tab: Tab) -> None:
    tab.wait(READY)
    tab.wait("!!document.querySelector('.task').textContent")
    tab.tap("Again")
    tab.tap("Settings")
    tab.tap("Right hand")
    tab.tap("Tasks")
    tab.tap("Box to goal")
    found: list[tuple[str, str]] = []

    def heard() -> bool:
        found.extend((ask.what, ask.value) for ask in stage.server.take_requests())
        return ("task", "box-to-goal") in found

    assert wait_for(heard)
    assert found == [
        ("retry", ""),
        ("pause", ""),
        ("resume", ""),
        ("hand", "left"),
        ("pause", ""),
        ("resume", ""),
        ("task", "box-to-goal"),
    ]


@pytest.mark.parametrize("task", ["box-to-goal", "stack-vertical"])
def test_a_place_on_the_surface_is_drawn_on_the_pixel_that_touches_it(
    browser: Browser, server: PageServer, task: str
) -> None:
    x_in, y_in = 2.5, 4.5
    session = scripted(
        lambda now: [Contact(1, x_in * METRES_PER_INCH, y_in * METRES_PER_INCH)],
        task=task,
        size_in=(WIDTH / PPI, HEIGHT / PPI),
    )
    surface = session.rigs[0].reconstructor.surface
    # Fingers that are not on this screen are drawn where the program has them in the world.
    message = describe_scene(1, session.scene, session.task, surface, "right", "somebody else")
    server.show_scene(message, session.scene)
    tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
    tab.wait(READY)
    tab.wait("!!document.querySelector('.task').textContent")
    server.publish(session.advance())
    left, right, bottom = tab.wait(
        "(() => { const c = document.querySelector('.rings'), w = c.width;"
        "const d = c.getContext('2d').getImageData(0, 0, w, c.height).data;"
        "let l = w, r = -1, b = -1; for (let i = 3; i < d.length; i += 4) if (d[i] > 40) {"
        "const n = (i - 3) / 4; l = Math.min(l, n % w); r = Math.max(r, n % w);"
        "b = Math.max(b, Math.floor(n / w)); } return r > 0 && [l, r, b]; })()"
    )
    radius = (right - left) / 2
    assert (left + right) / 2 == pytest.approx(x_in * PPI, abs=1.0)
    assert bottom - radius == pytest.approx(y_in * PPI, abs=1.5)
    tab.close()
