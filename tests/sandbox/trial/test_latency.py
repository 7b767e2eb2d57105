"""How long touches take: what is measured, what is shown, and what a limit makes of it."""

from __future__ import annotations

import io
import time
from functools import partial
from pathlib import Path

import pytest
from rich.console import Console

from models.frames import TouchFrame
from sandbox.cli.main import main
from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.devices.tuio.tuio import TuioDevice
from sandbox.devices.wrappers.playing import LiftKeys, MergedDevice
from sandbox.play.player_requests import judge_latency
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.trial.driver import LiveRun, Trial
from sandbox.trial.logs import LatencyLog, TimedDevice, Timing
from tests.support.processes import PATIENCE, Sender
from tests.support.tuio_packets import frame
from tests.support.viewed import advance, mouse_session, viewed


def console() -> Console:
    return Console(file=io.StringIO(), width=120)


def said(to: Console) -> str:
    assert isinstance(to.file, io.StringIO)
    return to.file.getvalue()


def test_a_touch_is_followed_to_its_step_and_to_the_first_picture_that_has_it() -> None:
    log = LatencyLog()
    timing = Timing(log)
    session, mouse, surface = mouse_session()
    session.rigs[0].device = TimedDevice(mouse, timing)
    timing.stepped(session.advance())
    assert log.percentiles() == {}
    mouse.press(surface.size / 2)
    mouse.move(surface.size / 2 + 0.001)
    time.sleep(0.02)
    before = session.snapshot()
    after = session.advance()
    timing.stepped(after)
    timing.drawn(before)
    assert "window" not in log.percentiles()
    time.sleep(0.02)
    timing.drawn(after)
    timing.drawn(after)
    found = log.percentiles()
    assert {kind: p.n for kind, p in found.items()} == {"waited": 2, "stepped": 1, "window": 2}
    # Sleeps never end early, so these hold however slow the machine is.
    assert found["waited"].p50 >= 20.0 and found["window"].p50 >= 40.0
    assert found["window"].p50 >= found["waited"].p50 + found["stepped"].p50


def test_a_key_that_lifts_is_no_touch_that_waited() -> None:
    log = LatencyLog()
    mouse = MouseDevice(viewed().surface)
    keys = LiftKeys(mouse)
    device = TimedDevice(keys, Timing(log))
    mouse.press([0.05, 0.05])
    device.poll(0.0)
    keys.hold(1.0)
    assert [len(device.poll(0.1 * i)) for i in (1, 2, 3)] == [1, 1, 1]
    assert log.percentiles()["waited"].n == 1
    mouse.move([0.06, 0.05])
    device.poll(0.4)
    assert log.percentiles()["waited"].n == 2


def test_a_device_that_is_followed_gives_the_same_states() -> None:
    hashes = []
    for followed in (False, True):
        session, mouse, surface = mouse_session()
        if followed:
            session.rigs[0].device = TimedDevice(MergedDevice([mouse]), Timing(LatencyLog()))
        mouse.hand(3, surface.to_surface(session.task.objects[0].position))
        advance(session, 0.3)
        hashes.append(session.state_hash)
    assert hashes[0] == hashes[1]


def test_a_clock_that_begins_with_its_device_is_set_right() -> None:
    class Late(MouseDevice):
        clock_origin = time.monotonic()

        def poll(self, now: float) -> list[TouchFrame]:
            return [TouchFrame(0.0)]

    log = LatencyLog()
    time.sleep(0.01)
    TimedDevice(Late(viewed().surface), Timing(log)).poll(0.0)
    assert 10.0 <= log.percentiles()["waited"].p50 < 600_000.0


def test_a_packet_of_a_tablet_is_timed_from_its_arrival() -> None:
    log = LatencyLog()
    with TuioDevice(viewed().surface, port=0) as tuio, Sender(tuio.port) as send:
        device = TimedDevice(tuio, Timing(log))
        sent = time.monotonic()
        send(frame(1, {0: (0.5, 0.5)}))
        assert tuio.wait(PATIENCE)
        time.sleep(0.02)
        assert device.frame_ready.is_set(), "the step that takes it in is made at once"
        assert len(device.poll(0.0)) == 1 and not device.frame_ready.is_set()
        # It cannot have come before it was sent, nor after `wait` knew of it.
        assert 20.0 <= log.percentiles()["waited"].p50 <= 1000.0 * (time.monotonic() - sent)


@pytest.mark.parametrize(("p95", "limit", "code"), [(20.0, 50.0, 0), (60.0, 50.0, 1)])
def test_a_limit_is_about_the_whole_way_to_a_picture(p95: float, limit: float, code: int) -> None:
    log = LatencyLog()
    for way in ("window", "drawn"):
        for _ in range(100):
            log.add(way, 10.0)
        log.add("waited", 1000.0)
    for _ in range(10):
        log.add("window", p95)
    to = console()
    assert judge_latency(log, limit, to) == code
    assert ("above" in said(to)) is bool(code) and "50 ms" in said(to)
    assert judge_latency(log, None, to) == 0


def test_a_session_without_a_touch_is_not_within_any_limit() -> None:
    log = LatencyLog()
    log.add("waited", 1.0)
    to = console()
    assert judge_latency(log, 1e9, to) == 1 and "nothing was measured" in said(to)


def _note_hash(hashes: list[str], session: Session, _: Snapshot) -> None:
    hashes.append(session.state_hash)


def test_slower_time_changes_no_state() -> None:
    hashes = []
    for speeds in ((1.0,), (0.5, 4.0, 0.25)):
        session, mouse, surface = mouse_session()
        mouse.hand(3, surface.to_surface(session.task.objects[0].position))
        snapshots: list[str] = []
        note = partial(_note_hash, snapshots, session)
        live = LiveRun(Trial(session, [note]))
        live.start()
        for speed in speeds:
            live.set_speed(speed)
            time.sleep(0.1)
        end = time.monotonic() + 60.0
        while len(snapshots) < 10 and time.monotonic() < end:
            time.sleep(0.005)
        live.stop()
        hashes.append(snapshots[:10])
    assert len(hashes[0]) == 10 and hashes[0] == hashes[1]


def test_without_a_window_it_plays_what_needs_none(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    done = tmp_path / "done.jsonl"
    assert main(["play", "--device", "simulated", "--view", "none", "--record", str(done)]) == 0
    assert done.exists() and "box-to-goal" in capsys.readouterr().out
    assert main(["play", "--view", "none"]) == 2
    assert "--view none" in capsys.readouterr().err
    asked = ["play", "--device", "simulated", "--view", "none", "--max-latency", "50"]
    assert main(asked) == 2
    assert "from a touch to its picture" in capsys.readouterr().err
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("sandbox.views.graphics.sys.platform", "linux")
    assert main(["play"]) == 2
    assert "--view web" in capsys.readouterr().err


def test_a_result_tells_the_latency_of_its_own_trial_and_the_session_that_of_all() -> None:
    log = LatencyLog()
    for trial in range(1, 4):
        log.begin_trial()
        for _ in range(trial):
            log.add("picture", float(trial))
        assert log.as_json()["picture"]["n"] == trial
    assert log.percentiles()["picture"].n == 6
