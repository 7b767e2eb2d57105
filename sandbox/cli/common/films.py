"""Films of sessions, for all commands that can make one."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from sandbox.session.session import Session

if TYPE_CHECKING:
    from sandbox.views.film import FilmView


def open_film(path: Path, session: Session, caption: str) -> FilmView:
    """Opens a film of a session; the file is complete when the film is closed.

    Raises:
        GraphicsError: OpenGL is missing on this machine.
        InputError: The film cannot be written to this path.
    """
    # Drawing loads OpenGL, which a run without a film never needs.
    from sandbox.views.film import FilmView

    return FilmView(path, session.scene, session.whole_surface, caption=caption)
