"""Playing in the window: what its keys do, what it says, and a whole session with a page beside."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import glfw
import numpy as np
import pytest
import segno

from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.devices.wrappers.playing import LiftKeys, MergedDevice
from sandbox.play.window_play import Footer, hint_of
from sandbox.recording.recording import load_recording
from sandbox.server.web import WebDevice
from sandbox.trial.assembly import build
from sandbox.trial.logs import LatencyLog, TimedDevice, Timing
from sandbox.trial.settings import Settings
from sandbox.views import window as drawing_quality
from sandbox.views.window import SPEEDS
from tests.support.page_client import Page
from tests.support.processes import PATIENCE, ROOT
from tests.support.screen import Screen, screen
from tests.support.viewed import Viewed, advance, mouse_session, viewed
from tests.support.window_shots import screenshot
from tests.system.window.test_window import PIXEL, Desk, drag

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="needs an X server in memory"
)


@pytest.fixture(scope="module")
def display() -> Iterator[Screen]:
    with screen() as shown:
        yield shown
        glfw.terminate()


@pytest.fixture
def desk(display: Screen, monkeypatch: pytest.MonkeyPatch) -> Iterator[Desk]:
    monkeypatch.setattr(drawing_quality, "SLOW", np.inf)
    made = Desk(display, viewed())
    yield made
    made.window.close()


def shot(desk: Desk) -> np.ndarray:
    return np.asarray(screenshot(desk.window), float)


def test_a_key_goes_through_all_speeds_and_back_to_real_time(desk: Desk) -> None:
    plain = shot(desk)
    seen = [desk.window.speed]
    for _ in SPEEDS:
        desk.do("key", "s")
        seen.append(desk.window.speed)
        assert bool(np.abs(shot(desk) - plain).max() > 12) is (desk.window.speed != 1.0)
    assert seen == [1.0, 0.5, 0.25, 0.1, 1.0]


def test_a_key_closes_the_window(desk: Desk) -> None:
    desk.do("key", "q")
    assert not desk.alive


def test_it_counts_its_pictures_and_knows_what_is_seen(desk: Desk) -> None:
    drawn = desk.window.pictures
    desk.pump()
    assert desk.window.pictures == drawn and desk.window.seen is desk.v.ghost
    desk.snapshot = desk.v.solid
    desk.pump()
    assert desk.window.pictures == drawn + 1 and desk.window.seen is desk.v.solid
    assert desk.window.picture_time > 0.0


def test_the_footer_is_at_the_bottom_right_and_tells_rate_lift_and_address(desk: Desk) -> None:
    plain = shot(desk)
    desk.window.footer = ("12 pictures/s", "in a browser: 127.0.0.1:1")
    desk.pump()
    rows, columns = np.nonzero(np.abs(shot(desk) - plain).max(axis=-1) > 12)
    height, width = plain.shape[:2]
    assert len(rows) > 500 and rows.min() > height / 2 and columns.min() > width / 2
    session, _, _ = mouse_session()
    footer = Footer("127.0.0.1:1")
    rate, address = footer.lines(desk.window, 0.0, session)
    assert "pictures/s" in rate and "ms each" in rate and "127.0.0.1:1" in address
    assert any("2.5 s behind" in line for line in footer.lines(desk.window, 2.5, session))
    with_keys = (lambda task, surface: LiftKeys(MouseDevice(surface)),)
    stack = build(Settings(task="stack"), with_keys)
    assert "lifted 0 of 120 mm" in footer.lines(desk.window, 0.0, stack)
    keys = stack.rigs[0].device
    assert isinstance(keys, LiftKeys)
    keys.hold(1.0)
    for _ in range(30):
        stack.advance()
    (lifted,) = [x for x in footer.lines(desk.window, 0.0, stack) if x.startswith("lifted")]
    assert 0 < int(lifted.split()[1]) < 120


def test_the_goal_stays_in_the_panel_and_how_it_is_done_stands_at_the_bottom_left(
    desk: Desk,
) -> None:
    def changed(before: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        desk.pump()
        rows, columns = np.nonzero(np.abs(shot(desk) - before).max(axis=-1) > 12)
        return rows, columns

    plain = shot(desk)
    height, width = plain.shape[:2]
    desk.window.goal = "Bring the box onto its translucent twin."
    rows, columns = changed(plain)
    assert len(rows) > 100 and rows.max() < height / 2 and columns.max() < width / 2
    goal = shot(desk)
    desk.window.hint = hint_of("box-to-goal")
    rows, columns = changed(goal)
    assert len(rows) > 500 and rows.min() > height / 2 and columns.max() < 0.7 * width


def test_a_link_is_shown_as_a_code_of_whole_modules_with_a_quiet_border(desk: Desk) -> None:
    link = "http://192.168.1.20:40123/?token=BVskwYWkRFpZSwmUbY3ILg"
    plain = shot(desk)
    desk.window.link = link
    desk.pump()
    rows, columns = np.nonzero(np.abs(shot(desk) - plain).max(axis=-1) > 12)
    code = shot(desk)[rows.min() : rows.max() + 1, columns.min() : columns.max() + 1, 0]
    wanted = [list(row) for row in segno.make(link, error="m").matrix_iter(border=4)]
    factor = len(code) // len(wanted)
    assert factor >= 3 and code.shape == (factor * len(wanted),) * 2
    assert np.array_equal(code, np.kron(1 - np.array(wanted), np.full((factor, factor), 255)))
    desk.window.link = ""
    desk.pump()
    assert np.array_equal(shot(desk), plain)


def test_another_trial_is_shown_in_the_same_window(desk: Desk) -> None:
    handle, before = desk.window._context.handle, shot(desk)
    session, mouse, surface = mouse_session(seed=5)
    desk.window.paused = True
    desk.do("mousemove", 300, 200, "mousedown", 3)
    desk.do("mousemove", 240, 230)
    desk.do("mouseup", 3)
    turned = desk.at((0.2, 0.2))
    for _ in range(3):
        desk.window.show_scene(session.scene, surface, "another")
        desk.window.attach(mouse)
        desk.mouse, desk.snapshot = mouse, session.snapshot()
        desk.pump()
    assert desk.window._context.handle is handle and not desk.window.paused
    assert desk.at((0.2, 0.2)) == turned
    assert np.abs(shot(desk) - before).mean() > 1.0
    drag(desk, (0.2, 0.3), (0.7, 0.6))
    assert np.allclose(desk.touches()[0], np.array([0.2, 0.3]) * surface.size, atol=PIXEL)


def test_a_mouse_is_found_within_whatever_is_around_it(desk: Desk) -> None:
    keys = LiftKeys(desk.mouse)
    web = WebDevice(desk.v.surface)
    around = TimedDevice(MergedDevice([keys, web]), Timing(LatencyLog()))
    desk.window.attach(around)
    drag(desk, (0.2, 0.2), (0.4, 0.4))
    desk.do("keydown", "Up")
    frames = around.poll(0.0)
    desk.do("keyup", "Up")
    assert max(len(f.contacts) for f in frames) == 1 and not frames[-1].contacts
    assert (around.poll(1.0) or frames)[-1].lift is not None


@pytest.mark.parametrize("size", [(480, 740), (1040, 330)])
@pytest.mark.parametrize("above", [False, True])
def test_all_of_the_surface_is_seen_in_any_window(
    desk: Desk, size: tuple[int, int], above: bool
) -> None:
    if above:
        desk.do("key", "v")
    glfw.set_window_size(desk.window._context.handle, *size)
    for _ in range(5):
        desk.pump()
    assert screenshot(desk.window).size == size
    for share in [(0, 0), (1, 0), (0, 1), (1, 1)]:
        x, y = desk.at(share)
        assert 0 <= x < size[0] and 0 <= y < size[1], (share, x, y)


def test_on_a_fine_screen_the_window_is_larger_and_touches_are_as_exact(
    display: Screen, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drawing_quality, "SLOW", np.inf)
    environment = {**os.environ, "DISPLAY": display.name}
    glfw.terminate()
    # The server forgets everything when its last guest leaves, so one stays.
    guest = subprocess.Popen(["xprop", "-root", "-spy"], env=environment, stdout=subprocess.DEVNULL)
    change = ["xprop", "-root", "-format", "RESOURCE_MANAGER", "8s", "-set", "RESOURCE_MANAGER"]
    subprocess.run([*change, "Xft.dpi:\t144\n"], env=environment, check=True)
    try:
        desk = Desk(display, viewed(), (640, 420))
        assert screenshot(desk.window).size == (960, 630)
        drag(desk, (0.1, 0.9), (0.9, 0.2))
        frames = desk.touches()
        assert np.allclose(frames[0], np.array([0.1, 0.9]) * desk.v.surface.size, atol=PIXEL)
        assert np.allclose(frames[-2], np.array([0.9, 0.2]) * desk.v.surface.size, atol=PIXEL)
        desk.window.close()
    finally:
        glfw.terminate()
        guest.terminate()
        guest.wait()


class Play:
    """A running `sandbox play` on a screen, with its events."""

    def __init__(self, display: Screen, folder: Path, *options: str) -> None:
        self.display, self.path = display, folder / "events.jsonl"
        self.process = subprocess.Popen(
            [sys.executable, "-m", "sandbox", "play", *options, "--events", str(self.path)],
            cwd=ROOT,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            env={**os.environ, "DISPLAY": display.name, "COLUMNS": "160"},
        )

    def events(self, kind: str) -> list[dict[str, Any]]:
        lines = self.path.read_text().splitlines() if self.path.exists() else []
        return [e for e in map(json.loads, lines) if e["event"] == kind]

    def until(self, truth: Callable[[], object], what: str) -> Any:
        end = time.monotonic() + PATIENCE
        while not (found := truth()):
            alive = self.process.poll() is None
            assert alive and time.monotonic() < end, what if alive else self.process.stdout.read()
            time.sleep(0.02)
        return found

    def key(self, *keys: str) -> None:
        self.display.do(lambda: time.sleep(0.01), "mousemove", 500, 350, "key", *keys)


def test_mouse_and_page_touch_one_scene_and_the_session_says_how_long_touches_took(
    display: Screen, tmp_path: Path
) -> None:
    record = tmp_path / "run.jsonl"
    play = Play(display, tmp_path, "box-to-goal", "--record", str(record), "--max-latency", "1e6")
    try:
        (told,) = play.until(lambda: play.events("listening"), "it says where its page is")
        url: str = told["address"]
        play.until(lambda: play.events("trial_start"), "it begins")
        with Page(url) as page:

            def contacts() -> list[dict[str, Any]]:
                found: list[dict[str, Any]] = page.until("frame")["state"]["hands"][0]["contacts"]
                return found

            def pinned() -> bool:
                play.key("2")
                return any(len(contacts()) == 2 for _ in range(30))

            play.until(pinned, "the mouse's pins are seen on the page")

            def all_three() -> list[dict[str, Any]]:
                # Told again and again: a page that says nothing for a second loses its fingers.
                page.touch((3, 1.0, 1.0))
                return found if len(found := contacts()) == 3 else []

            found = play.until(all_three, "all three are")
            assert len({c["id"] for c in found}) == 3
            page.touch()
            play.until(lambda: len(contacts()) == 2, "the page's finger is lifted, no other")
            page.say(type="ask", what="pause")
            play.until(
                lambda: page.until("frame")["state"]["pause"] == "menu", "the page can pause"
            )
            page.say(type="ask", what="resume")
            page.say(type="ask", what="task", value="stack")
            scene = page.until("scene", task="stack")
            assert scene["task"] == "stack"
        (ended,) = play.until(lambda: play.events("trial_end"), "the trial's end is told")
        assert {"waited", "stepped", "window", "picture"} <= set(ended["latency"])
        play.until(lambda: len(play.events("trial_start")) == 2, "and another begins")

        def closed() -> bool:
            play.key("q")
            return play.process.poll() is not None

        end = time.monotonic() + PATIENCE
        while not closed() and time.monotonic() < end:
            pass
        out, _ = play.process.communicate(timeout=PATIENCE)
        assert play.process.returncode == 0, out
        assert url.rsplit("token=", 1)[1][:10] in out.replace("\n", "")
        assert "touch received to picture in the window" in out and "within the limit" in out
    finally:
        play.process.kill()
        play.process.wait()
    assert record.exists() and record.with_stem("run-2").exists()


def test_fingers_on_the_page_alone_begin_a_trial_and_keep_the_pages_ids(
    display: Screen, tmp_path: Path
) -> None:
    play = Play(display, tmp_path, "box-to-goal")
    try:
        (told,) = play.until(lambda: play.events("listening"), "it says where its page is")
        play.until(lambda: play.events("trial_start"), "it waits")
        with Page(told["address"]) as page:

            def running() -> dict[str, Any] | None:
                page.touch((3, 2.0, 2.0), (4, 3.0, 2.0))
                state: dict[str, Any] = page.until("frame")["state"]
                return state if state["time"] > 0.3 else None

            state = play.until(running, "time begins with the page's fingers")
            assert {contact["id"] for contact in state["hands"][0]["contacts"]} == {3, 4}
    finally:
        play.process.kill()
        play.process.wait()


def test_a_task_that_cannot_be_played_here_is_told_and_the_last_one_comes_back(
    display: Screen, tmp_path: Path
) -> None:
    record = tmp_path / "run.jsonl"
    play = Play(display, tmp_path, "box-to-goal", "--turn", "90", "--record", str(record))
    try:
        (told,) = play.until(lambda: play.events("listening"), "it says where its page is")
        play.until(lambda: play.events("trial_start"), "it begins")
        with Page(told["address"]) as page:
            page.until("scene", task="box-to-goal")
            page.say(type="ask", what="task", value="stack-vertical")
            (warned,) = play.until(lambda: play.events("warning"), "it says why not")
            assert "stack-vertical" in warned["what"]
            play.until(lambda: len(play.events("trial_start")) == 2, "and goes on")
            page.say(type="ask", what="hand", value="left")
            play.until(lambda: len(play.events("trial_start")) == 3, "with another hand, too")
            assert page.until("scene", hand="left")["task"] == "box-to-goal"
    finally:
        play.process.terminate()
        out, _ = play.process.communicate(timeout=PATIENCE)
    assert play.process.returncode == 130, out
    assert [e["task"] for e in play.events("trial_start")] == ["box-to-goal"] * 3
    ends = play.events("trial_end")
    assert [e["settings"]["hands"][0]["side"] for e in ends] == ["right", "right", "left"]
    kept = sorted(path.name for path in tmp_path.glob("run*.jsonl"))
    assert kept == ["run-3.jsonl", "run-4.jsonl", "run.jsonl"]
    assert all(load_recording(tmp_path / name).end for name in kept)


@pytest.mark.parametrize("ends", [signal.SIGTERM, signal.SIGHUP, signal.SIGINT])
def test_the_result_of_a_trial_that_is_over_is_kept_while_its_last_picture_is_shown(
    display: Screen, tmp_path: Path, ends: signal.Signals, as_without_nohup: None
) -> None:
    record = tmp_path / "run.jsonl"
    options = ("box-to-goal", "--device", "simulated", "--seed", "3", "--record", str(record))
    play = Play(display, tmp_path, *options)
    try:
        (ended,) = play.until(lambda: play.events("trial_end"), "its end is told at once")
        assert ended["success"] and play.process.poll() is None
        play.process.send_signal(ends)
        play.process.communicate(timeout=PATIENCE)
    finally:
        play.process.kill()
        play.process.wait()
    assert len(play.events("trial_end")) == 1
    recording = load_recording(record)
    assert not recording.damage and recording.end["result"]["success"]


BROKEN = """
from models.errors import DeviceError
from models.frames import Contact, TouchFrame
from sandbox.devices.device import Device


