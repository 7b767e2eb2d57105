"""The touch surface: its size and its place in the world.

Contacts are given in the 2-D surface frame: origin top left, x right, y down, metres.
Poses need a third axis. The 3-D surface frame has the same origin and x axis; its y axis points
*up* the surface, and its z axis out of the surface, towards the hand. It is right-handed. At the
identity rotation, a hand lies flat on a table in front of the person. With y down and z into the
table, this most common pose would have a rotation of pi. Rotation vectors are not continuous there,
so an encoder could not learn such poses.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.arithmetic import stacked_applied, stacked_product
from models.errors import InputError, unknown_name
from models.pose import ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp, log

METRES_PER_INCH = 0.0254
"""Metres in one inch (exact, by definition). The contact vector alone is in inches."""

PRESETS: dict[str, tuple[float, float]] = {
    "ipad2": (7.76, 5.82),
    "ipad-11": (9.36, 6.52),
    "ipad-13": (10.32, 7.74),
    "ipad-mini": (7.06, 4.65),
}
"""Name of a device -> landscape size of its touch area, inches. `ipad2` (1024 x 768 at 132 ppi) is
the device of the paper."""

SCALES = (0.05, 20.0)
"""Range of a surface's scale, from a watch to a wall."""

_SIZE = re.compile(r"^\s*([0-9.]+)\s*x\s*([0-9.]+)\s*(in|mm|cm)?\s*$", re.IGNORECASE)
_FLIP = np.array([1.0, -1.0])
"""Factors between the surface's y down and the 3-D surface frame's y up."""

_TO_INCHES = {"in": 1.0, "mm": 1.0 / 25.4, "cm": 1.0 / 2.54}


@dataclass(frozen=True)
class Surface:
    """A touch rectangle in the world. The mapping is absolute, and 1:1 except for `scale`.

    Attributes:
        width_in: Width, inches.
        height_in: Height, inches.
        origin: World position of the top left corner, metres.
        rotation: (3, 3) world from surface: the world directions of the 3-D surface axes.
        calibrated: False if the size is a guess, which views and logs then report.
        scale: Length on the screen divided by the same length on the surface: 1 at true size. It is
            less on a phone, which shows the whole table smaller than a hand.
    """

    width_in: float = PRESETS["ipad2"][0]
    height_in: float = PRESETS["ipad2"][1]
    origin: tuple[float, float, float] = (0.0, 0.0, 0.0)
    rotation: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))
    calibrated: bool = True
    scale: float = 1.0

    def __post_init__(self) -> None:
        for name, value in (("width", self.width_in), ("height", self.height_in)):
            if not (np.isfinite(value) and 0.5 <= value <= 200.0):
                raise InputError(
                    f"the {name} of the touch surface is out of range",
                    got=f"{value:g} inches",
                    expected="0.5 to 200 inches",
                    remedy="Check the size and its unit, for example 7.76x5.82in or 197x148mm",
                )
        low, high = SCALES
        if not low <= self.scale <= high:
            raise InputError(
                "the scale of the touch surface is out of range",
                got=self.scale,
                expected=f"{low:g} to {high:g}, the length on the screen per length on the table",
            )

    @property
    def size(self) -> NDArray[np.float64]:
        """Width and height (2,), metres."""
        return np.array([self.width_in, self.height_in]) * METRES_PER_INCH

    @cached_property
    def corner(self) -> NDArray[np.float64]:
        """The origin as a read-only array (3,)."""
        corner = np.array(self.origin, float)
        corner.flags.writeable = False
        return corner

    @cached_property
    def aligned(self) -> bool:
        """True if its axes are the world's."""
        return bool((self.rotation == np.eye(3)).all())

    def centred_at(self, centre: ArrayLike) -> Surface:
        """The same rectangle with its middle at a world position (3,), metres."""
        w, h = self.size
        middle = np.array([w / 2, -h / 2, 0.0])
        origin = np.asarray(centre, float) - stacked_applied(self.rotation, middle)
        x, y, z = (float(axis) for axis in origin)
        return replace(self, origin=(x, y, z))

    @property
    def upright(self) -> bool:
        """True if the surface faces the person and its upward direction is that of the world."""
        return bool(abs(self.rotation[2, 2]) < 0.5)

    def placed_upright(self, depth: float, low: float) -> Surface:
        """The same rectangle, upright in front of the person like a picture on a wall.

        Its x axis is the world's, its y axis points up in the world, and its normal points towards
        the person.

        Args:
            depth: World y (m) of its plane.
            low: World z (m) of its lower edge. Its centre is at the world's x = 0.
        """
        w, h = self.size
        turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
        origin = (-float(w) / 2, float(depth), float(low + h))
        return replace(self, origin=origin, rotation=turn)

    def to_world(self, xy: ArrayLike, height: float = 0.0) -> NDArray[np.float64]:
        """World positions (..., 3) of surface points (..., 2), `height` metres off the surface."""
        points = np.asarray(xy, float)
        local = np.empty((*points.shape[:-1], 3))
        local[..., 0], local[..., 1], local[..., 2] = points[..., 0], -points[..., 1], height
        return stacked_applied(self.rotation, local) + self.corner

    def pose_to_world(self, q: ArrayLike) -> NDArray[np.float64]:
        """Converts poses (..., 48) from the 3-D surface frame to world coordinates."""
        moved = np.array(q, float)
        if self.aligned:
            # If the axes are the world's, the rotation is left as it is. Converting it by log(exp)
            # would round it.
            moved[..., ROOT_POSITION] += self.corner
        else:
            moved[..., ROOT_POSITION] = (
                stacked_applied(self.rotation, moved[..., ROOT_POSITION]) + self.corner
            )
            turned = stacked_product(self.rotation, exp(moved[..., ROOT_ROTATION]))
            moved[..., ROOT_ROTATION] = log(turned)
        return moved

    def to_surface(self, world: ArrayLike) -> NDArray[np.float64]:
        """Surface points (..., 2) under world positions (..., 3): the foot of the normal."""
        local = stacked_applied(self.rotation.T, np.asarray(world, float) - self.corner)
        points: NDArray[np.float64] = local[..., :2] * _FLIP
        return points


