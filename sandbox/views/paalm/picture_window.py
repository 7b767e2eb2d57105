"""Window for PAALM's pictures. Use it only in the main thread."""

from __future__ import annotations

import time
from collections.abc import Sequence
from typing import Any

import glfw
from PIL import Image

from encoders.paalm.joint_angles import PaalmFrame
from models.frames import HandFrame
from sandbox.devices.device import Closeable
from sandbox.views.paalm.picture import SIZE, PaalmPicture
from sandbox.views.renderer import LARGEST
from sandbox.views.window_context import WindowContext

RATE = 30.0
"""Largest number of pictures per second; a device sends up to 290 frames per second."""


class PaalmWindow(Closeable):
    """Shows the newest frame; dragging turns the hand, Esc closes.

    Args:
        sides: Sides of the hands.
        caption: Source of the frames; it must identify a simulated hand as simulated.
        size: px in the screen's coordinates.

    Raises:
        GraphicsError: No window can be opened here.

    Attributes:
        picture: The last picture; None before the first.
    """

    def __init__(
        self, sides: Sequence[str], caption: str = "", size: tuple[int, int] = SIZE
    ) -> None:
        self.picture: Image.Image | None = None
        self._context = WindowContext("PAALM - Hand Sandbox", size)
        try:
            self._drawn = PaalmPicture(sides, self._pixels(), self._context, caption)
        except BaseException:
            self._context.free()
            raise
        self._due = 0.0
        self._dragged: tuple[float, float] | None = None

    def show(self, frame: HandFrame, result: PaalmFrame) -> bool:
        """Draws a frame, at most `RATE` times per second; False once the window should close."""
        now = time.monotonic()
        if now < self._due:
            return True
        self._due = now + 1.0 / RATE
        handle: Any = self._context.handle
        size = self._pixels()
        if size != self._drawn.size:
            self._drawn.resize(size)
        self._turn(handle)
        self.picture = self._drawn.draw(frame, result)
        self._drawn.put_on_screen(self.picture)
        self._context.swap()
        return self.rest()

    def rest(self) -> bool:
        """Processes input; False once the window should close."""
        glfw.poll_events()
        handle: Any = self._context.handle
        escape = glfw.get_key(handle, glfw.KEY_ESCAPE) == glfw.PRESS
        return not (glfw.window_should_close(handle) or escape)

    def close(self) -> None:
        """Closes the window; may be called twice."""
        self._drawn.close()
        self._context.free()

    def _turn(self, handle: Any) -> None:
        if glfw.get_mouse_button(handle, glfw.MOUSE_BUTTON_LEFT) != glfw.PRESS:
            self._dragged = None
            return
        x, y = glfw.get_cursor_pos(handle)
        if self._dragged is not None:
            height = max(1, glfw.get_window_size(handle)[1])
            self._drawn.turn((x - self._dragged[0]) / height, (y - self._dragged[1]) / height)
        self._dragged = (x, y)

    def _pixels(self) -> tuple[int, int]:
        width, height = glfw.get_framebuffer_size(self._context.handle)
        return min(max(width, 480), LARGEST), min(max(height, 320), LARGEST)
