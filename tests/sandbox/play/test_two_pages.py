"""Two tablets: every hand has a page of its own, and both are in one scene."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import pytest
from rich.console import Console

from models.surface import METRES_PER_INCH
from sandbox.play.page_play import PagePlay
from sandbox.play.pages import open_page, touched_pages
from sandbox.server.page_options import PageOptions
from sandbox.server.page_server import PageServer
from sandbox.server.protocol import LIFT_STRIP_PX, PageScreen, PageTouches
from sandbox.trial.assembly import build, device_makers
from sandbox.trial.logs import EventLog
from sandbox.trial.trial_options import TrialOptions, trial_settings
from tests.sandbox.play.played_page import played
from tests.support.page_client import SCREEN, Page

TASK, SEED = "carry-together", 3


SMALL = {**SCREEN, "width_px": 980.0, "calibrated": False}


OPTIONS = TrialOptions(task=TASK, seed=SEED, device="web", second_device="web")


@pytest.fixture
def servers() -> Iterator[tuple[PageServer, PageServer]]:
    both = open_page(PageOptions()), open_page(PageOptions())
    yield both
    for server in both:
        server.close()


@pytest.fixture
def playing(servers: tuple[PageServer, PageServer]) -> Iterator[tuple[PageServer, PageServer]]:
    """`sandbox play carry-together --device web --device web`, without its words."""
    play = PagePlay(OPTIONS, tuple(servers), EventLog(None), Console(quiet=True))
    with played(play, servers[0]):
        yield servers


def contacts(page: Page, seq: int) -> list[list[dict[str, Any]]]:
    """Contacts of both hands in the first frame that has a touch."""
    while (frame := page.until("frame"))["touch"] < seq:
        pass
    found = frame["state"]["hands"]
    return [hand["contacts"] for hand in found]


def test_every_page_has_its_own_hand_and_surface_and_knows_its_own_fingers(
    playing: tuple[PageServer, PageServer],
) -> None:
    with Page(playing[0].url, "one") as right, Page(playing[1].url, "other") as left:
        scenes = [page.until("scene") for page in (right, left)]
        assert [scene["hand"] for scene in scenes] == ["right", "left"]
        origins = [scene["surface"]["origin"] for scene in scenes]
        width = scenes[0]["surface"]["width_in"] * METRES_PER_INCH
        assert origins[0][0] - origins[1][0] == pytest.approx(width)
        assert origins[0][1:] == origins[1][1:]
        left_seq = left.touch((1, 4.0, 3.0), (2, 5.0, 2.5))
        contacts(left, left_seq)
        seq = right.touch((1, 3.0, 3.0))
        own, others = contacts(right, seq)
        assert [c["id"] for c in own] == [1]
        # Two fingers with the same ids touch the other page: here they are nobody's.
        assert sorted(c["id"] for c in others) == [-3, -2]
        assert own[0]["position"][0] == pytest.approx(origins[0][0] + 3.0 * METRES_PER_INCH)
        seq = left.touch((1, 4.0, 3.0), (2, 5.0, 2.6))
        others, own = contacts(left, seq)
        assert [c["id"] for c in others] == [-2]
        assert sorted(c["id"] for c in own) == [1, 2]


def test_a_page_asks_for_its_own_hand_and_one_trial_serves_both(
    playing: tuple[PageServer, PageServer],
) -> None:
    with Page(playing[0].url, "one") as right, Page(playing[1].url, "other") as left:
        assert right.until("scene")["hand"] == "right"
        assert left.until("scene")["hand"] == "left"
        left.say(type="ask", what="hand", value="right")
        assert left.until("scene")["hand"] == "right"
        assert right.until("scene")["hand"] == "right"


def test_who_is_there_first_is_told_what_is_missing(
    playing: tuple[PageServer, PageServer],
) -> None:
    with Page(playing[0].url, "one") as right:
        assert any("other hand" in one["text"] for one in right.until("trouble")["told"])
        with Page(playing[1].url, "other", screen=SMALL) as left:
            # Both surfaces are as large as the smaller screen.
            scenes = [page.until("scene") for page in (right, left)]
            # Beside them is the lift control.
            width = round((980.0 - LIFT_STRIP_PX) / 132.0, 4)
            assert {s["surface"]["width_in"] for s in scenes} == {width}
            assert not any(s["surface"]["calibrated"] for s in scenes)


def test_time_begins_with_whichever_hand_touches_first() -> None:
    from sandbox.play.window_play import _from_first_touch, _waiting

    chosen = trial_settings(replace(OPTIONS, device="mouse"))
    session = build(chosen, device_makers(chosen, _from_first_touch))
    ((hand, page),) = touched_pages(session)
    assert hand == 1
    assert _waiting(session)
    page.receive(PageTouches(1, 0.0, [(1, 300.0, 300.0, 20.0, 20.0)]), PageScreen(**SCREEN))
    assert not _waiting(session)
