"""Simple shapes as signed distance fields, and smooth unions of these; all lengths in m."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array


def rounded_cone(p: Array, start: ArrayLike, end: ArrayLike, first: float, last: float) -> Array:
    """Distances (n,) m to a capsule whose radius changes from `first` to `last`."""
    start, along = np.asarray(start), np.asarray(end, float) - np.asarray(start, float)
    t = np.clip((p - start) @ along / (along @ along), 0.0, 1.0)
    return np.linalg.norm(p - start - t[:, None] * along, axis=1) - (first + (last - first) * t)


def ellipsoid(p: Array, centre: ArrayLike, half: ArrayLike, axes: Array | None = None) -> Array:
    """Approximate distances (n,) m to an ellipsoid; exact on its surface, with the right sign.

    Args:
        p: (n, 3) m, points.
        centre: (3,) m, centre.
        half: (3,) m, semi-axes.
        axes: (3, 3), directions of the axes as columns; None for the coordinate axes.
    """
    local = p - np.asarray(centre)
    if axes is not None:
        local = local @ axes
    scaled = local / np.asarray(half)
    far = np.linalg.norm(scaled, axis=1)
    return far * (far - 1.0) / np.maximum(np.linalg.norm(scaled / np.asarray(half), axis=1), 1e-9)


def melt(a: Array, b: Array, reach: float) -> Array:
    """Smooth union of distances (n,) m, blended over `reach` (m). Where both distances are equal,
    it adds a sixth of `reach`."""
    mixed = np.maximum(reach - np.abs(a - b), 0.0) / reach
    return np.minimum(a, b) - mixed**3 * (reach / 6.0)


def cut(a: Array, b: Array, reach: float) -> Array:
    """Smooth intersection of distances (n,) m, with the edge rounded over `reach` (m)."""
    return -melt(-a, -b, reach)


def groove(across: Array, width: float) -> Array:
    """Relative depth (n,), 0 to 1, of a furrow with soft edges, at distances (n,) m from its middle
    line."""
    return np.exp(-((across / width) ** 2))


def step(x: Array, low: float, high: float) -> Array:
    """Smooth step: 0 below `low`, 1 above `high`."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


@dataclass(frozen=True)
class Limb:
    """A bone at the zero pose.

    Attributes:
        start: (3,) m, position of its joint.
        axes: (3, 3), columns: sideways, along the bone, out of its back.
        length: Length (m) of the bone.
        radius: Radius (m) of the flesh.
    """

    start: Array
    axes: Array
    length: float
    radius: float

    def at(self, side: float, along: float, up: float) -> Array:
        """Position (3,) m for coordinates in the bone's frame: `along` in lengths of the bone,
        `side` and `up` in radii."""
        return self.start + self.axes @ np.array(
            [side * self.radius, along * self.length, up * self.radius]
        )

    def local(self, p: Array) -> Array:
        """Points (n, 3) m, converted to the bone's frame."""
        return (p - self.start) @ self.axes


def between(a: Limb, b: Limb) -> Array:
    """Axes (3, 3) halfway between those of two consecutive bones."""
    y = a.axes[:, 1] + b.axes[:, 1]
    y /= np.linalg.norm(y)
    z = a.axes[:, 2] + b.axes[:, 2]
    z -= (z @ y) * y
    z /= np.linalg.norm(z)
    return np.stack([np.cross(y, z), y, z], axis=1)
