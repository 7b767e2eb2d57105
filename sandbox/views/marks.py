"""Marks in a picture, which are not part of the model: rings, edges, lines and single shapes.

They are added to MuJoCo's drawing list after the model's own geoms.
"""

from __future__ import annotations

from collections.abc import Sequence

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageChops, ImageDraw, ImageFilter

from models.arithmetic import Array
from sandbox.views import palette
from sandbox.views.cameras import Lens
from sandbox.views.palette import Colour

ARC_SIDES = 36
"""Straight pieces of a whole arc, of 10 degrees each."""


class Marks:
    """Adds marks to a drawing list.

    Args:
        view: The drawing list.
    """

    def __init__(self, view: mujoco.MjvScene) -> None:
        self._view = view

    def shape(
        self,
        kind: int,
        size: ArrayLike,
        position: Array,
        rotation: Array,
        colour: Colour,
        alpha: float,
        mesh: int = -1,
    ) -> mujoco.MjvGeom | None:
        """Adds a geom at a pose in the world, and returns it; None if the list is full."""
        view = self._view
        if view.ngeom >= view.maxgeom:
            return None
        geom = view.geoms[view.ngeom]
        mujoco.mjv_initGeom(
            geom,
            kind,
            np.asarray(size, float),
            np.asarray(position, float),
            np.asarray(rotation, float).ravel(),
            np.array([*colour, alpha], np.float32),
        )
        # Marks cast no shadow, emit a little light, and belong to no part of the model.
        geom.category = mujoco.mjtCatBit.mjCAT_DECOR
        geom.objtype, geom.objid, geom.segid = mujoco.mjtObj.mjOBJ_UNKNOWN, -1, -1
        geom.emission, geom.specular, geom.shininess = 0.35, 0.1, 0.2
        if mesh >= 0:
            # For MuJoCo, an even number means a mesh's triangles, the next odd one its hull.
            geom.dataid = 2 * mesh
        view.ngeom += 1
        return geom

    def box(
        self, half: ArrayLike, position: Array, rotation: Array, colour: Colour, alpha: float
    ) -> None:
        """Adds a box of half sizes (3,), m."""
        self.shape(mujoco.mjtGeom.mjGEOM_BOX, half, position, rotation, colour, alpha)

    def disc(
        self, radius: float, position: Array, rotation: Array, colour: Colour, alpha: float
    ) -> None:
        """Adds a flat disc of a radius, m."""
        size = [radius, 1e-4, 0.0]
        self.shape(mujoco.mjtGeom.mjGEOM_CYLINDER, size, position, rotation, colour, alpha)

    def line(self, start: Array, end: Array, radius: float, colour: Colour, alpha: float) -> None:
        """Adds a line between two points, a capsule."""
        kind = mujoco.mjtGeom.mjGEOM_CAPSULE
        geom = self.shape(kind, np.ones(3), start, np.eye(3), colour, alpha)
        if geom is not None:
            mujoco.mjv_connector(geom, kind, radius, start, end)

    def ring(
        self,
        position: Array,
        rotation: Array,
        radius: float,
        width: float,
        sides: int,
        colour: Colour,
        alpha: float,
        dashed: bool = False,
    ) -> None:
        """Adds a flat ring of `sides` straight pieces; radius and width in m.

        Every other piece of a dashed ring is left out.
        """
        half = radius * np.tan(np.pi / sides)
        for angle in 2 * np.pi * np.arange(0, sides, 2 if dashed else 1) / sides:
            cos, sin = np.cos(angle), np.sin(angle)
            turn = rotation @ np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
            middle = position + turn @ np.array([radius, 0.0, 0.0])
            self.box([width / 2, half, 2e-4], middle, turn, colour, alpha)

    def arc(
        self,
        position: Array,
        rotation: Array,
        radius: float,
        width: float,
        share: float,
        colour: Colour,
    ) -> None:
        """Adds the share, 0 to 1, of a flat ring, its middle towards the person; radius and width
        in m."""
        pieces = max(round(share * ARC_SIDES), 1)
        half = radius * np.tan(np.pi / ARC_SIDES)
        for piece in range(pieces):
            angle = 2 * np.pi * (piece - (pieces - 1) / 2) / ARC_SIDES - np.pi / 2
            cos, sin = np.cos(angle), np.sin(angle)
            turn = rotation @ np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
            middle = position + turn @ np.array([radius, 0.0, 0.0])
            self.box([width / 2, half, 2e-4], middle, turn, colour, 1.0)

    def edges(
        self, half: Array, position: Array, rotation: Array, colour: Colour, radius: float
    ) -> None:
        """Adds the twelve edges of a box of half sizes (3,), m."""
        signs = np.array([[a, b] for a in (-1.0, 1.0) for b in (-1.0, 1.0)])
        for axis in range(3):
            others = [(axis + 1) % 3, (axis + 2) % 3]
            for pair in signs:
                ends = np.zeros((2, 3))
                ends[:, others] = pair * half[others]
                ends[:, axis] = -half[axis], half[axis]
                start, end = position + ends @ rotation.T
                self.line(start, end, radius, colour, 1.0)


LINE = 1 / 180
"""Width of the line in heights of the picture."""
SPECK = 3
"""Width (px) below which a piece is the rest of a triangle, not a part of the hand."""


def draw_outline(
    picture: Image.Image, lens: Lens, away: Sequence[Array], hands: Sequence[Array]
) -> Image.Image:
    """A picture with outlines of displaced parts of hands at their commanded places.

    Args:
        picture: RGB.
        lens: The camera of the picture.
        away: Triangles (n, 3, 3) m of the parts at their commanded places.
        hands: Triangles (n, 3, 3) m of the hands at their present places.
    """
    parts = _silhouette(lens, away)
    parts = parts.filter(ImageFilter.MinFilter(SPECK)).filter(ImageFilter.MaxFilter(SPECK))
    if parts.getbbox() is None:
        return picture
    width = 2 * round(LINE * lens.size[1]) + 1
    line = ImageChops.subtract(parts.filter(ImageFilter.MaxFilter(width)), parts)
    line = ImageChops.subtract(line, _silhouette(lens, hands))
    out = picture.copy()
    out.paste(palette.bytes_of(palette.TARGET)[:3], mask=line)
    return out


def _silhouette(lens: Lens, meshes: Sequence[Array]) -> Image.Image:
    """Mask of triangles, 255 inside of them."""
    mask = Image.new("L", lens.size)
    pen = ImageDraw.Draw(mask)
    for triangles in meshes:
        pixels, ahead = lens.project(triangles)
        for corners in pixels[ahead.all(axis=1) & _towards(pixels)].reshape(-1, 6).tolist():
            pen.polygon(corners, fill=255)
    return mask


def _towards(pixels: Array) -> NDArray[np.bool_]:
    """(n,) whether triangles (n, 3, 2) px show their outer side: half of a closed surface does."""
    one, other = pixels[:, 1] - pixels[:, 0], pixels[:, 2] - pixels[:, 0]
    return np.asarray(one[:, 0] * other[:, 1] < one[:, 1] * other[:, 0])
