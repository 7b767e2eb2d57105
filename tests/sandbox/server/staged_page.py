"""A page in a real browser, with a session whose touches it sends, for tests."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from typing import Any, Protocol
from urllib.parse import urlsplit

from models.frames import TouchFrame
from models.surface import METRES_PER_INCH
from sandbox.devices.simulated.simulated import SimulatedDevice
from sandbox.server.page_frames import describe_scene, pack_skin
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import LIFT_STRIP_PX, TaskName
from sandbox.server.web import WebDevice
from sandbox.trial.assembly import build
from sandbox.trial.settings import Settings
from tasks.user import UserConfiguration
from tests.sandbox.server.test_page_server import Stage, wait_for
from tests.support.chromium import Tab
from tests.support.page_memory import NO_HINTS
from tests.support.processes import PATIENCE

PPI = 64.0
WIDTH, HEIGHT = 640, 480
KEY = f"hand-sandbox:px-per-inch:{HEIGHT}x{WIDTH}@1"
KNOWN = {
    KEY: str(PPI),
    "hand-sandbox:quality": "3",
    **NO_HINTS,
}
"""What a page remembers whose person has played before, on a slow device: a browser without a
graphics card draws in software, with the same two cores that simulate."""
READY = "!!document.querySelector('.dot[data-condition=open]')"
TASKS = [TaskName("box-to-goal", "Bring a box to its goal.", False)]
BESIDE_LIFT = {"size_in": ((WIDTH - LIFT_STRIP_PX) / PPI, HEIGHT / PPI)}
"""The touch rectangle of that page in a task that lifts."""
WATCHED = """
window.told = [];
const say = WebSocket.prototype.send, arc = CanvasRenderingContext2D.prototype.arc;
const note = (what, x, lift) => told.push([what, x, document.timeline.currentTime, lift]);
WebSocket.prototype.send = function (text) {
  const said = typeof text === "string" ? JSON.parse(text) : {};
  if (said.type === "touches" && said.contacts[0]) note("message", said.contacts[0][1], said.lift);
  return say.call(this, text);
};
CanvasRenderingContext2D.prototype.arc = function (x, ...rest) {
  note("ring", Math.round(100 * x) / 100);
  return arc.call(this, x, ...rest);
};
true
"""
"""Writes down which messages and rings have a finger where, in which picture (ms), and a lift."""


def staged(server: PageServer, **settings: object) -> Stage:
    values = {"size_in": (WIDTH / PPI, HEIGHT / PPI), **settings}
    session = build(
        Settings().changed(**values),
        (lambda task, surface: WebDevice(surface),),
    )
    device = session.rigs[0].device
    assert isinstance(device, WebDevice)
    stage = Stage(server, session, device)
    surface = session.rigs[0].reconstructor.surface
    message = describe_scene(server.next_scene(), session.scene, session.task, surface, "right", "")
    server.show_scene(
        message, session.scene, device, [pack_skin(h) for h in session.scene.spec.hands]
    )
    return stage


def frames(stage: Stage, truth: Callable[[list[TouchFrame]], bool]) -> list[TouchFrame]:
    """Touch frames that the page has sent since the last look, up to what is waited for."""
    found: list[TouchFrame] = []

    def enough() -> bool:
        found.extend(stage.device.poll())
        return truth(found)

    assert wait_for(enough), found
    return found


def px(frame: TouchFrame, left: float = 0.0, top: float = 0.0) -> list[tuple[int, float, float]]:
    """Contacts in CSS pixels of a page whose touch rectangle begins there."""
    scale = PPI / METRES_PER_INCH
    return [
        (c.id, round(left + c.x * scale, 2), round(top + c.y * scale, 2)) for c in frame.contacts
    ]


def nobody_else_was_asked(tab: Tab, server: PageServer) -> bool:
    asked = [e["request"]["url"] for e in tab.events("Network.requestWillBeSent")]
    asked += [e["url"] for e in tab.events("Network.webSocketCreated")]
    own = (f"{server.access.host}:{server.access.port}", "")
    foreign = [u for u in asked if urlsplit(u).netloc not in own]
    assert any("app.js" in u for u in asked)
    assert not foreign
    # Nor was anything asked for that is not there, or without the token.
    assert not server.counters.as_dict()
    return True


class Glass(Protocol):
    """A page in any browser, and fingers on it."""

    def evaluate(self, script: str) -> Any: ...

    def touch(self, fingers: Sequence[tuple[int, float, float]], /) -> None: ...


def until(glass: Glass, script: str) -> None:
    """Waits until an expression is true in the page."""
    asked = f"(() => {{ try {{ return !!({script}) }} catch {{ return false }} }})()"
    end = time.monotonic() + PATIENCE
    while not glass.evaluate(asked):
        said = glass.evaluate("document.body ? document.body.innerText : ''")
        assert time.monotonic() < end, f"never came true: {script}; {said[:600]}"
        time.sleep(0.02)


def play_through(stage: Stage, glass: Glass, corner: tuple[float, float], fingers: int) -> int:
    """Plays the stage's trial to its end by touches on the page.

    Args:
        stage: A session whose touches come from the page.
        glass: The page.
        corner: CSS pixels of the touch rectangle's left upper corner.
        fingers: How many the simulated user uses.

    Returns:
        The most fingers that were down at once.
    """
    session, surface = stage.session, stage.session.rigs[0].reconstructor.surface
    user = SimulatedDevice(session.task, UserConfiguration(fingers=fingers), surface, 0)
    last: list[tuple[int, float, float]] = []
    most = 0
    while not session.over:
        snapshot = session.advance()
        user.show(snapshot)
        stage.server.publish(snapshot)
        # In step with the browser, however slow it is today: what the user's fingers do in this
        # period has arrived before the next one begins. Moves go out twenty times a second.
        wanted = px(user.poll(snapshot.time)[-1], *corner)
        other = [i for i, _, _ in wanted] != [i for i, _, _ in last]
        if other or (wanted != last and session.step % (3 * session.scene.substeps) == 0):
            glass.touch(wanted)
            assert wait_for(stage.device.frame_ready.is_set)
            last, most = wanted, max(most, len(wanted))
    stage.server.publish(session.snapshot())
    return most
