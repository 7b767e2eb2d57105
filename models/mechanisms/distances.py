"""Signed distances of points to the plain shapes of MJCF, each in its own frame."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from models.arithmetic import Array, squared_lengths


def sphere(points: Array, size: Array) -> Array:
    """Distances (n,) m of points (n, 3) to a sphere: its radius."""
    return np.asarray(np.sqrt(squared_lengths(points)) - size[0])


def capsule(points: Array, size: Array) -> Array:
    """Distances (n,) m of points (n, 3) to a capsule along z: its radius and half its length."""
    along = np.clip(points[:, 2], -size[1], size[1])
    beside = points.copy()
    beside[:, 2] -= along
    return sphere(beside, size)


def cylinder(points: Array, size: Array) -> Array:
    """Distances (n,) m of points (n, 3) to a cylinder along z: its radius and half its height."""
    out = np.sqrt(squared_lengths(points[:, :2])) - size[0]
    return _outside(np.column_stack([out, np.abs(points[:, 2]) - size[1]]))


def box(points: Array, size: Array) -> Array:
    """Distances (n,) m of points (n, 3) to a box: half its edges."""
    return _outside(np.abs(points) - size)


PLAIN: dict[str, Callable[[Array, Array], Array]] = {
    "sphere": sphere,
    "capsule": capsule,
    "cylinder": cylinder,
    "box": box,
}
"""Kind of a geom -> its distance function."""


def _outside(beyond: Array) -> Array:
    """Distances (n,) from how far points are beyond each pair of faces (n, k)."""
    out = np.sqrt(squared_lengths(np.maximum(beyond, 0.0)))
    return np.asarray(out + np.minimum(beyond.max(axis=1), 0.0))
