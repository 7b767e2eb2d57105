"""How far the shapes of MJCF reach in a direction, from their middle."""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt

import numpy as np

from models.arithmetic import Array, length, stacked_applied


def sphere(way: Array, size: Array) -> float:
    """Reach in m along a unit vector (3,) of a sphere: its radius."""
    return float(size[0])


def capsule(way: Array, size: Array) -> float:
    """The same of a capsule along z: its radius and half its length."""
    return float(size[0] + abs(way[2]) * size[1])


def cylinder(way: Array, size: Array) -> float:
    """The same of a cylinder along z: its radius and half its height."""
    return float(length(way[:2]) * size[0] + abs(way[2]) * size[1])


def box(way: Array, size: Array) -> float:
    """The same of a box: half its edges."""
    x, y, z = np.abs(way * size).tolist()
    return float(x + y + z)


def ellipsoid(way: Array, size: Array) -> float:
    """The same of an ellipsoid: half its axes."""
    x, y, z = ((way * size) ** 2).tolist()
    return sqrt(x + y + z)


def mesh(way: Array, points: Array) -> float:
    """The same of the hull of points (n, 3) m."""
    return float(np.max(stacked_applied(points, way)))


REACHES: dict[str, Callable[[Array, Array], float]] = {
    "sphere": sphere,
    "capsule": capsule,
    "cylinder": cylinder,
    "box": box,
    "ellipsoid": ellipsoid,
}
"""Kind of a geom -> its reach; a mesh is given by its points."""
