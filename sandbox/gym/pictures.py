"""Pictures of an environment, by a renderer that lasts from episode to episode."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from models.scene import Scene
from models.surface import Surface
from sandbox.session.messages import Snapshot

if TYPE_CHECKING:
    from sandbox.views.renderer import Renderer


class Pictures:
    """Draws moments of one scene after another.

    A renderer takes most of a second to make. It is kept while scenes look alike: objects may start
    elsewhere, but shapes and colours are the same.

    Args:
        surface: The touch surface.
        size: px, width and height.
    """

    def __init__(self, surface: Surface, size: tuple[int, int]) -> None:
        self._surface, self._size = surface, size
        self._renderer: Renderer | None = None
        self._scene: Scene | None = None
        self.made = 0

    def draw(self, scene: Scene, snapshot: Snapshot) -> NDArray[np.uint8]:
        """The picture (height, width, 3) of a moment.

        Raises:
            GraphicsError: There is no OpenGL on this machine.
        """
        if self._renderer is None or self._scene is None or not _alike(scene, self._scene):
            # Drawing loads OpenGL, which training mostly does without.
            from sandbox.views.renderer import Renderer

            self.close()
            self._renderer = Renderer(scene, self._surface, self._size)
            self._scene, self.made = scene, self.made + 1
        return np.asarray(self._renderer.frame(snapshot))

    def close(self) -> None:
        """Gives the renderer back."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None


def _alike(scene: Scene, other: Scene) -> bool:
    """True if two scenes differ only in where objects are."""
    return scene is other or all(
        np.array_equal(one, two)
        for one, two in zip(_appearance(scene), _appearance(other), strict=True)
    )


def _appearance(scene: Scene) -> tuple[NDArray[Any], ...]:
    """Looks of a scene in a picture, besides where objects are."""
    m = scene.model
    return (
        m.geom_type,
        m.geom_size,
        m.geom_pos,
        m.geom_quat,
        m.geom_rgba,
        m.geom_dataid,
        m.geom_bodyid,
        m.geom_matid,
        m.body_parentid,
        m.jnt_bodyid,
        m.mesh_vert,
    )
