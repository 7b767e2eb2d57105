"""When a page is away and time stands still: one rule for play and studies."""

from __future__ import annotations

import time

import pytest

from models.surface import Surface
from sandbox.server import clients
from sandbox.server.page_server import AutoPause
from sandbox.server.protocol import PageScreen, PageTouches
from sandbox.server.web import WebDevice
from tests.sandbox.server.test_page_server import Stage, wait_for
from tests.support.page_client import SCREEN, Page

FINGER = PageTouches(1, 0.0, [(1, 300.0, 300.0, 20.0, 20.0)])
LONG = 60.0


class Present:
    """As much of a page's server as the rule needs."""

    away = False


def pages(count: int, begun: bool = False) -> tuple[list[Present], list[WebDevice], AutoPause]:
    """Pages, the devices of their touches, and the rule for them."""
    servers, devices = (
        [Present() for _ in range(count)],
        [WebDevice(Surface()) for _ in range(count)],
    )
    both = list(zip(servers, devices, strict=True))
    return servers, devices, AutoPause(both, begun=begun)  # type: ignore[arg-type]


def touch(device: WebDevice) -> None:
    device.receive(FINGER, PageScreen(**SCREEN))


def test_time_begins_with_the_first_touch_on_any_page_and_stops_while_one_is_away() -> None:
    servers, devices, rule = pages(2)
    assert rule.check(0.0, False) == "start" and not rule.begun
    touch(devices[1])
    assert rule.check(0.0, False) == "" and rule.begun
    servers[0].away = True
    assert rule.check(1.0, False) == "away"
    servers[0].away = False
    assert rule.check(1.0, False) == "back"
    touch(devices[0])
    assert rule.check(1.0, False) == ""
    (absence,) = rule.listed()
    assert absence["at_s"] == 1.0 and absence["lasted_s"] >= 0.0


def test_a_goal_that_is_held_needs_nobody() -> None:
    servers, devices, rule = pages(1)
    touch(devices[0])
    rule.check(0.0, False)
    servers[0].away = True
    assert rule.check(2.0, held=True) == "" and rule.listed() == []


def test_after_a_pause_by_the_experimenter_time_goes_on_with_a_touch() -> None:
    _, devices, rule = pages(1, begun=True)
    assert rule.check(0.0, False, paused=True) == "menu"
    assert rule.check(0.0, False) == "back"
    touch(devices[0])
    assert rule.check(0.0, False) == ""


def test_a_page_that_nobody_touches_stops_nothing_while_it_is_there() -> None:
    server = Present()
    rule = AutoPause([(server, None)])  # type: ignore[list-item]
    assert rule.check(0.0, False) == ""
    server.away = True
    assert rule.check(0.0, False) == "away"
    server.away = False
    assert rule.check(0.0, False) == ""


def test_a_page_that_falls_silent_with_a_finger_down_stays_away_once_its_touch_is_cancelled(
    stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clients, "SILENT", LONG)
    monkeypatch.setattr(clients, "SILENT_TOUCHED", LONG)
    with Page(stage.server.url) as page:
        page.touch((1, 3.0, 3.0))
        assert wait_for(lambda: stage.device.touched) and not stage.server.away
        monkeypatch.setattr(clients, "SILENT_TOUCHED", 0.1)
        assert wait_for(lambda: stage.server.counters["silent page"] == 1)
        # They are taken away, not lifted.
        assert not stage.device.touched and stage.device.poll()[-1].cancelled == {1}
        assert stage.server.away
        page.touch()
        assert wait_for(lambda: not stage.server.away)


def test_a_page_without_a_finger_is_away_after_its_own_limit(
    stage: Stage, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(clients, "SILENT_TOUCHED", 0.01)
    monkeypatch.setattr(clients, "SILENT", LONG)
    with Page(stage.server.url) as page:
        page.until("scene")
        time.sleep(0.1)
        assert not stage.server.away
        monkeypatch.setattr(clients, "SILENT", 0.05)
        assert wait_for(lambda: stage.server.away)