class Broken(Device):
    def __init__(self, surface, argument) -> None:
        self.polls = 0

    def poll(self, now):
        self.polls += 1
        if self.polls > 20:
            raise DeviceError("the screen was unplugged", where="broken")
        return [TouchFrame(now, (Contact(1, 0.05, 0.05),))]
"""


def test_a_trial_whose_device_fails_ends_the_window_and_says_why(
    display: Screen, tmp_path: Path
) -> None:
    (tmp_path / "broken.py").write_text(BROKEN)
    play = Play(display, tmp_path, "box-to-goal", "--device", f"{tmp_path / 'broken.py'}:Broken")
    try:
        out, _ = play.process.communicate(timeout=PATIENCE)
        assert play.process.returncode == 2, out
        assert "broken: the screen was unplugged" in " ".join(out.split())
    finally:
        play.process.kill()
        play.process.wait()


class Game(Desk):
    """A desk on which time goes on while the window is pumped."""

    def __init__(self, display: Screen, seed: int) -> None:
        self.session, mouse, surface = mouse_session(seed)
        super().__init__(
            display, Viewed(self.session.scene, surface, self.session.snapshot(), None)
        )
        self.mouse = mouse
        self.window.attach(mouse)

    def pump(self) -> None:
        if not self.session.over:
            self.snapshot = advance(self.session, 0.02)
        super().pump()

    def share(self, world: Any) -> tuple[float, float]:
        x, y = self.v.surface.to_surface(np.array(world)) / self.v.surface.size
        return float(x), float(y)


def test_a_box_is_brought_to_its_goal_with_pointer_wheel_and_keys_alone(
    display: Screen, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(drawing_quality, "SLOW", np.inf)
    game = Game(display, seed=2)
    task = game.session.task
    start, goal = game.share(task.objects[0].position), game.share(task.goals[0].position)
    game.do("mousemove", *game.at(start), "key", "3")
    for _ in range(40):
        game.pump()
    for _ in range(8):
        game.do("click", 5)
    game.do("mousedown", 1)
    for along in np.linspace(0.0, 1.0, 25)[1:]:
        x, y = np.array(start) + along * (np.array(goal) - start)
        game.do("mousemove", *game.at((float(x), float(y))))
    game.do("mouseup", 1)
    for _ in range(20):
        game.pump()
    screenshot(game.window).save(tmp_path / "there.png")
    game.do("key", "space")
    while not game.session.over and game.session.time < 30.0:
        game.pump()
    screenshot(game.window).save(tmp_path / "done.png")
    game.window.close()
    score = game.session.scorer.score
    assert score.success, score.reason
