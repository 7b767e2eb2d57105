"""Pictures of a trial as one array, for programs that want pixels rather than a film file."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from sandbox.devices.device import Closeable
from sandbox.session.messages import Snapshot
from sandbox.session.session import Session
from sandbox.views.overlay import OverlayTexts
from sandbox.views.renderer import Renderer

PICTURE_RATE = 15.0
"""Pictures per second of simulated time, as in a film."""


class PictureView(Closeable):
    """A view of a session that draws pictures at an even rate and keeps them.

    Args:
        session: Session to draw.
        size: Width and height, px.
        caption: Name of the player, written on every picture.

    Raises:
        GraphicsError: OpenGL is missing on this machine.
        InputError: The size is invalid.
    """

    def __init__(self, session: Session, size: tuple[int, int], caption: str) -> None:
        words = OverlayTexts(caption)
        self._renderer = Renderer(session.scene, session.whole_surface, size, words)
        self._pictures: list[NDArray[np.uint8]] = []
        self._size = size

    def show(self, snapshot: Snapshot) -> None:
        """Draws a snapshot if the next picture is due."""
        if snapshot.time * PICTURE_RATE >= len(self._pictures):
            self._pictures.append(np.asarray(self._renderer.frame(snapshot)))

    def pictures(self) -> NDArray[np.uint8]:
        """(n, height, width, 3) RGB, 0 to 255."""
        width, height = self._size
        return np.array(self._pictures, np.uint8).reshape(-1, height, width, 3)

    def close(self) -> None:
        """Frees the OpenGL context; may be called twice."""
        self._renderer.close()
