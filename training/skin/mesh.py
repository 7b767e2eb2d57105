"""Triangulates distance fields evenly, and more finely at creases of the skin.

Needs scikit-image and fast-simplification (extra `training`).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RegularGridInterpolator
from scipy.sparse import csr_matrix

from models.arithmetic import Array
from models.errors import InputError

Faces = NDArray[np.int64]
Field = Callable[[Array], Array]


def mesh_of(
    field: Field, low: Array, high: Array, spacing: float, faces: int
) -> tuple[Array, Faces]:
    """Closed surface of about `faces` even triangles that face outwards.

    Args:
        field: Function from points (n, 3) m to signed distances (n,) m, negative inside.
        low: (3,) m, lower corner of a box around the surface.
        high: (3,) m, upper corner.
        spacing: Spacing (m) of the grid.
        faces: Number of triangles to keep.
    """
    try:
        from fast_simplification import simplify
        from skimage.measure import marching_cubes
    except ImportError as error:
        raise InputError(
            "the skin cannot be made: a package is missing",
            got=error.name,
            remedy="pip install -e '.[training]' in the checkout",
        ) from error
    values, origin = _sampled(field, low, high, spacing)
    vertices, triangles, _, _ = marching_cubes(values, 0.0, spacing=(spacing,) * 3)
    points, kept = simplify(
        (vertices + origin).astype(np.float32), triangles.astype(np.int32), target_count=faces
    )
    vertices, triangles = points.astype(float), kept.astype(np.int64)
    if volume(vertices, triangles) < 0.0:
        triangles = triangles[:, ::-1]
    return vertices, triangles


def _sampled(field: Field, low: Array, high: Array, spacing: float) -> tuple[Array, Array]:
    """The field's values on a grid, exact near its surface, and the grid's lower corner (3,) m."""
    coarse = 4
    count = coarse * np.ceil((high - low) / (coarse * spacing)).astype(int) + 1
    axes = [low[i] + spacing * np.arange(count[i]) for i in range(3)]
    rough_axes = [a[::coarse] for a in axes]
    rough = field(_points(rough_axes)).reshape([len(a) for a in rough_axes])
    points = _points(axes)
    values = RegularGridInterpolator(rough_axes, rough)(points)
    # Only points at which the surface may be near are computed exactly. Elsewhere the field cannot
    # be zero, even if it is a little steeper than a distance.
    near = np.flatnonzero(np.abs(values) < 2.0 * coarse * spacing)
    for chunk in np.array_split(near, max(len(near) // 200_000, 1)):
        values[chunk] = field(points[chunk])
    return values.reshape(count), low


def _points(axes: list[Array]) -> Array:
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def settled(
    field: Field, normal: Field, vertices: Array, triangles: Faces, rounds: int, pull: float = 0.5
) -> Array:
    """Moves vertices towards the mean of their neighbours, and back onto the surface."""
    for _ in range(rounds):
        out = normal(vertices)
        towards = neighbour_means(vertices, triangles) - vertices
        along = towards - np.sum(towards * out, axis=1, keepdims=True) * out
        vertices = vertices + pull * along
        vertices = vertices - field(vertices)[:, None] * normal(vertices)
    return vertices - field(vertices)[:, None] * normal(vertices)


def neighbour_means(values: Array, triangles: Faces) -> Array:
    """Means (n, k) of values (n, k) over each vertex's neighbours."""
    edges = edges_of(triangles)
    ends = np.concatenate([edges, edges[:, ::-1]])
    links = csr_matrix((np.ones(len(ends)), (ends[:, 0], ends[:, 1])), shape=(len(values),) * 2)
    return (links @ values) / np.maximum(np.asarray(links.sum(axis=1)), 1.0)


def edges_of(triangles: Faces) -> Faces:
    """All edges (e, 2) once, the smaller vertex first."""
    pairs = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    return np.unique(pairs, axis=0)


