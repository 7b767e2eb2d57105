"""A visible window with its OpenGL context, which a renderer can also use."""

from __future__ import annotations

import atexit
import sys
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any, cast

import glfw

from sandbox.views.display import OPENGL_REMEDY, GraphicsError

SMALLEST = (480, 320)
"""Smallest size (px) to which a person can shrink the window."""


class WindowContext:
    """A visible window with its OpenGL context.

    Args:
        title: Title of the window.
        size: px in the screen's coordinates.

    Raises:
        GraphicsError: No window can be opened here.

    Attributes:
        handle: Window handle of glfw; None once it is freed.
    """

    backend: str | None = None

    def __init__(self, title: str, size: tuple[int, int]) -> None:
        said: list[str] = []
        glfw.set_error_callback(lambda _code, text: said.append(_text(text)))
        if not glfw.init():
            raise GraphicsError(
                "no window can be opened without a screen",
                got="; ".join(said) or None,
                remedy="`sandbox run` needs no window"
                + ("; without a screen, try xvfb-run" if sys.platform == "linux" else ""),
            )
        # Terminate only at exit: it closes all windows.
        atexit.register(glfw.terminate)
        glfw.default_window_hints()
        glfw.window_hint(glfw.SCALE_TO_MONITOR, glfw.TRUE)
        # Pictures are drawn in memory and copied to the window.
        glfw.window_hint(glfw.SAMPLES, 0)
        handle = glfw.create_window(*size, title, None, None)
        if not handle:
            raise GraphicsError(
                "no window can be opened, since this screen has no OpenGL",
                got="; ".join(said) or None,
                remedy=OPENGL_REMEDY,
            )
        glfw.set_window_size_limits(handle, *SMALLEST, glfw.DONT_CARE, glfw.DONT_CARE)
        glfw.set_cursor(handle, glfw.create_standard_cursor(glfw.CROSSHAIR_CURSOR))
        self.handle: Any = handle
        with self.as_current():
            # The loop has its own clock; waiting for the screen as well would only add delay.
            glfw.swap_interval(0)

    @contextmanager
    def as_current(self) -> Iterator[None]:
        """Makes the context current in the calling thread for the `with` block."""
        glfw.make_context_current(self.handle)
        try:
            yield
        finally:
            glfw.make_context_current(cast(Any, None))

    def swap(self) -> None:
        """Shows the drawn picture."""
        with self.as_current():
            glfw.swap_buffers(self.handle)

    def free(self) -> None:
        """Closes the window; may be called twice."""
        if self.handle is not None:
            glfw.destroy_window(self.handle)
            self.handle = None


class BorrowedContext:
    """The context of a window, for a renderer; freeing it does not close the window."""

    def __init__(self, context: WindowContext) -> None:
        self._context = context
        self.backend = context.backend

    def as_current(self) -> AbstractContextManager[None]:
        """See `WindowContext.as_current`."""
        return self._context.as_current()

    def free(self) -> None:
        """Does nothing: the context belongs to the window."""


def _text(said: str | bytes) -> str:
    """Decodes a text of glfw, which is bytes although its type hint is `str`."""
    return said.decode(errors="replace") if isinstance(said, bytes) else said
