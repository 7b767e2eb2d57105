"""The window: the scene as it is now, and the mouse as fingers. Belongs to the main thread."""

from __future__ import annotations

import atexit
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from types import TracebackType
from typing import Any, cast

import glfw
import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image

from models.errors import HandSandboxError
from models.scene import Scene
from models.surface import Surface
from sandbox.devices.device import Device
from sandbox.devices.lift_keys import LiftKeys
from sandbox.devices.mouse import MouseDevice
from sandbox.messages import Snapshot
from sandbox.views import palette
from sandbox.views.cameras import camera_above, window_camera
from sandbox.views.errors import DEBIAN_PACKAGES, GraphicsError
from sandbox.views.keys import HINT, keys
from sandbox.views.overlay import Words
from sandbox.views.renderer import LARGEST, Renderer

Array = NDArray[np.float64]

SIZE = (1024, 680)
"""px (of the screen's own coordinates), of a new window."""
SMALLEST = (480, 320)
MOST_PIXELS = 2_600_000
"""px that are drawn; a larger window's picture is stretched. Beyond, reading and writing pictures
takes longer than drawing them."""

RATE = 60.0
"""Pictures per second at most."""
SLOW, PATIENCE = 0.045, 4
"""s for a picture, and how many slower ones in a row make the window draw more plainly."""
PLAIN_SHRINK = 1.6
"""Drawn smaller by this where there is no graphics card, and stretched."""

LIFT = {glfw.KEY_UP: 1.0, glfw.KEY_DOWN: -1.0}


