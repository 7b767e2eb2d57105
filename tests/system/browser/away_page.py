"""`sandbox play` on a page in a real browser whose player goes away and comes back."""

from __future__ import annotations

import contextlib
import json
import time
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from rich.console import Console

from models.frames import TouchFrame
from sandbox.play.page_play import PagePlay
from sandbox.play.pages import open_page
from sandbox.recording.recording import load_recording
from sandbox.server.page_options import PageOptions
from sandbox.server.page_server import PageServer
from sandbox.trial.logs import EventLog
from sandbox.trial.replay import replay
from sandbox.trial.trial_options import TrialOptions
from tests.sandbox.play.played_page import played
from tests.sandbox.server.test_page_server import wait_for
from tests.support.chromium import Browser, Tab
from tests.support.page_memory import NO_HINTS
from tests.system.browser.network import ADDRESS, Network

WIDTH, HEIGHT, PPI = 800, 600, 80.0
KNOWN = {
    f"hand-sandbox:px-per-inch:{HEIGHT}x{WIDTH}@1": str(PPI),
    "hand-sandbox:quality": "3",
}
READY = "!!document.querySelector('.dot[data-condition=open]')"
DRAWN = READY + " && document.querySelector('.reason').textContent !== ''"
REST = [(1, 300.0, 470.0), (2, 360.0, 470.0)]
"""Two fingers beside the box, as id and CSS pixels."""


class PlayedPage:
    """A page on which somebody plays.

    Attributes:
        server: Server of the page.
        network: Network between the page and the server.
        tab: The player's page.
    """

    def __init__(
        self, server: PageServer, network: Network, browser: Browser, url: str, hint: bool
    ) -> None:
        self.server, self.network, self.url = server, network, url
        self._browser = browser
        self._storage = KNOWN if hint else {**KNOWN, **NO_HINTS}
        self.tab = self.open()
        self.tab.wait(READY)

    def open(self, more: str = "", **size: int) -> Tab:
        """Another page, in a browser of its own."""
        size = {"width": WIDTH, "height": HEIGHT, **size}
        return self._browser.open(self.url + more, storage=self._storage, **size)

    @property
    def time(self) -> float:
        """s, simulated time of the newest snapshot."""
        moment = self.server._moment
        return moment[2].time if moment else 0.0

    @property
    def pause(self) -> str:
        """Why simulated time stands still."""
        moment = self.server._moment
        return moment[3] if moment else ""

    @property
    def scene(self) -> int:
        """Number of the trial."""
        return self.server.next_scene() - 1

    def begin(self) -> None:
        """Two fingers begin the trial, and rest."""
        self.tab.wait(DRAWN)
        self.tab.touch(REST)
        assert wait_for(lambda: self.time > 0.5)

    def stops(self) -> float:
        """Waits until the step that is being made is finished; simulated time then, s."""
        before = -1.0
        while self.time != before:
            before = self.time
            time.sleep(0.1)
        return before

    def touch_again(self) -> None:
        """Lifts all fingers, and touches."""
        self.tab.touch([])
        self.tab.touch(REST)

    def comes_back(self, since: float) -> float:
        """Waits until the page can be played again; s since a time of the monotonic clock."""
        assert wait_for(lambda: self.pause != "away")
        self.tab.wait(DRAWN)
        return time.monotonic() - since


Absence = Generator[None]
"""Leaves the page, yields while it is away, and returns to it."""


def reload(page: PlayedPage) -> Absence:
    """The person reloads the page."""
    page.tab.touch([])
    page.tab.evaluate("location.reload()")
    yield


def go_back(page: PlayedPage) -> Absence:
    """The person goes to another page, and back with the browser's button."""
    page.tab.touch([])
    page.tab.go("about:blank")
    yield
    page.tab.evaluate("history.back()")


def throw_away(page: PlayedPage) -> Absence:
    """The system ends the tab's process to save memory, and loads the tab anew when it is seen."""
    page.tab.touch([])
    page.tab.crash()
    yield
    page.tab.call("Page.reload")


def hide(page: PlayedPage) -> Absence:
    """The person looks at another tab."""
    page.tab.touch([])
    other = page.tab.beside()
    yield
    page.tab.show()
    other()


def lose_network(page: PlayedPage) -> Absence:
    """The network is gone, and the fingers rest on the glass."""
    page.network.leave()
    yield
    page.network.come_back()


def turn(page: PlayedPage) -> Absence:
    """The person turns the screen."""
    page.tab.touch([])
    page.tab.resize(HEIGHT, WIDTH)
    yield
    page.tab.resize(WIDTH, HEIGHT)


@dataclass(frozen=True)
class Away:
    """What happened in one absence.

    Attributes:
        ran_on_s: Simulated time that passed from the leaving until time stood still.
        stood_still: True if simulated time stood still from then until the return.
        back_s: Real time from the return until the page could be played.
        same_trial: True if the page showed the trial that it had left.
        by_itself: True if time went on without another touch.
    """

    ran_on_s: float
    stood_still: bool
    back_s: float
    same_trial: bool
    by_itself: bool


def absence(page: PlayedPage, kind: Callable[[PlayedPage], Absence], seconds: float) -> Away:
    """Plays an absence, and what comes after it until time goes on."""
    scene, left, going = page.scene, page.time, kind(page)
    since = time.monotonic()
    next(going)
    assert wait_for(lambda: page.pause in ("away", "back"))
    # A step that was being made when time was stopped is still finished.
    stood = page.stops()
    time.sleep(seconds)
    still = page.time == stood
    since = time.monotonic() if seconds else since
    next(going, None)
    back = page.comes_back(since)
    by_itself = kind is lose_network
    if not by_itself:
        # No finger rests: time waits for the next touch.
        # On a busy machine the page may be silent for a moment, and away once more.
        assert wait_for(lambda: page.pause == "back")
        still = still and page.time == stood
        page.touch_again()
    assert wait_for(lambda: page.time > stood + 0.2 and not page.pause)
    return Away(stood - left, still, back, page.scene == scene, by_itself)


@contextlib.contextmanager
def playing(
    browser: Browser, folder: Path, task: str = "box-to-goal", hint: bool = False
) -> Iterator[PlayedPage]:
    """Plays a task on a page behind a network; afterwards `results` reads what was recorded.

    With `hint`, the page shows its hint for new players.
    """
    server = open_page(PageOptions())
    server.access = replace(server.access, names=(ADDRESS,))
    network = Network(server.access.port)
    options = TrialOptions(task=task, device="web", record=folder / "trial.jsonl")
    events = EventLog(folder / "events.jsonl")
    play = PagePlay(options, (server,), events, Console(quiet=True))
    url = server.url.replace("127.0.0.1", ADDRESS)
    with played(play, server):
        page = PlayedPage(server, network, browser, url, hint)
        try:
            yield page
        finally:
            page.tab.close()
    server.close()
    network.close()
    events.close()


def results(folder: Path) -> list[dict[str, Any]]:
    """Results of all trials, oldest first."""
    lines = (folder / "events.jsonl").read_text().splitlines()
    told = [json.loads(line) for line in lines]
    return [line for line in told if line["event"] == "trial_end"]


def contacts(folder: Path) -> set[int]:
    """Ids of all contacts in the first trial's recording."""
    recording = load_recording(folder / "trial.jsonl")
    frames = (given.frame for given in recording.inputs[0])
    return {c.id for frame in frames if isinstance(frame, TouchFrame) for c in frame.contacts}


def replays(folder: Path) -> bool:
    """True if the first trial's recording replays to the same hash."""
    _, verification = replay(load_recording(folder / "trial.jsonl"))
    return verification.exact
