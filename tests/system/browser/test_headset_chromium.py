"""The headset's page in a real browser on an emulated headset (IWER, which stands in for a Quest).

Nobody wears it. The hands are those of the simulated person of `sandbox.devices.simulated`; time
is stretched: the session waits for the browser, which draws by software.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import cast
from urllib.parse import urlsplit

import numpy as np
import pytest

from models.arithmetic import Array
from models.frames import HandFrame
from models.surface import Surface
from sandbox.cli.main import main
from sandbox.devices.device import Device, HandDevice
from sandbox.devices.simulated.in_air import SimulatedHeadset
from sandbox.devices.webxr.webxr import HeadsetDevice
from sandbox.play.pages import show_session
from sandbox.server.page_server import PageServer
from sandbox.server.static import HEADSET, StaticFiles
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.driver import View, play_trial
from sandbox.trial.trial_options import TrialOptions, trial_settings
from sandbox.words import words_in
from tasks.task import Task
from tasks.user import UserConfiguration
from tests.encoders.air.joint_hands import joints, points
from tests.support.chromium import BINARY, Browser, Tab
from tests.support.processes import PATIENCE
from tests.system.browser.emulated_headset import show, worn

pytestmark = [
    pytest.mark.skipif(not os.path.exists(BINARY), reason="Debian's chromium is missing"),
    pytest.mark.needs("iwer"),
]

WORDS = words_in("en")
LINE = "document.querySelector('.line').textContent"
ENTER = "document.querySelector('.enter')"
SIZE = {"width": 200, "height": 150}
"""CSS pixels of the page: few, as software draws them."""
EVERY = 2
"""Control steps from one picture of the hand to the next: 31 a simulated second."""


@pytest.fixture
def server() -> Iterator[PageServer]:
    server = PageServer(files=StaticFiles(index=HEADSET))
    yield server
    server.close()


@dataclass
class Room:
    """A person's room, with a table that the page has laid into it."""

    tab: Tab
    device: HeadsetDevice

    def __post_init__(self) -> None:
        self.shift = np.zeros(3)

    def enter(self) -> None:
        """Puts the headset on, and finds out where the table is: it is not turned."""
        self.tab.wait(f"{ENTER}.hidden === false")
        self.tab.evaluate(f"{ENTER}.click(); true")
        self.tab.wait(f"{LINE} === {WORDS['headset_inside']!r}")
        told = np.array(joints()["joints"], dtype=object)
        at = np.array([[0.0, 0.0, 0.0] if p is None else p for p in told])
        seen = self.seen(at)
        assert seen.hands[0].wrist is not None
        self.shift = np.array(seen.hands[0].wrist) - at[0]

    def seen(self, places: Array, side: str = "right") -> HandFrame:
        """Holds a hand with joints (25, 3) m where they are in the world, until it is seen."""
        places = places - self.shift
        self.device.poll()
        show(self.tab, {side: np.stack([places[:, 0], places[:, 2], -places[:, 1]], 1).tolist()})
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            for frame in self.device.poll():
                for hand in frame.hands:
                    if hand.side == side and hand.wrist is not None:
                        off = np.array(hand.fingers[1].tip) - (places + self.shift)[9]
                        if not self.shift.any() or float(np.abs(off).max()) < 5e-5:
                            return frame
            self.device.frame_ready.wait(0.05)
        raise AssertionError("the hand was never seen")


class PersonInVr(HandDevice):
    """The simulated person, whose hand comes by the page."""

    name = "person in an emulated headset"
    takes_snapshots = True
    finished = False

    def __init__(self, person: SimulatedHeadset, room: Room) -> None:
        self._person, self.room = person, room
        self._step, self._inside = 0, False

    def show(self, snapshot: Snapshot) -> None:
        self._person.show(snapshot)

    def poll(self, now: float) -> Sequence[HandFrame]:
        if not self._inside:
            self._inside = True
            self.room.enter()
        self._step += 1
        if self._step % EVERY != 1:
            return ()
        told = self._person.joints(now)
        return [replace(self.room.seen(np.array(told.joints, float), told.side), time=now)]


