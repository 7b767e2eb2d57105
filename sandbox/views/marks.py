"""Marks in a picture that are not part of the model: rings, edges, lines and single shapes.

They are added to MuJoCo's drawing list after the geoms of the model.
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
"""Number of straight pieces of a full circle, 10 degrees each."""


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
            # In MuJoCo, 2 * mesh means the mesh's triangles, 2 * mesh + 1 its hull.
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
        """Adds a flat disc; radius in m."""
        size = [radius, 1e-4, 0.0]
        self.shape(mujoco.mjtGeom.mjGEOM_CYLINDER, size, position, rotation, colour, alpha)

    def line(self, start: Array, end: Array, radius: float, colour: Colour, alpha: float) -> None:
        """Adds a line (a capsule) between two points; radius in m."""
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
        """Adds an arc of a flat ring; radius and width in m.

        `share`, 0 to 1, is the part of the ring. The middle of the arc is towards the person.
        """
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
        """Adds the twelve edges of a box of half sizes (3,), m; radius of the edges in m."""
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
"""Width of the outline, in heights of the picture."""
SPECK = 3
"""Pieces of a silhouette that are narrower than this (px) are removed."""


def draw_outline(
    picture: Image.Image, lens: Lens, away: Sequence[Array], hands: Sequence[Array]
) -> Image.Image:
    """Returns a picture with outlines of displaced parts of hands in their commanded pose.

    Args:
        picture: RGB.
        lens: The camera of the picture.
        away: Triangles (n, 3, 3) m of the displaced parts in the commanded pose, by hand.
        hands: Triangles (n, 3, 3) m of the whole hands in the present pose, by hand.
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
    """Returns a mask of triangles: 255 inside, 0 outside."""
    mask = Image.new("L", lens.size)
    pen = ImageDraw.Draw(mask)
    for triangles in meshes:
        pixels, ahead = lens.project(triangles)
        for corners in pixels[ahead.all(axis=1) & _towards(pixels)].reshape(-1, 6).tolist():
            pen.polygon(corners, fill=255)
    return mask


def _towards(pixels: Array) -> NDArray[np.bool_]:
    """Returns bool (n,): True for triangles (n, 3, 2) px that show their outer side."""
    one, other = pixels[:, 1] - pixels[:, 0], pixels[:, 2] - pixels[:, 0]
    return np.asarray(one[:, 0] * other[:, 1] < one[:, 1] * other[:, 0])
