"""The window on a real X server, driven by real pointer and key events."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import glfw
import numpy as np
import pytest
from numpy.typing import NDArray

from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.devices.wrappers.playing import SPEED, LiftKeys
from sandbox.session.messages import Snapshot
from sandbox.trial.assembly import build
from sandbox.trial.settings import Settings
from sandbox.views import window as drawing_quality
from sandbox.views.renderer import Renderer
from sandbox.views.window import Window
from tests.support.processes import printed
from tests.support.screen import Screen, screen
from tests.support.scripted import Script
from tests.support.viewed import Viewed, contact_at, viewed, with_contacts
from tests.support.window_shots import pixel_of, screenshot

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"), reason="needs an X server in memory"
)

PIXEL = 0.0012
"""m on the surface, at most, under one pixel of the windows below."""


@pytest.fixture(scope="module")
def display() -> Iterator[Screen]:
    with screen() as shown:
        yield shown
        glfw.terminate()


class Desk:
    """A window with a mouse and a snapshot to show."""

    def __init__(self, display: Screen, v: Viewed, size: tuple[int, int] = (640, 420)) -> None:
        self.display, self.v = display, v
        self.window = Window(v.scene, v.surface, "test", size)
        self.mouse = MouseDevice(v.surface)
        self.window.attach(self.mouse)
        self.snapshot: Snapshot = v.ghost
        self.alive = True
        self.pump()

    def pump(self) -> None:
        self.alive = self.window.pump(self.snapshot)

    def do(self, *command: str | int | float) -> None:
        self.display.do(self.pump, *command)

    def at(self, share: tuple[float, float]) -> tuple[int, int]:
        """The pixel of a point of the surface, given in shares of its size."""
        x, y = pixel_of(self.window, np.array(share) * self.v.surface.size)
        return round(x), round(y)

    def touches(self) -> list[NDArray[np.float64]]:
        """Contacts of the frames since the last time, (n, 2) m each."""
        return [
            np.array([[c.x, c.y] for c in f.contacts]).reshape(-1, 2) for f in self.mouse.poll(0.0)
        ]


@pytest.fixture(autouse=True)
def never_slow(monkeypatch: pytest.MonkeyPatch) -> None:
    """However slow this machine is, the window is to look the same throughout a test."""
    monkeypatch.setattr(drawing_quality, "SLOW", np.inf)


@pytest.fixture
def desk(display: Screen) -> Iterator[Desk]:
    made = Desk(display, viewed())
    yield made
    made.window.close()


def drag(desk: Desk, start: tuple[float, float], end: tuple[float, float]) -> None:
    desk.do("mousemove", *desk.at(start), "mousedown", 1)
    desk.do("mousemove", *desk.at(end))
    desk.do("mouseup", 1)


SHARES = [(0.5, 0.5), (0.05, 0.05), (0.95, 0.05), (0.05, 0.95), (0.95, 0.95)]


@pytest.mark.parametrize("above", [False, True])
def test_a_drag_touches_the_surface_where_the_pointer_is(desk: Desk, above: bool) -> None:
    if above:
        desk.do("key", "v")
    for start, end in pairwise(SHARES):
        drag(desk, start, end)
        frames = desk.touches()
        assert np.allclose(frames[0], np.array(start) * desk.v.surface.size, atol=PIXEL)
        assert np.allclose(frames[-2], np.array(end) * desk.v.surface.size, atol=PIXEL)
        assert frames[-1].size == 0


def test_that_stays_true_when_the_window_gets_another_size(desk: Desk) -> None:
    glfw.set_window_size(desk.window._context.handle, 900, 500)
    for _ in range(5):
        desk.pump()
    assert screenshot(desk.window).size == (900, 500)
    drag(desk, (0.1, 0.9), (0.9, 0.2))
    frames = desk.touches()
    assert np.allclose(frames[0], np.array([0.1, 0.9]) * desk.v.surface.size, atol=PIXEL)
    assert np.allclose(frames[-2], np.array([0.9, 0.2]) * desk.v.surface.size, atol=PIXEL)


def test_that_stays_true_when_the_view_is_turned(desk: Desk) -> None:
    before = desk.at((0.2, 0.2))
    desk.do("mousemove", 300, 200, "mousedown", 3)
    desk.do("mousemove", 240, 230)
    desk.do("mouseup", 3)
    assert desk.at((0.2, 0.2)) != before and desk.touches() == []
    drag(desk, (0.2, 0.2), (0.7, 0.8))
    frames = desk.touches()
    assert np.allclose(frames[0], np.array([0.2, 0.2]) * desk.v.surface.size, atol=PIXEL)
    assert np.allclose(frames[-2], np.array([0.7, 0.8]) * desk.v.surface.size, atol=PIXEL)


def test_a_click_beside_the_surface_touches_nothing(desk: Desk) -> None:
    desk.do("mousemove", 5, 300, "click", 1)
    assert desk.touches() == []


def test_the_screen_shows_the_screenshot(desk: Desk) -> None:
    for snapshot in (desk.v.solid, desk.v.ghost):
        desk.snapshot = snapshot
        desk.pump()
        shot = np.asarray(screenshot(desk.window), float)
        shown = desk.display.picture()[: shot.shape[0], : shot.shape[1]]
        assert np.abs(shown - shot).max() <= 1.0
        assert shot.std() > 20


def test_the_mark_of_a_touch_is_under_the_pointer_that_made_it(desk: Desk) -> None:
    share = (0.15, 0.85)
    desk.do("mousemove", *desk.at(share), "mousedown", 1)
    (touch,) = desk.touches()[0]
    empty = with_contacts(desk.v.ghost)
    place = desk.v.surface.to_world(touch)
    pictures = []
    for snapshot in (
        empty,
        with_contacts(empty, contact_at(desk.v.surface, 0, place, None, "active")),
    ):
        desk.snapshot = snapshot
        desk.pump()
        pictures.append(desk.display.picture())
    desk.do("mouseup", 1)
    rows, columns = np.nonzero(np.abs(pictures[1] - pictures[0]).max(axis=-1) > 12)
    x, y = desk.at(share)
    mark = np.hypot(columns - x, rows - y) < 14
    assert mark.sum() > 20
    assert abs(columns[mark].mean() - x) < 2.5 and abs(rows[mark].mean() - y) < 2.5


def test_keys_put_down_a_hand_around_the_pointer_and_space_lifts_it(desk: Desk) -> None:
    desk.do("mousemove", *desk.at((0.5, 0.5)), "key", "3")
    frame = desk.mouse.poll(0.0)[-1]
    assert [c.label for c in frame.contacts] == [0, 1, 2]
    xy = np.array([[c.x, c.y] for c in frame.contacts])
    middle = (xy[0] + xy[1:].mean(axis=0)) / 2
    assert np.allclose(middle, desk.v.surface.size / 2, atol=PIXEL)
    desk.do("key", "space")
    assert desk.touches()[-1].size == 0


def test_keys_lift_the_hand_where_the_task_lets_them(desk: Desk) -> None:
    keys = LiftKeys(desk.mouse)
    desk.window.attach(keys)
    desk.do("mousemove", *desk.at((0.5, 0.5)), "key", "2")
    placed = keys.poll(0.0)[-1]
    assert len(placed.contacts) == 2 and placed.lift == 0.0
    desk.do("keydown", "Up")
    lifted = keys.poll(1.0)[-1]
    assert lifted.lift == pytest.approx(SPEED) and lifted.contacts == placed.contacts
    desk.do("keyup", "Up")
    assert keys.poll(2.0) == []
    desk.do("keydown", "Down")
    assert keys.poll(10.0)[-1].lift == 0.0
    desk.do("keyup", "Down")


def test_shift_pins_control_moves_together_and_the_wheel_opens(desk: Desk) -> None:
    for share in ((0.3, 0.4), (0.6, 0.6)):
        desk.do("mousemove", *desk.at(share), "keydown", "shift", "click", 1, "keyup", "shift")
    before = desk.touches()[-1]
    assert len(before) == 2
    desk.do("mousemove", *desk.at((0.8, 0.2)), "keydown", "ctrl", "mousedown", 1)
    desk.do("mousemove", *desk.at((0.85, 0.2)))
    desk.do("mouseup", 1, "keyup", "ctrl")
    moved = desk.touches()[-1]
    assert np.allclose(moved - before, [0.05 * desk.v.surface.size[0], 0.0], atol=2 * PIXEL)
    desk.do("click", 4)
    opened = desk.touches()[-1]
    assert np.linalg.norm(opened[1] - opened[0]) > np.linalg.norm(moved[1] - moved[0])
    desk.do("click", 5)
    assert np.allclose(desk.touches()[-1], moved, atol=1e-9)
    desk.do("keydown", "shift", "click", 4, "keyup", "shift")
    turned = desk.touches()[-1]
    assert np.linalg.norm(turned[1] - turned[0]) == pytest.approx(
        np.linalg.norm(moved[1] - moved[0])
    )
    assert not np.allclose(turned, moved, atol=1e-4)


def test_pause_reset_contact_and_help_are_asked_for_with_keys(desk: Desk) -> None:
    assert not desk.window.paused and not desk.window.take_reset()
    plain = np.asarray(screenshot(desk.window), float)
    desk.do("key", "p")
    assert desk.window.paused
    desk.do("key", "p", "key", "r")
    assert not desk.window.paused
    assert desk.window.take_reset() and not desk.window.take_reset()
    assert not desk.window.take_contact()
    desk.do("key", "c")
    assert desk.window.take_contact() and not desk.window.take_contact()
    desk.do("key", "h")
    helped = np.asarray(screenshot(desk.window), float)
    assert (np.abs(helped - plain).max(axis=-1) > 12).sum() > 5000
    desk.do("key", "h")
    assert np.array_equal(np.asarray(screenshot(desk.window), float), plain)


def test_without_a_mouse_device_clicks_and_keys_do_no_harm(display: Screen) -> None:
    desk = Desk(display, viewed())
    desk.window.attach(Script())
    desk.do("mousemove", *desk.at((0.5, 0.5)), "click", 1, "key", "3", "key", "space", "click", 4)
    assert desk.touches() == [] and desk.alive
    desk.window.close()


def test_a_touch_ends_when_the_window_loses_the_keys_or_is_closed(desk: Desk) -> None:
    desk.do("mousemove", *desk.at((0.5, 0.5)), "mousedown", 1)
    assert desk.touches()[-1].size == 2
    glfw.set_window_should_close(desk.window._context.handle, True)
    desk.pump()
    assert not desk.alive and desk.touches()[-1].size == 0
    desk.pump()
    assert not desk.alive
    desk.window.close()
    desk.display.do(lambda: None, "mouseup", 1)


def test_what_goes_wrong_in_a_gesture_is_raised_by_the_loop_and_not_swallowed(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken(*_: object) -> None:
        raise ValueError("broken on purpose")

    monkeypatch.setattr(desk.mouse, "lift_fingers", broken)
    with pytest.raises(ValueError, match="on purpose"):
        desk.do("key", "space")


def test_a_window_without_a_snapshot_is_empty_and_alive(display: Screen) -> None:
    v = viewed()
    with Window(v.scene, v.surface, size=(480, 320)) as waiting:
        assert waiting.pump(None)
        assert len(screenshot(waiting).getcolors()) == 1
        assert waiting.pump(v.solid)
        assert screenshot(waiting).getcolors() is None


def test_on_a_slow_machine_the_window_draws_less_and_stays_as_exact(
    desk: Desk, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drawing_quality, "SLOW", 0.0)
    rich = np.asarray(screenshot(desk.window), float)
    for i in range(1, 12):
        desk.snapshot = replace(desk.v.ghost, time=desk.v.ghost.time + 0.001 * i)
        desk.pump()
    desk.snapshot = desk.v.ghost
    desk.pump()
    plain = np.asarray(screenshot(desk.window), float)
    assert plain.shape == rich.shape and np.abs(plain - rich).mean() > 1.0
    drag(desk, (0.1, 0.1), (0.9, 0.9))
    assert np.allclose(desk.touches()[0], 0.1 * desk.v.surface.size, atol=PIXEL)


def test_a_film_is_drawn_beside_an_open_window_and_both_are_right(desk: Desk) -> None:
    v = desk.v
    desk.snapshot = v.solid
    desk.pump()
    shot = screenshot(desk.window)
    with Renderer(v.scene, v.surface, (320, 180)) as renderer:
        first = np.asarray(renderer.frame(v.solid))
        desk.snapshot = v.ghost
        desk.pump()
        desk.snapshot = v.solid
        desk.pump()
        assert np.array_equal(np.asarray(renderer.frame(v.solid)), first)
    assert first.std() > 20
    assert np.array_equal(np.asarray(screenshot(desk.window)), np.asarray(shot))


def test_without_a_screen_one_error_says_so() -> None:
    code = (
        "from tests.support.viewed import viewed\n"
        "from sandbox.views.window import Window\n"
        "from sandbox.views.display import GraphicsError\n"
        "v = viewed()\n"
        "try:\n"
        "    Window(v.scene, v.surface)\n"
        "except GraphicsError as error:\n"
        "    print(error)\n"
    )
    told = printed("-W", "error", "-c", code, DISPLAY=None, WAYLAND_DISPLAY=None)
    assert "no window can be opened" in told and "screen" in told


def test_from_above_another_table_is_seen_from_the_front_and_a_key_looks_down_again(
    display: Screen, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(drawing_quality, "SLOW", np.inf)
    desk = Desk(display, viewed())
    try:
        desk.do("key", "v")
        assert desk.window._renderer.camera.orthographic
        wall = build(Settings(task="stack-vertical"), (lambda task, surface: MouseDevice(surface),))
        desk.window.show_scene(wall.scene, wall.whole_surface, "another table")
        desk.snapshot = wall.snapshot()
        desk.pump()
        assert not desk.window._renderer.camera.orthographic
        desk.do("key", "v")
        assert desk.window._renderer.camera.orthographic
    finally:
        desk.window.close()