class Window:
    """Draws the newest snapshot, and turns mouse and keys into touches.

    Args:
        scene: What is drawn; it is copied, not used.
        surface: Where the touches are; the pointer touches the point of it that it covers.
        title: Of the window.
        size: px in the screen's coordinates.
        caption: Who plays what; a window that shows a simulated user has to say so here.

    Raises:
        GraphicsError: No window can be opened here.

    Attributes:
        paused: The person wants simulated time to stand still.
    """

    def __init__(
        self,
        scene: Scene,
        surface: Surface,
        title: str = "Hand Sandbox",
        size: tuple[int, int] = SIZE,
        caption: str = "",
    ) -> None:
        self.paused = False
        self._surface = surface
        self._caption = caption
        self._mouse: MouseDevice | None = None
        self._lift: LiftKeys | None = None
        self._touching = self._looking = False
        self._reset = self._help = self._above = self._contact = False
        self._shown: object = None
        self._picture: Image.Image | None = None
        self._snapshot: Snapshot | None = None
        self._slow = 0
        self._shrink = 1.0
        self._due = 0.0
        self._cursor = np.zeros(2)
        self._failure: BaseException | None = None
        self._context = _WindowContext(title, size)
        self._renderer: Renderer | None = Renderer(
            scene,
            surface,
            self._drawn_size(),
            camera=window_camera(surface),
            context=self._context,
            rings_on_table=False,
            samples=0,
        )
        self._listen()

    def attach(self, device: Device) -> None:
        """Lets mouse and keys drive a device, as far as it is one that they can drive."""
        self._lift = device if isinstance(device, LiftKeys) else None
        device = self._lift.device if self._lift else device
        self._mouse = device if isinstance(device, MouseDevice) else None

    def pump(self, snapshot: Snapshot | None) -> bool:
        """Takes in what the person did, and draws; False once the window is closed.

        Returns at the screen's rate at most, so that a loop around it does not spin.
        """
        if self._renderer is None:
            return False
        glfw.poll_events()
        while (left := self._due - time.monotonic()) > 0.0:
            # Events go to the session at once; only the next picture waits.
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
        """Whether the person wants to start again; asked once, told once."""
        asked, self._reset = self._reset, False
        return asked

    def take_contact(self) -> bool:
        """Whether the person wants the next contact mode; asked once, told once."""
        asked, self._contact = self._contact, False
        return asked

    def screenshot(self) -> Image.Image:
        """The picture that the window shows now, RGB."""
        if self._picture is None:
            return self._blank(glfw.get_framebuffer_size(self._context.handle))
        return self._picture.copy()

    def pixel_of(self, xy: ArrayLike) -> tuple[float, float]:
        """Where in the window, in screen coordinates, a surface point (2,) in metres is seen.

        Raises:
            HandSandboxError: Nothing has been drawn yet.
        """
        lens = self._renderer.lens if self._renderer else None
        if lens is None:
            raise HandSandboxError("the window has drawn nothing yet", remedy="Call pump first")
        pixel, _ = lens.project(self._surface.to_world(xy))
        x, y = pixel / np.array(lens.size) * glfw.get_window_size(self._context.handle)
        return float(x), float(y)

    def close(self) -> None:
        """Closes the window; may be called twice."""
        if self._renderer is not None:
            self._release()
            renderer, self._renderer = self._renderer, None
            renderer.close()

    def _show(self) -> None:
        """Draws, unless it would be the same picture again."""
        renderer = self._renderer
        assert renderer is not None
        size, window = self._drawn_size(), glfw.get_framebuffer_size(self._context.handle)
        renderer.words = Words(
            self._caption,
            keys(lift=self._lift is not None) if self._help else HINT,
            "paused" if self.paused else self._contact_word(),
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
        self._slow = self._slow + 1 if time.monotonic() - begun > SLOW else 0
        if self._slow >= PATIENCE:
            self._draw_more_plainly()

    def _contact_word(self) -> str:
        """How things touch, where that is not as usual."""
        mode = self._snapshot.contact if self._snapshot else "hard"
        return "" if mode == "hard" else f"contact: {mode}"

    def _draw_more_plainly(self) -> None:
        """Without a graphics card: first no shadows, then fewer pixels. Text stays sharp."""
        self._slow = 0
        if self._renderer is not None and self._renderer.shadows:
            self._renderer.shadows = False
        else:
            self._shrink = PLAIN_SHRINK

    def _blank(self, size: tuple[int, int]) -> Image.Image:
        return Image.new("RGB", size, palette.bytes_of(palette.PANEL)[:3])

    def _drawn_size(self) -> tuple[int, int]:
        """px of the picture: the window's own, less where that would be too many."""
        width, height = (max(n, 16) for n in glfw.get_framebuffer_size(self._context.handle))
        shrink = max(
            np.sqrt(width * height / MOST_PIXELS), width / LARGEST, height / LARGEST, self._shrink
        )
        return max(round(width / shrink), 16), max(round(height / shrink), 16)

    def _pick(self, x: float, y: float) -> Array | None:
        """The surface point (2,) under a place in the window, metres; None where there is none."""
        lens = self._renderer.lens if self._renderer else None
        if lens is None:
            return None
        share = np.array([x, y]) / np.maximum(glfw.get_window_size(self._context.handle), 1)
        return lens.pick(share * np.array(lens.size), self._surface)

    def _listen(self) -> None:
        """Has glfw call us; it would print and forget what goes wrong in there, `pump` tells."""
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
            # With shift, some systems turn the wheel sideways.
            self._mouse.wheel(steps or sideways, turn=self._down(glfw.KEY_LEFT_SHIFT))

    def _on_key(self, key: int, _code: int, action: int, _mods: int) -> None:
        if self._lift is not None and key in LIFT:
            self._lift.hold(LIFT[key] if action != glfw.RELEASE else 0.0)
            return
        if action != glfw.PRESS:
            return
        if self._mouse is not None and glfw.KEY_1 <= key <= glfw.KEY_5:
            place = self._pick(*glfw.get_cursor_pos(self._context.handle))
            self._mouse.hand(key - glfw.KEY_0, self._surface.size / 2 if place is None else place)
        elif self._mouse is not None and key == glfw.KEY_SPACE:
            self._mouse.lift()
        elif key == glfw.KEY_H:
            self._help = not self._help
        elif key == glfw.KEY_P:
            self.paused = not self.paused
        elif key == glfw.KEY_R:
            self._reset = True
        elif key == glfw.KEY_C:
            self._contact = True
        elif key == glfw.KEY_V and self._renderer is not None:
            self._above = not self._above
            choose = camera_above if self._above else window_camera
            self._renderer.camera = choose(self._surface)

    def _on_focus(self, focused: int) -> None:
        if not focused:
            # A button's release that goes to another window is never heard of here.
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

    def __enter__(self) -> Window:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()


class _WindowContext:
    """A visible window with its OpenGL context."""

    backend: str | None = None

    def __init__(self, title: str, size: tuple[int, int]) -> None:
        said: list[str] = []
        glfw.set_error_callback(lambda _code, text: said.append(str(text)))
        if not glfw.init():
            raise GraphicsError(
                "no window can be opened, since there is no screen",
                got="; ".join(said) or None,
                remedy="`sandbox run` needs none; on a machine without a screen, try xvfb-run",
            )
        # At the very end: other windows of this process would close with the first one.
        atexit.register(glfw.terminate)
        glfw.default_window_hints()
        glfw.window_hint(glfw.SCALE_TO_MONITOR, glfw.TRUE)
        # Pictures are made in memory and laid into the window as they are.
        glfw.window_hint(glfw.SAMPLES, 0)
        handle = glfw.create_window(*size, title, None, None)
        if not handle:
            raise GraphicsError(
                "no window can be opened, since this screen has no OpenGL",
                got="; ".join(said) or None,
                remedy=f"On Debian or Ubuntu: apt-get install {DEBIAN_PACKAGES}",
            )
        glfw.set_window_size_limits(handle, *SMALLEST, glfw.DONT_CARE, glfw.DONT_CARE)
        glfw.set_cursor(handle, glfw.create_standard_cursor(glfw.CROSSHAIR_CURSOR))
        self.handle: Any = handle
        with self.as_current():
            # The loop is paced by its own clock: waiting for the screen as well only adds delay.
            glfw.swap_interval(0)

    @contextmanager
    def as_current(self) -> Iterator[None]:
        glfw.make_context_current(self.handle)
        try:
            yield
        finally:
            glfw.make_context_current(cast(Any, None))

    def swap(self) -> None:
        """Shows what was drawn."""
        with self.as_current():
            glfw.swap_buffers(self.handle)

    def free(self) -> None:
        if self.handle is not None:
            glfw.destroy_window(self.handle)
            self.handle = None
