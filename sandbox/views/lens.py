"""Projection between the world and a picture, in both directions.

Pixels count from the top left corner of the picture, x right and y down.
"""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.arithmetic import Array
from models.surface import Surface


@dataclass(frozen=True)
class Lens:
    """A camera as OpenGL uses it, with the size of its picture.

    Attributes:
        position: (3,) m, the eye.
        axes: (3, 3), rows right, up and forward; unit vectors in the world.
        half: (2,) half width and half height of the picture: at one metre for a perspective
            camera, anywhere for an orthographic one, m.
        orthographic: Rays are parallel.
        size: (2,) width and height, pixels.
    """

    position: Array
    axes: Array
    half: Array
    orthographic: bool
    size: tuple[int, int]

    @classmethod
    def of(cls, scene: mujoco.MjvScene, size: tuple[int, int]) -> Lens:
        """The camera that an updated MuJoCo scene is drawn with, on `size` pixels."""
        camera = mujoco.mjv_averageCamera(scene.camera[0], scene.camera[1])
        forward = np.array(camera.forward, float)
        up = np.array(camera.up, float)
        height = 0.5 * (camera.frustum_top - camera.frustum_bottom)
        if not camera.orthographic:
            height /= camera.frustum_near
        width = height * size[0] / size[1]
        return cls(
            np.array(camera.pos, float),
            np.stack([np.cross(forward, up), up, forward]),
            np.array([width, height]),
            bool(camera.orthographic),
            size,
        )

    def project(self, world: ArrayLike) -> tuple[Array, NDArray[np.bool_]]:
        """Pixels (..., 2) of world points (..., 3), and bool (...,) for points ahead of it."""
        seen = (np.asarray(world, float) - self.position) @ self.axes.T
        depth = seen[..., 2]
        ahead = depth > 1e-6
        scale = np.ones_like(depth) if self.orthographic else np.where(ahead, depth, 1.0)
        unit = seen[..., :2] / (scale[..., None] * self.half)
        pixels = (unit * np.array([0.5, -0.5]) + 0.5) * np.array(self.size, float)
        return pixels, ahead

    def ray(self, pixel: ArrayLike) -> tuple[Array, Array]:
        """Start (3,) and unit direction (3,) in the world of the line of sight of a pixel (2,)."""
        unit = (np.asarray(pixel, float) / np.array(self.size) - 0.5) * np.array([2.0, -2.0])
        sideways = (unit * self.half) @ self.axes[:2]
        if self.orthographic:
            return self.position + sideways, self.axes[2]
        direction = self.axes[2] + sideways
        return self.position, direction / np.linalg.norm(direction)

    def pick(self, pixel: ArrayLike, surface: Surface) -> Array | None:
        """The point (2,) of the surface's plane under a pixel (2,), in surface metres.

        None if the line of sight does not meet the plane.
        """
        start, direction = self.ray(pixel)
        normal = surface.rotation[:, 2]
        towards = float(direction @ normal)
        if abs(towards) < 1e-9:
            return None
        away = float((np.asarray(surface.origin) - start) @ normal) / towards
        if away <= 0.0:
            return None
        return surface.to_surface(start + away * direction)
