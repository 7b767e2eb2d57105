"""A camera: its field of view, and its place in front of the table.

Camera frame: origin in the lens, x right and y down in the picture, z away from the camera. With no
tilt and no roll, the camera looks at the person horizontally from across the table: its x is the
world's -x, its y the world's -z and its z the world's -y. Tilt turns it down about its x axis: at
90 degrees it looks straight down on the table, and the far side of the table is at the bottom of
the picture. Roll turns the picture about the line of sight: with tilt 90 and roll 180, the far side
is at the top. Pan turns the camera about the vertical, and does not move it: at 90 degrees it looks
to the person's right.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import cos, isfinite, radians, sin, tan

import numpy as np

from models.arithmetic import Array, small_product
from models.errors import InputError
from models.frames import Vector

DEFAULT_VIEW = 60.0
"""Horizontal field of view (degrees) that is assumed for a webcam with pictures of 4:3 if it is not
given. Manufacturers state 60 to 78 degrees for pictures of 16:9. The 4:3 part of such a picture, at
full height, has 47 to 63 degrees if they state the angle across the width, and 41 to 56 if they
state that across the diagonal."""
VIEWS = (20.0, 150.0)
"""Smallest and largest accepted field of view (degrees). A value outside was probably mistyped."""
FARTHEST = 3.0
"""Largest coordinate of a camera's place (m)."""

_FACING = np.array([[-1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, -1.0, 0.0]])
"""Axes of a camera that faces the person, as rows in the world."""


@dataclass(frozen=True)
class Camera:
    """A camera; JSON values only.

    Attributes:
        view: Horizontal field of view (degrees), from the left to the right edge of the picture.
        at: (3,) m, position of the lens in the world.
        tilt: Degrees by which it looks down: 0 horizontally, 90 straight down.
        roll: Degrees by which it is turned about its line of sight, clockwise seen from behind it.
        pan: Degrees by which it is turned about the vertical, counterclockwise seen from above.
    """

    view: float = DEFAULT_VIEW
    at: Vector = (0.0, 0.45, 0.10)
    tilt: float = 0.0
    roll: float = 0.0
    pan: float = 0.0

    def __post_init__(self) -> None:
        if not (isfinite(self.view) and VIEWS[0] <= self.view <= VIEWS[1]):
            raise InputError(
                "the camera's field of view is out of range",
                where="--webcam fov",
                got=self.view,
                expected=f"{VIEWS[0]:g} to {VIEWS[1]:g} degrees across the picture",
            )
        if not all(isfinite(c) and abs(c) <= FARTHEST for c in self.at):
            raise InputError(
                "the camera is too far away",
                where="--webcam at",
                got=str(self.at),
                expected=f"three numbers of at most {FARTHEST:g} m",
            )
        for name in ("tilt", "roll", "pan"):
            if not (isfinite(getattr(self, name)) and abs(getattr(self, name)) <= 360.0):
                raise InputError(
                    "the angle is out of range",
                    where=f"--webcam {name}",
                    got=getattr(self, name),
                    expected="-360 to 360 degrees",
                )

    @cached_property
    def axes(self) -> Array:
        """(3, 3) rotation from the world into the camera's frame: the camera's axes as rows."""
        t, r, p = radians(self.tilt), radians(self.roll), radians(self.pan)
        tilted = np.array([[1.0, 0.0, 0.0], [0.0, cos(t), -sin(t)], [0.0, sin(t), cos(t)]])
        rolled = np.array([[cos(r), sin(r), 0.0], [-sin(r), cos(r), 0.0], [0.0, 0.0, 1.0]])
        panned = np.array([[cos(p), sin(p), 0.0], [-sin(p), cos(p), 0.0], [0.0, 0.0, 1.0]])
        return small_product(small_product(rolled, tilted), small_product(_FACING, panned))

    def focal_length(self, width: int) -> float:
        """Focal length in pixels of a picture of a width in pixels."""
        return 0.5 * width / tan(radians(0.5 * self.view))

    def rays(self, image: Array, size: tuple[int, int]) -> Array:
        """Converts points (n, 2) in pixels to rays (n, 2): x/z and y/z in the camera's frame."""
        centre = np.array([0.5 * size[0], 0.5 * size[1]])
        rays: Array = (image - centre) / self.focal_length(size[0])
        return rays

    def pixels(self, points: Array, size: tuple[int, int]) -> Array:
        """Converts points (n, 3) m in the camera's frame, all in front of the camera, to positions
        (n, 2) in pixels."""
        centre = np.array([0.5 * size[0], 0.5 * size[1]])
        pixels: Array = centre + self.focal_length(size[0]) * points[:, :2] / points[:, 2:]
        return pixels

    def seen(self, points: Array) -> Array:
        """Converts points (n, 3) of the world to the camera's frame."""
        return small_product(points - np.array(self.at), self.axes.T)

    def unseen(self, points: Array) -> Array:
        """Converts points (n, 3) of the camera's frame to the world."""
        return small_product(points, self.axes) + np.array(self.at)
