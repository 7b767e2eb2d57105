"""Where a camera is, and what it sees, from a plane of known size in its picture."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan, degrees, sqrt

import numpy as np

from encoders.webcam.camera import VIEWS, Camera
from models.arithmetic import Array
from models.errors import CaptureError

LEAST_LEAN = 0.05
"""Least change of scale over the picture, relative to the scale, at which a field of view follows
from a plane: looked at straight, a plane looks alike through any lens."""


@dataclass(frozen=True)
class CameraPlace:
    """A camera in the 3-D surface frame (x right, y up the surface, z out of it).

    Attributes:
        camera: Its field of view; its own place is not used.
        rotation: (3, 3) camera from surface.
        shift: (3,) m, the surface's origin in the camera's frame.
    """

    camera: Camera
    rotation: Array
    shift: Array

    @property
    def at(self) -> Array:
        """(3,) m, the lens in the surface frame."""
        return np.asarray(-self.rotation.T @ self.shift)

    def seen(self, points: Array) -> Array:
        """Points (..., 3) of the surface frame in the camera's."""
        return np.asarray(points @ self.rotation.T + self.shift)

    def unseen(self, points: Array) -> Array:
        """Points (..., 3) of the camera's frame in the surface's."""
        return np.asarray((points - self.shift) @ self.rotation)


def place_of_camera(matrix: Array, size: tuple[int, int], camera: Camera) -> CameraPlace:
    """Where a camera is that sees the surface by a homography.

    Args:
        matrix: (3, 3) from pixels to m on the surface, x right and y down.
        size: Width and height of the picture in px.
        camera: Its field of view.

    Raises:
        CaptureError: No camera sees a plane so.
    """
    columns = np.linalg.inv(_lens(size, camera)) @ np.linalg.inv(matrix)
    scale = sqrt(float(np.linalg.norm(columns[:, 0]) * np.linalg.norm(columns[:, 1])))
    # The surface is before the camera.
    columns = columns / (scale if columns[2, 2] > 0 else -scale)
    x, y = columns[:, 0], -columns[:, 1]
    u, _, v = np.linalg.svd(np.stack([x, y, np.cross(x, y)], axis=1))
    rotation = u @ np.diag([1.0, 1.0, float(np.linalg.det(u @ v))]) @ v
    place = CameraPlace(camera, rotation, columns[:, 2])
    if not np.isfinite(place.shift).all() or place.at[2] <= 0.0:
        raise CaptureError(
            "the surface in the picture is seen from below",
            got=np.round(place.at, 3).tolist(),
            remedy="The camera's picture may be a mirror's, or corners may be swapped",
        )
    return place


def field_of_view(matrix: Array, size: tuple[int, int]) -> float | None:
    """Degrees across the picture, from a plane that is not looked at straight; None if it is.

    The two directions of the plane are at right angles and equally long, whatever the lens
    (Zhang, A flexible new technique for camera calibration, 2000): two equations for one unknown.

    Args:
        matrix: (3, 3) homography from pixels to m on the plane.
        size: Width and height of the picture in px.
    """
    middle = np.array([[1.0, 0.0, 0.5 * size[0]], [0.0, 1.0, 0.5 * size[1]], [0.0, 0.0, 1.0]])
    h = np.linalg.inv(middle) @ np.linalg.inv(matrix)
    h = h / np.linalg.norm(h[:2, :2])
    # (x1 x2 + y1 y2) / f2 + z1 z2 = 0, and (|xy1|2 - |xy2|2) / f2 + z1^2 - z2^2 = 0.
    flat = np.array([h[:2, 0] @ h[:2, 1], h[:2, 0] @ h[:2, 0] - h[:2, 1] @ h[:2, 1]])
    deep = np.array([h[2, 0] * h[2, 1], h[2, 0] ** 2 - h[2, 1] ** 2])
    lean = float(np.linalg.norm(h[2, :2])) * 0.5 * size[0]
    if lean < LEAST_LEAN:
        return None
    inverse = -float(flat @ deep) / max(float(flat @ flat), 1e-30)
    if inverse <= 0.0:
        return None
    view = 2.0 * degrees(atan(0.5 * size[0] * sqrt(inverse)))
    return view if VIEWS[0] <= view <= VIEWS[1] else None


def _lens(size: tuple[int, int], camera: Camera) -> Array:
    f = camera.focal_length(size[0])
    return np.array([[f, 0.0, 0.5 * size[0]], [0.0, f, 0.5 * size[1]], [0.0, 0.0, 1.0]])