def enclosing(surfaces: Sequence[Surface]) -> Surface:
    """The smallest rectangle around surfaces in one plane, aligned with the first one.

    Args:
        surfaces: One or more. A single surface, or several in one place, is returned unchanged.
    """
    first = surfaces[0]
    corners = [first.to_surface(s.to_world(np.stack([0.0 * s.size, s.size]))) for s in surfaces]
    low, high = np.min(corners, axis=(0, 1)), np.max(corners, axis=(0, 1))
    if np.allclose(low, 0.0, atol=1e-9) and np.allclose(high, first.size, atol=1e-9):
        return first
    width, height = ((high - low) / METRES_PER_INCH).tolist()
    x, y, z = first.to_world(low).tolist()
    return replace(first, width_in=width, height_in=height, origin=(x, y, z))


def parse_surface(text: str) -> Surface:
    """Parses a flat surface from '7.76x5.82in', '197x148mm' or a preset's name.

    Raises:
        InputError: The text is neither a size nor a preset.
    """
    if text in PRESETS:
        return Surface(*PRESETS[text])
    match = _SIZE.match(text)
    try:
        if match is None:
            raise ValueError
        unit = _TO_INCHES[(match[3] or "in").lower()]
        return Surface(float(match[1]) * unit, float(match[2]) * unit)
    except ValueError:
        raise unknown_name(
            "not the size of a surface",
            text,
            PRESETS,
            where="--surface",
            others="WIDTHxHEIGHT with in, mm or cm",
            remedy="Measure the touch area with a ruler, for example 197x148mm",
        ) from None


def inside(places: NDArray[np.float64], border: float, size: NDArray[np.float64]) -> bool:
    """True if all places (n, 2) m on a surface of size (2,) m are at least `border` (m) inside
    it."""
    return bool(np.all(places >= border) and np.all(places <= size - border))