def refined(
    vertices: Array, triangles: Faces, longest: Callable[[Array], Array]
) -> tuple[Array, Faces]:
    """Splits edges once, at their middles.

    Args:
        vertices: (n, 3) m.
        triangles: (m, 3).
        longest: Function from the middles (e, 3) m of edges to their largest lengths (e,) m. Longer
            edges are split.
    """
    edges = edges_of(triangles)
    middle = vertices[edges].mean(axis=1)
    length = np.linalg.norm(vertices[edges[:, 0]] - vertices[edges[:, 1]], axis=1)
    chosen = np.flatnonzero(length > longest(middle))
    key = edges[:, 0] * len(vertices) + edges[:, 1]
    new = np.full(len(edges), -1)
    new[chosen] = len(vertices) + np.arange(len(chosen))
    points = np.concatenate([vertices, middle[chosen]])

    corners = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=-1), axis=-1)
    halves = new[np.searchsorted(key, corners[..., 0] * len(vertices) + corners[..., 1])]
    out = []
    for (a, b, c), (ab, bc, ca) in zip(triangles.tolist(), halves.tolist(), strict=True):
        out += _split(points, a, b, c, ab, bc, ca)
    return points, np.array(out, np.int64)


def _split(
    points: Array, a: int, b: int, c: int, ab: int, bc: int, ca: int
) -> list[tuple[int, int, int]]:
    """Triangles into which a triangle is split.

    Args:
        points: (n, 3) m.
        a, b, c: Indices of the corners.
        ab, bc, ca: Indices of the new middles of the edges; -1 for an edge that is not split.
    """
    parts = sum(m >= 0 for m in (ab, bc, ca))
    if parts == 0:
        return [(a, b, c)]
    if parts == 3:
        return [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    while not (ab >= 0 and (parts == 1 or bc >= 0)):
        a, b, c, ab, bc, ca = b, c, a, bc, ca, ab
    if parts == 1:
        return [(a, ab, c), (ab, b, c)]
    # Split the remaining quadrilateral along its shorter diagonal.
    if np.sum((points[ab] - points[c]) ** 2) < np.sum((points[a] - points[bc]) ** 2):
        return [(ab, b, bc), (a, ab, c), (ab, bc, c)]
    return [(ab, b, bc), (a, ab, bc), (a, bc, c)]


def volume(vertices: Array, triangles: Faces) -> float:
    """Volume in m3 of a closed surface; negative if it is inside out."""
    a, b, c = vertices[triangles].transpose(1, 0, 2)
    return float(np.sum(a * np.cross(b, c)) / 6.0)


def flipped_edges(vertices: Array, triangles: Faces, rounds: int = 4) -> Faces:
    """Flips edges where this increases the smallest angle of the two triangles."""
    for _ in range(rounds):
        triangles, count = _flip_once(vertices, triangles.copy())
        if count == 0:
            break
    return triangles


def _flip_once(vertices: Array, triangles: Faces) -> tuple[Faces, int]:
    owners: dict[tuple[int, int], tuple[int, int]] = {}
    present = {tuple(e) for e in edges_of(triangles).tolist()}
    touched = np.zeros(len(triangles), bool)
    rows = triangles.tolist()
    for t, (a, b, c) in enumerate(rows):
        for start, end, other in ((a, b, c), (b, c, a), (c, a, b)):
            owners[start, end] = (t, other)
    count = 0
    for (start, end), (t, c) in owners.items():
        if start > end or (end, start) not in owners:
            continue
        s, d = owners[end, start]
        edge = (min(c, d), max(c, d))
        if touched[t] or touched[s] or edge in present:
            continue
        before = min(_least_angle(vertices, start, end, c), _least_angle(vertices, end, start, d))
        after = min(_least_angle(vertices, c, start, d), _least_angle(vertices, d, end, c))
        if after > before + 0.02 and _flat(vertices, start, end, c, d):
            triangles[t], triangles[s] = (c, start, d), (d, end, c)
            touched[t] = touched[s] = True
            present.add(edge)
            count += 1
    return triangles, count


def _least_angle(v: Array, a: int, b: int, c: int) -> float:
    p = v[[a, b, c]]
    sides = np.roll(p, -1, axis=0) - p
    sides /= np.maximum(np.linalg.norm(sides, axis=1, keepdims=True), 1e-12)
    return float(
        np.arccos(np.clip(-np.sum(sides * np.roll(sides, 1, axis=0), axis=1), -1, 1)).min()
    )


def _flat(v: Array, a: int, b: int, c: int, d: int) -> bool:
    """True if two triangles with the common edge ab are nearly coplanar, before and after a
    flip."""
    normals = [
        np.cross(v[j] - v[i], v[k] - v[i])
        for i, j, k in ((a, b, c), (b, a, d), (c, a, d), (d, b, c))
    ]
    lengths = [float(np.linalg.norm(n)) for n in normals]
    if min(lengths) < 1e-12:
        return False
    return all(
        float(normals[0] @ n) > 0.9 * lengths[0] * size
        for n, size in zip(normals[1:], lengths[1:], strict=True)
    )
