"""A player on a page says which fingers they use."""

from __future__ import annotations

import pytest

from models.surface import PRESETS, Surface
from sandbox.play.player_requests import PlayerRequests, can_choose_fingers
from sandbox.server.protocol import PageScreen, PageTouches, PlayerRequest, decode
from sandbox.server.web import WebDevice
from sandbox.trial.settings import Settings


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
