"""The window, which shows the current scene and turns mouse and keys into touches.

It belongs to the main thread.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial
from math import sqrt
from typing import Any

import glfw
import numpy as np
from PIL import Image

from models.arithmetic import Array
from models.scene import Scene
from models.surface import Surface
from sandbox.devices.device import AnyDevice, Closeable
from sandbox.devices.mouse.mouse import MouseDevice
from sandbox.devices.wrappers.playing import LiftKeys
from sandbox.session.messages import Snapshot
from sandbox.views import palette
from sandbox.views.cameras import camera_above, window_camera
from sandbox.views.overlay import OverlayTexts
from sandbox.views.renderer import LARGEST, Renderer
from sandbox.views.window_context import BorrowedContext, WindowContext

HINT = ("h or ?  keys",)
MOUSE_HELP = (
    "drag  one finger",
    "shift + click  pin a finger, or lift it",
    "drag a pin  moves it",
    "1 to 5  a hand with this number of fingers",
    "drag beside it  moves the hand",
    "ctrl + drag  moves all pins",
    "wheel  open and close",
    "shift + wheel  turn",
    "space  lift all fingers",
)
HELP = (
    "right drag  turns the camera",
    "v  view from above, and back",
    "c  contact: hard, soft, none",
    "p  pause",
    "s  slow motion: half, a quarter, a tenth",
    "r  start again",
    "q  close",
    "h or ?  hide this",
)

LEAP = 62
"""Number of control periods by which the arrow keys move playback: a second."""

REPLAY_HELP = (
    "p  pause, continue",
    "left, right  a second back, forwards",
    "comma, period  a step back, forwards",
    "s  slow motion: half, a quarter, a tenth",
    "r  from the beginning",
    "right drag  turns the camera",
    "v  view from above, and back",
    "q  close",
    "h  hide this",
)

LIFT_HELP = ("up, down  lift and lower the hand",)


def keys(mouse: bool, lift: bool) -> tuple[str, ...]:
    """Returns the help texts of all keys that have an effect, one line each.

    Args:
        mouse: True if the mouse acts as fingers.
        lift: True if keys control the lift.
    """
    return (*(LIFT_HELP if lift else ()), *(MOUSE_HELP if mouse else ()), *HELP)


MOST_PIXELS = 2_600_000
"""Largest number of drawn pixels; in a larger window the picture is stretched. Above this number,
copying a picture takes longer than drawing it."""
SLOW, PATIENCE = 0.045, 4
"""The quality is reduced after `PATIENCE` consecutive pictures that take longer than `SLOW`, s."""
PLAIN_SHRINK = 1.6
"""At reduced quality, factor by which the drawing is smaller than the window."""


class DrawingQuality:
    """Chooses the drawing quality from the time that pictures take."""

    def __init__(self) -> None:
        self._slow, self._shrink = 0, 1.0

    def size(self, width: int, height: int) -> tuple[int, int]:
        """Returns the size (px) of the picture to draw for a window of a given size, px."""
        width, height = max(width, 16), max(height, 16)
        shrink = max(
            sqrt(width * height / MOST_PIXELS), width / LARGEST, height / LARGEST, self._shrink
        )
        return max(round(width / shrink), 16), max(round(height / shrink), 16)

    def took(self, seconds: float, renderer: Renderer) -> None:
        """Processes the duration of a picture.

        Slow pictures first disable shadows, then reduce the number of pixels. Text stays sharp, as
        it is drawn over the stretched picture.
        """
        self._slow = self._slow + 1 if seconds > SLOW else 0
        if self._slow < PATIENCE:
            return
        self._slow = 0
        if renderer.shadows:
            renderer.shadows = False
        else:
            self._shrink = PLAIN_SHRINK


SIZE = (1024, 680)
"""Size (px in the screen's coordinates) of a new window."""
RATE = 60.0
"""Largest number of pictures per second."""
LIFT = {glfw.KEY_UP: 1.0, glfw.KEY_DOWN: -1.0}
MOVES = {glfw.KEY_LEFT: -LEAP, glfw.KEY_RIGHT: LEAP, glfw.KEY_COMMA: -1, glfw.KEY_PERIOD: 1}
"""Key -> number of control periods by which it moves playback."""

SPEEDS = {1.0: "", 0.5: "slow motion 1/2", 0.25: "slow motion 1/4", 0.1: "slow motion 1/10"}
"""Speed (simulated seconds per second) -> banner, in the order in which the key selects them."""


class Window(Closeable):
    """Draws the newest snapshot, and turns mouse and keys into touches.

    Args:
        scene: The scene to draw, which is copied.
        surface: The touch surface; the pointer touches the point that it covers.
        title: Title of the window.
        size: px in the screen's coordinates.
        caption: Text that names player and task; it must name a simulated user as such.
        in_air: True if hands are tracked in the air, not on a surface.

    Raises:
        GraphicsError: No window can be opened here.

    Attributes:
        paused: True during a pause by the person.
        speed: Requested speed in simulated seconds per second, one of `SPEEDS`.
        footer: Lines at the bottom right.
        goal: The goal, which is always shown; empty shows the hand's state instead.
        hint: Instructions, line by line.
        help: Help on the keys; None shows the help for trials.
        link: Link that is shown as a QR code; empty shows none.
        pictures: Number of pictures drawn so far.
        picture_time: Time that drawing the last picture took, s.
        seen: The snapshot on the screen; None before the first.
    """

    def __init__(
        self,
        scene: Scene,
        surface: Surface,
        title: str = "Hand Sandbox",
        size: tuple[int, int] = SIZE,
        caption: str = "",
        in_air: bool = False,
    ) -> None:
        self.paused, self.speed = False, 1.0
        self.footer: tuple[str, ...] = ()
        self.goal = ""
        self.hint: tuple[str, ...] = ()
        self.help: tuple[str, ...] | None = None
        self.link = ""
        self.pictures, self.picture_time = 0, 0.0
        self.seen: Snapshot | None = None
        self._surface = self._touched = surface
        self._mouse: MouseDevice | None = None
        self._lift: LiftKeys | None = None
        self._touching = self._looking = False
        self._reset = self._help = self._above = self._contact = False
        self._moves = 0
        self._shown: object = None
        self._picture: Image.Image | None = None
        self._snapshot: Snapshot | None = None
        self._quality = DrawingQuality()
        self._due = 0.0
        self._cursor = np.zeros(2)
        self._failure: BaseException | None = None
        self._context = WindowContext(title, size)
        self._renderer: Renderer | None = None
        try:
            self.show_scene(scene, surface, title, caption, in_air)
        except BaseException:
            self._context.free()
            raise
        self._listen()

    def show_scene(
        self,
        scene: Scene,
        surface: Surface,
        title: str,
        caption: str = "",
        in_air: bool = False,
    ) -> None:
        """Shows another scene in the same window, such as the next trial.

        Args:
            scene: The scene to draw, which is copied.
            surface: The scene's touch surface.
            title: Title of the window.
            caption: Text that names player and task.
            in_air: True if hands are in the air.
        """
        self._release()
        before, self._renderer = self._renderer, None
        self._in_air = in_air
        camera = window_camera(surface, in_air)
        if before is not None:
            if before.camera is not None and _same(surface, self._surface):
                # Continue with the camera that the person may have turned.
                camera = before.camera
            else:
                self._above = False
            before.close()
        self._surface, self._touched, self._caption = surface, surface, caption
        self._mouse = self._lift = self._snapshot = self.seen = self._shown = None
        self.paused = self._reset = self._contact = False
        glfw.set_window_title(self._context.handle, title)
        self._renderer = Renderer(
            scene,
            surface,
            self._drawn_size(),
            camera=camera,
            context=BorrowedContext(self._context),
            rings_on_table=False,
            samples=0,
        )
        if before is not None:
            self._renderer.shadows = before.shadows

    def attach(self, *devices: AnyDevice) -> None:
        """Connects mouse and keys to the first `MouseDevice` and `LiftKeys` among the devices."""
        self._lift = next(filter(None, (device.find(LiftKeys) for device in devices)), None)
        self._mouse = next(filter(None, (device.find(MouseDevice) for device in devices)), None)
        self._touched = self._mouse.surface if self._mouse else self._surface

    def pump(self, snapshot: Snapshot | None) -> bool:
        """Processes input and draws; returns False once the window is closed.

        It returns at most `RATE` times per second, so that a loop around it does not spin.
        """
        if self._renderer is None:
            return False
        glfw.poll_events()
        while (left := self._due - time.monotonic()) > 0.0:
            # Pass events to the session at once; only the next picture waits.
            glfw.wait_events_timeout(left)
        self._due = time.monotonic() + 1.0 / RATE
        if self._failure is not None:
            failure, self._failure = self._failure, None
            raise failure
        if glfw.window_should_close(self._context.handle):
            self.close()
            return False
        if snapshot is not None:
            self._snapshot = snapshot
        if min(glfw.get_framebuffer_size(self._context.handle)) > 0:
            self._show()
        return True

    def take_reset(self) -> bool:
        """Returns True if the person has requested a restart; each request is returned once."""
        asked, self._reset = self._reset, False
        return asked

    def take_contact(self) -> bool:
        """True if the person has requested the next contact mode; each request is returned once."""
        asked, self._contact = self._contact, False
        return asked

    def take_moves(self) -> int:
        """Returns the number of control periods to move forwards (back if below 0); each request
        once."""
        moves, self._moves = self._moves, 0
        return moves

    def close(self) -> None:
        """Closes the window; may be called twice."""
        if self._renderer is not None:
            self._release()
            renderer, self._renderer = self._renderer, None
            renderer.close()
            self._context.free()

    def _show(self) -> None:
        """Draws a picture, unless it would be the same as the last."""
        renderer = self._renderer
        assert renderer is not None
        size, window = self._drawn_size(), glfw.get_framebuffer_size(self._context.handle)
        renderer.words = OverlayTexts(
            self._caption,
            self._keys() if self._help else HINT,
            "paused" if self.paused else SPEEDS[self.speed] or self._contact_word(),
            self.footer,
            self.link,
            self.goal,
            self.hint,
        )
        camera = renderer.camera
        view = (camera.azimuth, camera.elevation, camera.distance) if camera else None
        wanted = (id(self._snapshot), size, window, renderer.words, view, renderer.shadows)
        if wanted == self._shown:
            return
        self._shown = wanted
        begun = time.monotonic()
        if self._snapshot is None:
            self._picture = self._blank(window)
        else:
            renderer.resize(size)
            renderer.see_through = self._above or self._surface.upright
            self._picture = renderer.frame(self._snapshot, stretched=window)
        renderer.put_on_screen(self._picture)
        self._context.swap()
        self.pictures, self.picture_time = self.pictures + 1, time.monotonic() - begun
        self.seen = self._snapshot
        self._quality.took(self.picture_time, renderer)

    def _keys(self) -> tuple[str, ...]:
        """Returns the current help on the keys."""
        return self.help or keys(self._mouse is not None, self._lift is not None)

    def _contact_word(self) -> str:
        """Returns the name of the contact mode; empty for the default."""
        mode = self._snapshot.contact if self._snapshot else "hard"
        return "" if mode == "hard" else f"contact: {mode}"

    def _blank(self, size: tuple[int, int]) -> Image.Image:
        return Image.new("RGB", size, palette.bytes_of(palette.PANEL)[:3])

    def _drawn_size(self) -> tuple[int, int]:
        return self._quality.size(*glfw.get_framebuffer_size(self._context.handle))

    def _pick(self, x: float, y: float) -> Array | None:
        """Returns the surface point (2,) m under a window position; None if there is none."""
        lens = self._renderer.lens if self._renderer else None
        if lens is None:
            return None
        share = np.array([x, y]) / np.maximum(glfw.get_window_size(self._context.handle), 1)
        return lens.pick(share * np.array(lens.size), self._touched)

    def _listen(self) -> None:
        """Registers the callbacks of glfw.

        glfw only prints errors in callbacks, so they are stored and raised by `pump`.
        """
        handle = self._context.handle
        for register, react in (
            (glfw.set_mouse_button_callback, self._on_button),
            (glfw.set_cursor_pos_callback, self._on_move),
            (glfw.set_scroll_callback, self._on_wheel),
            (glfw.set_key_callback, self._on_key),
            (glfw.set_window_focus_callback, self._on_focus),
        ):
            register(handle, partial(self._guarded, react))
        glfw.set_window_refresh_callback(handle, self._on_refresh)

    def _guarded(self, react: Callable[..., None], _handle: Any, *details: Any) -> None:
        try:
            react(*details)
        except Exception as error:
            self._failure = error

    def _on_refresh(self, _handle: Any) -> None:
        self._shown = None

    def _on_button(self, button: int, action: int, mods: int) -> None:
        if button == glfw.MOUSE_BUTTON_RIGHT:
            self._looking = action == glfw.PRESS
        if button != glfw.MOUSE_BUTTON_LEFT or self._mouse is None:
            return
        if action == glfw.RELEASE:
            self._release()
            return
        place = self._pick(*glfw.get_cursor_pos(self._context.handle))
        if place is not None:
            self._touching = True
            self._mouse.press(
                place,
                pin=bool(mods & glfw.MOD_SHIFT),
                together=bool(mods & glfw.MOD_CONTROL),
            )

    def _on_move(self, x: float, y: float) -> None:
        step, self._cursor = np.array([x, y]) - self._cursor, np.array([x, y])
        if self._looking and self._renderer is not None:
            right, down = step / max(glfw.get_window_size(self._context.handle)[1], 1)
            self._renderer.turn(float(right), float(down))
        if self._touching and self._mouse is not None:
            place = self._pick(x, y)
            if place is not None:
                self._mouse.move(place)

    def _on_wheel(self, sideways: float, steps: float) -> None:
        if self._mouse is not None:
            # With shift, some systems report horizontal scrolling instead.
            self._mouse.wheel(steps or sideways, turn=self._down(glfw.KEY_LEFT_SHIFT))

    def _on_key(self, key: int, _code: int, action: int, mods: int) -> None:
        if self._lift is not None and key in LIFT:
            self._lift.hold(LIFT[key] if action != glfw.RELEASE else 0.0)
            return
        if key in MOVES and action != glfw.RELEASE:
            self._moves += MOVES[key]
        if action != glfw.PRESS:
            return
        if self._mouse is not None and glfw.KEY_1 <= key <= glfw.KEY_5:
            place = self._pick(*glfw.get_cursor_pos(self._context.handle))
            self._mouse.hand(key - glfw.KEY_0, self._touched.size / 2 if place is None else place)
        elif self._mouse is not None and key == glfw.KEY_SPACE:
            self._mouse.lift_fingers()
        elif key == glfw.KEY_H or (key == glfw.KEY_SLASH and mods & glfw.MOD_SHIFT):
            self._help = not self._help
        elif key == glfw.KEY_P:
            self.paused = not self.paused
        elif key == glfw.KEY_Q:
            glfw.set_window_should_close(self._context.handle, True)
        elif key == glfw.KEY_S:
            order = list(SPEEDS)
            self.speed = order[(order.index(self.speed) + 1) % len(order)]
        elif key == glfw.KEY_R:
            self._reset = True
        elif key == glfw.KEY_C:
            self._contact = True
        elif key == glfw.KEY_V and self._renderer is not None:
            self._above = not self._above
            self._renderer.camera = (
                camera_above(self._surface)
                if self._above
                else window_camera(self._surface, self._in_air)
            )

    def _on_focus(self, focused: int) -> None:
        if not focused:
            # If a button is released over another window, this window is not notified.
            self._looking = False
            self._release()
            if self._lift is not None:
                self._lift.hold(0.0)

    def _release(self) -> None:
        if self._touching and self._mouse is not None:
            self._mouse.release()
        self._touching = False

    def _down(self, *keys: int) -> bool:
        return any(glfw.get_key(self._context.handle, k) == glfw.PRESS for k in keys)


def _same(one: Surface, other: Surface) -> bool:
    """True if two surfaces have the same size and position."""
    return all(
        np.allclose(a, b)
        for a, b in (
            (one.size, other.size),
            (one.origin, other.origin),
            (one.rotation, other.rotation),
        )
    )
