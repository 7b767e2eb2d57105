"""Two hands on one page: a tray is carried by fingers of both, split before they are labelled."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from models.surface import METRES_PER_INCH
from sandbox.play.pages import show_session, touched_pages
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import PageScreen
from sandbox.server.screen import rectangle
from sandbox.session.messages import Snapshot
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.sandbox.server.test_page_server import wait_for
from tests.support.chromium import BINARY, Browser
from tests.support.page_client import Page
from tests.support.page_memory import NO_HINTS
from tests.support.processes import PATIENCE

TASK, SEED, PPI = "carry-together", 3, 64.0
WIDTH, HEIGHT = 1500, 460
"""px of the page; its lift control lies beside the rectangle."""
SCREEN = PageScreen(PPI, WIDTH, HEIGHT, True)
SIZE = rectangle(SCREEN, 2)["size_in"]
KNOWN = {
    f"hand-sandbox:px-per-inch:{HEIGHT}x{WIDTH}@1": str(PPI),
    "hand-sandbox:quality": "3",
    **NO_HINTS,
}

Touch = Callable[[list[tuple[int, float, float]], float], None]
"""Puts fingers on the page, as id and inches, all that are down now; and the lift control."""


@pytest.fixture
def server() -> Iterator[PageServer]:
    server = PageServer()
    yield server
    server.close()


def carried(
    server: PageServer,
    come: Callable[[], Touch],
    drawn: Callable[[], object] = lambda: None,
    seen: Callable[[], object] = lambda: None,
) -> Any:
    """The score of two simulated users whose fingers are on the page.

    Args:
        server: Of the page.
        come: Opens the page.
        drawn: Returns once the page has drawn a first picture.
        seen: Is called as long as the tray is in its place.
    """
    chosen = trial_settings(TrialOptions(task=TASK, seed=SEED, device="web", one_surface=True))
    settings = chosen.changed(**rectangle(SCREEN, 2))
    session = build(settings, device_makers(chosen))
    ((whose, device),) = touched_pages(session)
    assert whose is None
    show_session(server, session, "right", "", device)
    touch = come()
    assert server.wait_for_player(PATIENCE)
    server.publish(session.advance())
    drawn()
    users = _users(session.task, session.whole_surface)
    down: list[tuple[int, float, float]] = []
    lift: float | None = None
    while not session.over:
        snapshot = session.advance()
        users.show(_as_the_users_know_it(snapshot, down, session.whole_surface))
        server.publish(snapshot)
        frame = users.poll(snapshot.time)[-1]
        wanted = [(c.id, c.x / METRES_PER_INCH, c.y / METRES_PER_INCH) for c in frame.contacts]
        other = {i for i, _, _ in wanted} != {i for i, _, _ in down}
        moved = wanted != down or frame.lift != lift
        if other or (moved and session.step % (3 * session.scene.substeps) == 0):
            touch(wanted, frame.lift or 0.0)
            # What only the lift control does may be too little for a pixel of it.
            assert (
                wait_for(device.frame_ready.is_set, PATIENCE if wanted != down else 0.2)
                or wanted == down
            )
            down, lift = wanted, frame.lift
        if session.scorer.score.final:
            seen()
    return session.scorer.score


def _users(task: Any, surface: Any) -> Any:
    """Both users, as one device that touches the whole surface."""
    options = TrialOptions(task=TASK, seed=SEED, one_surface=True, surface=f"{SIZE[0]}x{SIZE[1]}in")
    first: Any = device_makers(trial_settings(options))[0](task, surface)
    return first.device


def _as_the_users_know_it(
    snapshot: Snapshot, down: list[tuple[int, float, float]], surface: Any
) -> Snapshot:
    """The same with the users' own ids on their touches: a browser gives others."""
    if not down:
        return snapshot
    places = surface.to_world(np.array([[x, y] for _, x, y in down]) * METRES_PER_INCH)
    hands = tuple(
        replace(
            hand,
            contacts=tuple(
                replace(c, id=down[int(np.argmin(np.linalg.norm(places - place, axis=1)))][0])
                for c, place in zip(hand.contacts, hand.places, strict=True)
            ),
        )
        for hand in snapshot.hands
    )
    return snapshot.with_hands(*hands)


class SocketHands:
    """Fingers by the page's protocol alone."""

    def __init__(self, url: str) -> None:
        screen = {"px_per_in": PPI, "width_px": WIDTH, "height_px": HEIGHT, "calibrated": True}
        self.page = Page(url, screen=screen)

    def __call__(self, fingers: list[tuple[int, float, float]], lift: float) -> None:
        self.page.touch(*fingers, lift=lift)


def test_two_hands_on_one_page_carry_a_tray_together(server: PageServer) -> None:
    score = carried(server, lambda: SocketHands(server.url))
    assert score.success, score


class BrowserHands:
    """Fingers on a real page, and one more on its lift control."""

    def __init__(self, browser: Browser, url: str) -> None:
        self.tab = browser.open(url, width=WIDTH, height=HEIGHT, storage=KNOWN)
        self.tab.wait("!!document.querySelector('.dot[data-condition=open]')")
        self.tab.wait("!document.querySelector('.lift').hidden")
        box = "document.querySelector('.lift').getBoundingClientRect()"
        self._x, self._top, self._height = (
            float(self.tab.evaluate(f"{box}.{what}")) for what in ("left", "top", "height")
        )
        self._x += 20.0

    def __call__(self, fingers: list[tuple[int, float, float]], lift: float) -> None:
        left, top = (WIDTH - SIZE[0] * PPI) / 2, (HEIGHT - SIZE[1] * PPI) / 2
        edge = 0.08 * self._height
        y = self._top + edge + (1.0 - lift) * (self._height - 2 * edge)
        on_glass = [(i, left + x_in * PPI, top + y_in * PPI) for i, x_in, y_in in fingers]
        self.tab.touch([(1000, self._x, y), *on_glass])


@pytest.mark.full
@pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")
def test_two_hands_on_a_page_in_a_browser_carry_a_tray_together(
    server: PageServer, tmp_path: Path
) -> None:
    browser = Browser(tmp_path)
    hands: list[BrowserHands] = []
    pictures: list[bytes] = []

    def come() -> BrowserHands:
        hands.append(BrowserHands(browser, server.url))
        return hands[0]

    def drawn() -> None:
        hands[0].tab.wait("document.querySelector('.reason').textContent.length > 3", PATIENCE)

    def seen() -> None:
        if not pictures:
            pictures.append(hands[0].tab.picture())

    try:
        score = carried(server, come, drawn, seen)
        assert score.success, score
        (tmp_path / "carried.png").write_bytes(pictures[0])
        assert not hands[0].tab.events("Runtime.exceptionThrown")
    finally:
        browser.close()
