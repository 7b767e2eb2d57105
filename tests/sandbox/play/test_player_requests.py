"""A player on a page chooses fingers and tasks; notices reach them and hold no session up."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

import pytest
from rich.console import Console

from models.surface import PRESETS, Surface
from sandbox.play.page_play import PagePlay
from sandbox.play.pages import open_page
from sandbox.play.player_requests import NoticePrinter, PlayerRequests, can_choose_fingers
from sandbox.server.page_options import PageOptions
from sandbox.server.protocol import PageScreen, PageTouches, PlayerRequest, decode
from sandbox.server.web import WebDevice
from sandbox.trial.logs import EventLog
from sandbox.trial.settings import Settings
from sandbox.trial.trial_options import TrialOptions
from tests.sandbox.play.played_page import played
from tests.support.page_client import Page
from tests.support.processes import until


def requested(task: str, value: str, settings: Settings | None = None) -> str:
    """Sets of fingers of a trial after a request."""
    settings = settings or Settings(task=task)
    requests = PlayerRequests.of(settings)
    requests.take([PlayerRequest("fingers", value)])
    return requests.applied_to(settings).pipeline.finger_sets


@pytest.mark.parametrize("sets", ["", "thumb+index", "thumb+index:3,index+middle"])
def test_the_next_trial_has_the_fingers_that_were_chosen(sets: str) -> None:
    assert requested("box-to-goal", sets) == sets


@pytest.mark.parametrize("text", ["thumb+toe", "thumb+thumb", "+", "thumb+index:-1"])
def test_what_is_no_set_of_fingers_is_ignored(text: str) -> None:
    settings = Settings(task="box-to-goal").changed(finger_sets="thumb+index")
    assert requested("box-to-goal", text, settings) == "thumb+index"


def test_a_task_that_needs_more_fingers_is_played_with_any() -> None:
    assert requested("chords", "thumb+index") == ""
    assert requested("stack", "index") == ""
    assert requested("stack", "thumb+index") == "thumb+index"


def test_fingers_cannot_be_chosen_where_labels_do_not_use_them() -> None:
    paper = Settings(task="box-to-goal").changed(labels="paper")
    assert not can_choose_fingers(paper)
    assert requested("box-to-goal", "thumb+index", paper) == ""


def test_fingers_that_keys_put_down_on_a_page_have_their_labels() -> None:
    device = WebDevice(Surface(*PRESETS["ipad2"]))
    screen = PageScreen(132.0, 1024.0, 768.0, True)
    up = decode(
        '{"type":"touches","seq":1,"t":0,"contacts":[[4,100,100,0,0],[5,200,100,0,0]],'
        '"labels":[[4,0]]}'
    )
    assert isinstance(up, PageTouches)
    device.receive(up, screen)
    (frame,) = device.poll()
    assert [contact.label for contact in frame.contacts] == [0, None]


TASK = """
from tasks.box_to_goal import BoxToGoal


class Push(BoxToGoal):
    name = "lab-push"
"""


def own_task(folder: Path) -> str:
    file = folder / "push.py"
    file.write_text(TASK)
    return f"{file}:Push"


def test_another_task_is_chosen_and_then_the_players_own_again(tmp_path: Path) -> None:
    own = own_task(tmp_path)
    server = open_page(PageOptions(), task=own)
    play = PagePlay(
        TrialOptions(task=own, device="web"), (server,), EventLog(None), Console(quiet=True)
    )
    try:
        with played(play, server), Page(server.url) as page:
            assert "lab-push" in [task["name"] for task in page.until("welcome")["tasks"]]
            assert page.until("scene")["task"] == "lab-push"
            page.say(type="ask", what="task", value="wrench-turn")
            assert page.until("scene", task="wrench-turn")
            page.say(type="ask", what="task", value="lab-push")
            assert page.until("scene", task="lab-push")
    finally:
        server.close()


def test_a_task_that_is_on_no_menu_is_no_request(tmp_path: Path) -> None:
    own = own_task(tmp_path)
    requests = PlayerRequests.of(Settings(task=own))
    requests.take([PlayerRequest("task", "lab-pull"), PlayerRequest("task", own)])
    assert requests.task == own and not requests.again
    requests.take([PlayerRequest("task", "stack")])
    assert requests.task == "stack" and requests.again
    requests.take([PlayerRequest("task", "lab-push")])
    assert requests.task == own


def test_a_terminal_that_takes_nothing_holds_up_nobody_and_gets_all_notices_later() -> None:
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writing, b" " * 4096)
    os.set_blocking(writing, True)
    with os.fdopen(writing, "w") as terminal, os.fdopen(reading, "rb", buffering=0) as person:
        printer = NoticePrinter(Console(file=terminal, width=60))
        for number in range(100):
            printer.say(f"notice {number} of [the hand]")
        printer.wait(0.05)
        assert printer.waiting > 90
        seen = b""

        def all_seen() -> bool:
            nonlocal seen
            seen += person.read(1 << 16)
            return seen.count(b"of [the hand]") == 100

        until(all_seen)
        until(lambda: not printer.waiting)
        assert seen.index(b"notice 3 ") < seen.index(b"notice 40 ")
