"""A screen with no room for a task: what its person is told, and who plays then."""

from __future__ import annotations

from collections.abc import Iterator

import pytest
from rich.console import Console

from models.surface import PRESETS
from sandbox.play.page_play import PagePlay
from sandbox.play.pages import open_page
from sandbox.server import clients
from sandbox.server.page_options import PageOptions
from sandbox.server.page_server import PageServer
from sandbox.server.screen import fitting
from sandbox.trial.logs import EventLog
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions
from tasks.registry import TASKS, hands_of
from tests.sandbox.play.played_page import played
from tests.support.page_client import SCREEN, Page

PHONE = {"px_per_in": 155.0, "width_px": 844.0, "height_px": 390.0, "calibrated": True}


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
    with Page(server.url, "phone", screen=PHONE) as phone:
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
