"""The page in a real browser: what its fingers do, what it forgets and what it never asks for."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urlsplit

import numpy as np
import pytest

from models.frames import TouchFrame
from models.surface import METRES_PER_INCH
from sandbox.assembly import build
from sandbox.cli.play_page import rectangle
from sandbox.devices.simulated import SimulatedDevice
from sandbox.devices.web import WebDevice
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import TaskName
from sandbox.server.senses import senses
from sandbox.settings import RunSettings
from tasks.simulated_user.configuration import UserConfiguration
from tests.chromium import BINARY, Browser, Tab
from tests.test_page_server import Stage, wait_for

pytestmark = pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing")

PPI = 60.0
WIDTH, HEIGHT = 372, 279
KEY = f"hand-sandbox:px-per-inch:{HEIGHT}x{WIDTH}@1"
KNOWN = {KEY: str(PPI), "hand-sandbox:advised": "yes", "hand-sandbox:quality": "3"}
"""What a page remembers whose person has played before, on a slow device: a browser without a
graphics card draws in software, with the same two cores that simulate."""
READY = "!!document.querySelector('.dot[data-condition=open]')"
TASKS = [TaskName("box-to-goal", "Bring a box to its goal.", False)]


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    browser = Browser(tmp_path_factory.mktemp("chromium"))
    yield browser
    browser.close()


@pytest.fixture
def server() -> Iterator[PageServer]:
    server = PageServer(tasks=TASKS)
    yield server
    server.close()


def staged(server: PageServer, **settings: object) -> Stage:
    values = {"surface_in": (WIDTH / PPI, HEIGHT / PPI), **settings}
    session = build(
        RunSettings(**values),  # type: ignore[arg-type]
        lambda task, surface: WebDevice(surface, server.latency),
    )
    device = session.rigs[0].device
    assert isinstance(device, WebDevice)
    stage = Stage(server, session, device)
    stage.open_scene(server.next_scene())
    return stage


@pytest.fixture
def stage(server: PageServer) -> Stage:
    return staged(server)


@pytest.fixture
def tab(browser: Browser, server: PageServer) -> Iterator[Tab]:
    tab = browser.open(server.url, width=WIDTH, height=HEIGHT, storage=KNOWN)
    yield tab
    tab.close()


def frames(stage: Stage, truth: Callable[[list[TouchFrame]], bool]) -> list[TouchFrame]:
    """Touch frames that the page has sent since the last look, up to one with what is waited for."""
    found: list[TouchFrame] = []

    def enough() -> bool:
        found.extend(stage.device.poll())
        return truth(found)

    assert wait_for(enough, 20.0), found
    return found


def px(frame: TouchFrame) -> list[tuple[int, float, float]]:
    """Contacts in CSS pixels of a page that its touch rectangle fills."""
    scale = PPI / METRES_PER_INCH
    return [(c.id, round(c.x * scale, 2), round(c.y * scale, 2)) for c in frame.contacts]


@pytest.mark.parametrize("fingers", [3])
def test_fingers_on_the_page_bring_the_box_to_its_goal(
    stage: Stage, tab: Tab, tmp_path: Path, fingers: int
) -> None:
    session, task = stage.session, stage.session.task
    surface = session.rigs[0].reconstructor.surface
    user = SimulatedDevice(task, UserConfiguration(fingers=fingers), surface, 0)
    tab.wait(READY)
    assert wait_for(lambda: stage.server.wait_for_player(0.0))
    stage.advance()
    tab.wait("document.querySelector('.reason').textContent.includes('mm from the goal')")
    last, most = [], 0
    while not session.over:
        snapshot = session.advance()
        user.show(snapshot)
        stage.server.publish(snapshot, senses=senses(session))
        # In step with the browser, however slow it is today: what the user's fingers do in this
        # period has arrived before the next one begins.
        wanted = px(user.poll(snapshot.time)[-1])
        if wanted != last:
            tab.touch(wanted)
            assert wait_for(stage.device.news.is_set, 20.0)
            last, most = wanted, max(most, len(wanted))
        if snapshot.score.held:
            break
    assert most == fingers
    assert session.scorer.score.success, session.scorer.score
    stage.server.publish(session.snapshot())
    tab.wait("document.querySelector('.end-words').textContent.startsWith('Done in')")
    tab.screenshot(tmp_path / "success.png")
    assert (tmp_path / "success.png").stat().st_size > 10_000
    assert "drawn" in stage.server.latency.percentiles()
    assert nobody_else_was_asked(tab, stage.server)
    assert not tab.events("Runtime.exceptionThrown")


def nobody_else_was_asked(tab: Tab, server: PageServer) -> bool:
    asked = [e["request"]["url"] for e in tab.events("Network.requestWillBeSent")]
    asked += [e["url"] for e in tab.events("Network.webSocketCreated")]
    own = (f"{server.access.host}:{server.access.port}", "")
    foreign = [u for u in asked if urlsplit(u).netloc not in own]
    assert any("app.js" in u for u in asked)
    assert not foreign
    return True
