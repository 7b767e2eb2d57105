"""Studies with trials for two hands, each of which has a page of its own."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest

from models.frames import TouchFrame
from sandbox.recording.recording import load_recording
from sandbox.study.run.runner import SessionOutcome
from sandbox.trial.replay import replay
from sandbox.trial.settings import recorded_settings
from sandbox.words import words_in
from tests.sandbox.study.study_on_page import OnPage, on_page, study_in, touch
from tests.support.page_client import SCREEN, Page
from tests.support.study_files import PAIRS

PAGES = PAIRS.replace("4.0", '1.5\nshows = ["time"]')
SMALLER = {**SCREEN, "width_px": 1000.0}


def opened(running: OnPage, hand: int, screen: dict[str, Any] = SCREEN) -> Page:
    url = running.page.pages[hand].server.url
    return Page(url, name=f"tablet {hand}", screen=dict(screen), beats=True)


def together(*pages: Callable[[], object]) -> list[Any]:
    """What each page does until it is done; all at once, as a page that says nothing is away."""
    with ThreadPoolExecutor(len(pages)) as pool:
        return list(pool.map(lambda page: page(), pages))


def trial(page: Page, *contacts: tuple[int, float, float]) -> str:
    """Touches as soon as the table is visible, and until it is over; the side of its hand."""
    page.until("sheet", kind="none")
    page.touch(*contacts)
    page.until("sheet", kind="wait")
    return next(str(m["hand"]) for m in page.told if m["type"] == "scene")


def test_a_trial_for_two_hands_is_played_on_two_pages_and_replays(tmp_path: Path) -> None:
    study = study_in(tmp_path, PAGES)
    person = study.add(hand="left", hand_size=1.0, language="en")
    with on_page(study, person, pages=2) as running:
        with opened(running, 0) as own, opened(running, 1, SMALLER) as other:
            assert other.until("sheet")["text"] == words_in("en")["wait"]
            sides = together(
                lambda: trial(own, (1, 3.0, 2.0)),
                lambda: trial(other, (1, 3.0, 3.0), (2, 4.0, 3.0)),
            )
            own.until("sheet", kind="end")
        assert sides == ["left", "right"]
        assert running.ended() is SessionOutcome.COMPLETE
    recording = load_recording(next(running.folder.glob("trials/*.jsonl*")))
    settings = recorded_settings(recording.header)
    assert [d and d.name for d in (settings.device, settings.second_device)] == ["web", "web"]
    # The rectangle fits on both screens, beside the lift control of each.
    assert settings.surface.size_in == pytest.approx((910 / 132, 768 / 132), abs=1e-3)
    last = [recording.inputs[hand][-1].frame for hand in (0, 1)]
    assert [len(frame.contacts) for frame in last if isinstance(frame, TouchFrame)] == [1, 2]
    _, found = replay(recording)
    assert found.exact and found.complete


def paused(page: Page, why: str) -> None:
    """Waits until the page is told why time stands still."""
    while page.until("frame")["state"].get("pause") != why:
        pass


def test_time_stands_still_on_both_pages_until_the_one_that_was_away_is_touched(
    tmp_path: Path,
) -> None:
    study = study_in(tmp_path, PAGES.replace("1.5", "3"))
    person = study.add(hand="right", hand_size=1.0, language="en")
    with on_page(study, person, pages=2) as running, opened(running, 0) as own:
        with opened(running, 1) as other:
            together(lambda: touch(own, 3.0), lambda: touch(other, 3.0))
        paused(own, "away")
        own.touch((1, 3.5, 2.0))
        with opened(running, 1) as other:
            paused(own, "back")
            together(lambda: own.until("sheet", kind="end"), lambda: trial(other, (1, 3.0, 3.0)))
        running.ended()
    (attempt,) = running.state.attempts[1]
    assert attempt.end is not None and attempt.end["result"]["status"] == "timeout"
