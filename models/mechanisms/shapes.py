"""Signed distances and reaches of MJCF's basic shapes, each in the shape's own frame.

The reach of a shape along a direction is the largest coordinate of its points in this direction.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

import numpy as np

from models.arithmetic import Array, length, squared_lengths, stacked_applied


def sphere(points: Array, size: Array) -> Array:
    """Signed distances (n,) m of points (n, 3) to a sphere; `size` is its radius."""
    return np.asarray(np.sqrt(squared_lengths(points)) - size[0])


def capsule(points: Array, size: Array) -> Array:
    """Signed distances (n,) m of points (n, 3) to a capsule along z; `size` is its radius and half
    its length."""
    along = np.clip(points[:, 2], -size[1], size[1])
    beside = points.copy()
    beside[:, 2] -= along
    return sphere(beside, size)


def cylinder(points: Array, size: Array) -> Array:
    """Signed distances (n,) m of points (n, 3) to a cylinder along z; `size` is its radius and half
    its height."""
    out = np.sqrt(squared_lengths(points[:, :2])) - size[0]
    return _outside(np.column_stack([out, np.abs(points[:, 2]) - size[1]]))


def box(points: Array, size: Array) -> Array:
    """Signed distances (n,) m of points (n, 3) to a box; `size` is half its edges."""
    return _outside(np.abs(points) - size)


DISTANCES: dict[str, Callable[[Array, Array], Array]] = {
    "sphere": sphere,
    "capsule": capsule,
    "cylinder": cylinder,
    "box": box,
}
"""Kind of a geom -> its distance function."""


def _outside(beyond: Array) -> Array:
    """Signed distances (n,), from signed distances (n, k) of points to each pair of faces."""
    out = np.sqrt(squared_lengths(np.maximum(beyond, 0.0)))
    return np.asarray(out + np.minimum(beyond.max(axis=1), 0.0))


def sphere_reach(way: Array, size: Array) -> float:
    """Reach (m) of a sphere along a unit vector (3,); `size` is its radius."""
    return float(size[0])


def capsule_reach(way: Array, size: Array) -> float:
    """Reach (m) of a capsule along a unit vector (3,); `size` is its radius and half its length."""
    return float(size[0] + abs(way[2]) * size[1])


def cylinder_reach(way: Array, size: Array) -> float:
    """Reach (m) of a cylinder along a unit vector (3,); `size` is radius and half the height."""
    return float(length(way[:2]) * size[0] + abs(way[2]) * size[1])


def box_reach(way: Array, size: Array) -> float:
    """Reach (m) of a box along a unit vector (3,); `size` is half its edges."""
    x, y, z = np.abs(way * size).tolist()
    return float(x + y + z)


def ellipsoid_reach(way: Array, size: Array) -> float:
    """Reach (m) of an ellipsoid along a unit vector (3,); `size` is half its axes."""
    x, y, z = ((way * size) ** 2).tolist()
    return sqrt(x + y + z)


def mesh_reach(way: Array, points: Array) -> float:
    """Reach (m) of the convex hull of points (n, 3) m along a unit vector (3,)."""
    return float(np.max(stacked_applied(points, way)))


REACHES: dict[str, Callable[[Array, Array], float]] = {
    "sphere": sphere_reach,
    "capsule": capsule_reach,
    "cylinder": cylinder_reach,
    "box": box_reach,
    "ellipsoid": ellipsoid_reach,
}
"""Kind of a geom -> its reach function; meshes use `mesh_reach`."""