@pytest.mark.parametrize("name", ["box-to-goal", pytest.param("stack", marks=pytest.mark.full)])
def test_the_simulated_person_does_a_task_through_the_page(
    browser: Browser,
    server: PageServer,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    name: str,
) -> None:
    tab = worn(browser, server.url)
    tab.resize(**SIZE)
    device = HeadsetDevice()
    settings = trial_settings(TrialOptions(task=name, device="webxr-simulated"))

    def make(task: Task, surface: Surface) -> Device:
        person = SimulatedHeadset(task, UserConfiguration(), settings.seed)
        return cast(Device, PersonInVr(person, Room(tab, device)))

    def views(session: Session) -> list[View]:
        show_session(server, session, "right", "simulated user", device)
        return [server.publish]

    file = tmp_path / "trial.jsonl"
    result = play_trial(settings, (make,), views, file)
    requests = tab.events("Network.requestWillBeSent")
    tab.close()
    assert result.success, result.reason
    assert main(["replay", str(file)]) == 0
    assert "equal to the bit" in capsys.readouterr().out
    asked = {urlsplit(r["request"]["url"]).netloc for r in requests}
    assert asked - {""} == {urlsplit(server.url).netloc}


@pytest.fixture
def room(browser: Browser, server: PageServer) -> Iterator[Room]:
    """A person in VR before a table."""
    chosen = trial_settings(TrialOptions(device="webxr"))
    session = build(chosen, device_makers(chosen))
    device = session.first_rig.device.find(HeadsetDevice)
    assert device is not None
    show_session(server, session, "right", "", device)
    server.publish(session.snapshot())
    tab = worn(browser, server.url)
    tab.resize(**SIZE)
    room = Room(tab, device)
    room.enter()
    yield room
    tab.close()
    session.close()


def soon(condition: object) -> None:
    assert callable(condition)
    until = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < until
        time.sleep(0.02)


def test_the_table_lies_before_the_person_and_joints_come_in_its_world(room: Room) -> None:
    # The headset is 1.6 m above the floor, and looks along -z.
    assert room.shift[0] == pytest.approx(0.0, abs=1e-3)
    told = points(np.zeros(48)) + np.array([0.0, 0.0, 0.1])
    places = np.zeros((25, 3))
    places[:] = told[0]
    for finger, first in enumerate((3, 6, 9, 12), start=1):
        places[5 * finger + 1 : 5 * finger + 4] = told[first : first + 3]
        places[5 * finger + 4] = told[15 + finger]
    places[1:5] = told[1], told[2], 0.5 * (told[2] + told[15]), told[15]
    (hand,) = room.seen(places).hands
    assert hand.side == "right" and len(hand.fingers) == 5
    assert hand.normal[2] < -0.9 and hand.direction[1] > 0.9


def test_a_headset_that_is_taken_off_is_told_and_time_waits(room: Room, server: PageServer) -> None:
    soon(lambda: room.device.touched)
    assert not server.away
    room.tab.evaluate("device.activeSession.end(); true")
    room.tab.wait(f"{LINE} === {WORDS['headset_left']!r}")
    soon(lambda: server.away)
    room.enter()
    soon(lambda: not server.away)


def test_a_hand_that_leaves_is_seen_no_more(room: Room) -> None:
    soon(lambda: room.device.touched)
    show(room.tab, {})
    soon(lambda: not room.device.touched)


def test_controllers_pinch(room: Room) -> None:
    room.tab.evaluate("show({}); device.primaryInputMode = 'controller'; true")
    room.tab.evaluate("device.controllers.right.connected = true")

    def gap() -> float:
        room.device.poll()
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            for frame in room.device.poll():
                for hand in frame.hands:
                    if hand.side == "right":
                        tips = [np.array(f.tip) for f in hand.fingers]
                        return float(np.linalg.norm(tips[0] - tips[1]))
            time.sleep(0.02)
        raise AssertionError("no controller was seen")

    assert gap() > 0.08
    room.tab.evaluate("device.controllers.right.updateButtonValue('trigger', 1); true")
    soon(lambda: gap() < 0.016)


def test_a_page_that_is_closed_leaves_no_hand(room: Room, server: PageServer) -> None:
    soon(lambda: room.device.touched)
    room.tab.call("Page.navigate", url="about:blank")
    soon(lambda: not room.device.touched)
    soon(lambda: server.away)


def test_a_browser_without_vr_says_so_in_one_line(browser: Browser, server: PageServer) -> None:
    tab = browser.open(server.url, **SIZE)
    tab.evaluate("true")
    tab.wait(f"{LINE} === {WORDS['headset_none']!r}")
    assert tab.evaluate(f"{ENTER}.hidden")
    tab.close()


def test_a_headset_that_refuses_says_so_in_one_line(browser: Browser, server: PageServer) -> None:
    tab = worn(browser, server.url)
    tab.resize(**SIZE)
    tab.wait(f"{ENTER}.hidden === false")
    tab.evaluate("navigator.xr.requestSession = () => Promise.reject(new Error('no')); true")
    tab.evaluate(f"{ENTER}.click(); true")
    tab.wait(f"{LINE} === {WORDS['headset_refused']!r}")
    tab.close()
