"""Tables and screens: which tasks have room, which results count, and who plays."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from rich.console import Console

from models.errors import StudyError
from models.surface import METRES_PER_INCH, PRESETS, Surface
from sandbox.play.page_play import PagePlay
from sandbox.play.pages import open_page
from sandbox.recording.recording import load_recording
from sandbox.server import clients
from sandbox.server.page_options import PageOptions
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import LIFT_STRIP_PX, PageScreen, PageTouches
from sandbox.server.screen import LARGEST, LEAST, fitting, scaled
from sandbox.server.web import WebDevice
from sandbox.study.run.page_player import settings_for_screen
from sandbox.study.run.study_page import StudyPage
from sandbox.trial.logs import EventLog
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions
from tasks.registry import TASKS, hands_of
from tests.sandbox.play.played_page import played
from tests.support.page_client import SCREEN, Page

SCREENS = [
    (844, 390, 155.0),
    (390, 844, 155.0),
    (1280, 800, 110.0),
    (3840, 2160, 110.0),
    (900, 1400, 110.0),
]


PHONE = PageScreen(155.0, 844.0, 390.0, False, "phone")
SMALL = {"px_per_in": 155.0, "width_px": 844.0, "height_px": 390.0, "calibrated": True}


@pytest.mark.parametrize("lifts", [False, True])
@pytest.mark.parametrize(("width", "height", "ppi"), SCREENS)
def test_every_task_fits_on_a_table_that_fills_its_screen(
    width: int, height: int, ppi: float, lifts: bool
) -> None:
    screen = PageScreen(ppi, width, height, False, "mouse")
    found = scaled(screen, lifts)
    size, scale = found["size_in"], found["scale"]
    for side, least, most in zip(size, LEAST, LARGEST, strict=True):
        assert least - 1e-3 <= side <= most
    wide, high = (round(side * scale * ppi, 1) for side in size)
    room = width - (LIFT_STRIP_PX if lifts else 0.0)
    assert wide <= room + 0.1 and high <= height + 0.1
    # At least one direction is full.
    assert wide > 0.99 * room or high > 0.99 * height
    if width > height:
        one_hand = {name for name, task in TASKS.items() if hands_of(task) == 1}
        assert set(fitting(Surface(*size), 0)) == one_hand


def test_places_are_scaled_and_fingers_are_not() -> None:
    device = WebDevice(Surface(10.0, 5.0, scale=0.5))
    screen = PageScreen(100.0, 500.0, 250.0, False, "phone")
    device.receive(PageTouches(1, 0.0, [(1, 100.0, 50.0, 60.0, 70.0)]), screen)
    ((contact,),) = [frame.contacts for frame in device.poll()]
    assert (contact.x, contact.y) == pytest.approx((2.0 * METRES_PER_INCH, METRES_PER_INCH))
    assert contact.extent == pytest.approx((0.6 * METRES_PER_INCH, 0.7 * METRES_PER_INCH))


def test_a_study_refuses_a_scaled_table() -> None:
    page = cast(StudyPage, SimpleNamespace(server=SimpleNamespace(screen=PHONE)))
    with pytest.raises(StudyError, match="a study cannot use a scaled table"):
        settings_for_screen(page, Settings(), designed=False)


@pytest.mark.parametrize(("fit", "scored"), [("phone", False), ("mouse", True), ("", True)])
def test_the_result_on_a_phone_does_not_count_and_says_so(
    tmp_path: Path, fit: str, scored: bool
) -> None:
    screen: dict[str, Any] = {
        "px_per_in": 155.0,
        "width_px": 844.0 if fit else 1600.0,
        "height_px": 390.0 if fit else 1200.0,
        "calibrated": False,
        "fit": fit,
    }
    server, told = open_page(PageOptions()), tmp_path / "events.jsonl"
    options, events = TrialOptions(device="web", record=tmp_path / "trial.jsonl"), EventLog(told)
    play = PagePlay(options, (server,), events, Console(quiet=True))
    try:
        with played(play, server), Page(server.url, "one", screen=screen) as page:
            scene = page.until("scene")
            assert scene["scored"] is scored
            assert (scene["surface"]["scale"] == 1.0) is (fit == "")
            # Time begins with a touch.
            page.touch((1, 1.5, 1.5))
            page.until("frame")
    finally:
        server.close()
        events.close()
    settings = load_recording(tmp_path / "trial.jsonl").header["settings"]
    assert settings["surface"]["scale"] == pytest.approx(scene["surface"]["scale"])
    assert settings["scored"] is scored
    (end,) = [line for line in map(json.loads, told.read_text().splitlines()) if "status" in line]
    assert end.get("scored", True) is scored
    assert ("surface_scale" in end) is (fit != "")


def test_a_tablet_has_room_for_every_task_of_one_hand_and_a_phone_for_none() -> None:
    one_hand = {name for name, task in TASKS.items() if hands_of(task) == 1}
    tablet = Settings().changed(size_in=PRESETS["ipad2"]).surface.rectangle
    assert set(fitting(tablet, 0)) == one_hand
    assert fitting(Settings().changed(size_in=(5.45, 2.52)).surface.rectangle, 0) == ()


@pytest.fixture
def server() -> Iterator[PageServer]:
    server = open_page(PageOptions())
    play = PagePlay(TrialOptions(device="web"), (server,), EventLog(None), Console(quiet=True))
    with played(play, server):
        yield server
    server.close()


def test_a_phone_makes_room_for_a_tablet_and_looks_on(server: PageServer) -> None:
    with Page(server.url, "phone", screen=SMALL) as phone:
        assert phone.until("welcome")["role"] == "player"
        assert any("No task fits" in one["text"] for one in phone.until("trouble")["told"])
        with Page(server.url, "tablet", screen=dict(SCREEN)) as tablet:
            assert tablet.until("welcome")["role"] == "player"
            surface = tablet.until("scene")["surface"]
            size = surface["width_in"], surface["height_in"]
            assert size == pytest.approx(PRESETS["ipad2"], abs=0.01)
            assert phone.until("welcome")["role"] == "spectator"
            assert phone.until("scene")["scene"]


def test_who_gets_the_seat_gets_a_trial_on_their_own_screen(
    server: PageServer, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clients, "SEAT_TIMEOUT", 0.5)
    with Page(server.url, "second", screen={**SCREEN, "width_px": 1200.0}) as second:
        assert second.until("welcome")["role"] == "player"
        with Page(server.url, "third") as third:
            assert third.until("welcome")["role"] == "spectator"
            assert third.until("scene")["surface"]["width_in"] == pytest.approx(
                1200 / 132, abs=0.01
            )
            second.say(type="ask", what="pause", value="")
            second.close()
            assert third.until("welcome")["role"] == "player"
            # The first scene that comes is the one that runs; then theirs, which is not paused.
            third.until("scene")
            wide = third.until("scene")["surface"]["width_in"]
            assert wide == pytest.approx(1024 / 132, abs=0.01)
