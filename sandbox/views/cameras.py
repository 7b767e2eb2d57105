"""Cameras of films and windows, and the projection between the world and a picture."""

from __future__ import annotations

from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.arithmetic import Array
from models.surface import Surface
from sandbox.session.messages import Snapshot

FILM_AZIMUTH, FILM_ELEVATION, FILM_DISTANCE = 28.0, -31.0, 0.43
"""Camera of films (deg, deg, m): from above, on the thumb's side of a right hand. From there, the
hand hides neither the object nor the goal. Chosen by comparing pictures."""

WINDOW_AZIMUTH, WINDOW_ELEVATION, WINDOW_DISTANCE = 58.0, -50.0, 0.40
"""Camera of the window (deg, deg, m): close to the person's own view, so that right and away of the
mouse are right and up in the picture. It is turned just enough to show the thumb and the object at
it."""

AIR_AZIMUTH, AIR_ELEVATION, AIR_DISTANCE, AIR_MIDDLE = 54.0, -34.0, 0.47, 0.055
"""Camera for hands in the air (deg, deg, m, and height of its target over the table, m): lower and
farther away, so that a raised hand is in the picture and its height is visible. Chosen by comparing
pictures."""

FRONT_FILM_AZIMUTH, FRONT_FILM_ELEVATION, FRONT_FILM_DISTANCE = 64.0, -14.0, 0.42
"""Camera of films in front of an upright surface (deg, deg, m): turned to the thumb's side far
enough to show a box between thumb and fingers, and raised, to show the table and stacked objects.
"""

TWO_AZIMUTH, TWO_ELEVATION, TWO_DISTANCE = 82.0, -48.0, 1.35
"""Camera for a film of two hands (deg, deg, and multiples of the surface's width): from the
person's side, since hands from both sides hide the objects behind them."""

FRONT_AZIMUTH, FRONT_ELEVATION, FRONT_DISTANCE = 90.0, -8.0, 0.36
"""The person's own view of an upright surface (deg, deg, m). Hands must be drawn translucent, since
they are in front of the held objects."""


def film_camera(snapshot: Snapshot, surface: Surface) -> mujoco.MjvCamera:
    """Returns a camera that shows the objects, their goals and the hand over them."""
    if surface.upright:
        return _front(surface, FRONT_FILM_AZIMUTH, FRONT_FILM_ELEVATION, FRONT_FILM_DISTANCE)
    places = [o.position for o in snapshot.objects.values()]
    places += [np.asarray(goal.position) for goal in snapshot.goals]
    middle = np.mean(places, axis=0) if places else _middle(surface)
    spread = max((float(np.linalg.norm((p - middle)[:2])) for p in places), default=0.0)
    distance = FILM_DISTANCE + 1.2 * max(spread - 0.04, 0.0)
    if len(snapshot.hands) > 1:
        # Hands come from both sides, so centre the surface.
        middle = np.array([*_middle(surface)[:2], middle[2]])
        return _at(middle, TWO_AZIMUTH, TWO_ELEVATION, TWO_DISTANCE * float(surface.size[0]))
    camera = _free(FILM_AZIMUTH, FILM_ELEVATION, distance)
    # Shift the picture's centre up and towards the person, where the hand is.
    camera.lookat[:] = middle + np.array([0.005, -0.022, 0.042])
    return camera


def window_camera(surface: Surface, in_air: bool = False) -> mujoco.MjvCamera:
    """Returns a camera that shows the whole surface from the person's side.

    Args:
        surface: The touch surface.
        in_air: True if the camera must also show the space above the surface.
    """
    if surface.upright:
        return _front(surface, FRONT_AZIMUTH, FRONT_ELEVATION, FRONT_DISTANCE)
    size = float(np.max(surface.size))
    scale = max(size / 0.197, 0.6)
    if in_air:
        camera = _free(AIR_AZIMUTH, AIR_ELEVATION, AIR_DISTANCE * scale)
        camera.lookat[:] = _middle(surface) + np.array([0.0, 0.0, AIR_MIDDLE])
        return camera
    camera = _free(WINDOW_AZIMUTH, WINDOW_ELEVATION, WINDOW_DISTANCE * scale)
    camera.lookat[:] = _middle(surface) + np.array([0.0, -0.01, 0.012])
    return camera


def camera_above(surface: Surface) -> mujoco.MjvCamera:
    """Returns a camera perpendicular to the surface, x to the right, without perspective."""
    camera = _free(90.0, 0.0 if surface.upright else -90.0, 0.6)
    camera.orthographic = 1
    camera.lookat[:] = _middle(surface)
    return camera


def _at(middle: np.ndarray, azimuth: float, elevation: float, distance: float) -> mujoco.MjvCamera:
    camera = _free(azimuth, elevation, distance)
    camera.lookat[:] = middle
    return camera


def _front(surface: Surface, azimuth: float, elevation: float, distance: float) -> mujoco.MjvCamera:
    size = float(np.max(surface.size))
    camera = _free(azimuth, elevation, distance * max(size / 0.197, 0.6))
    camera.lookat[:] = _middle(surface)
    return camera


def _middle(surface: Surface) -> np.ndarray:
    return surface.to_world(surface.size / 2)


def _free(azimuth: float, elevation: float, distance: float) -> mujoco.MjvCamera:
    camera = mujoco.MjvCamera()
    camera.type = mujoco.mjtCamera.mjCAMERA_FREE
    camera.azimuth, camera.elevation, camera.distance = azimuth, elevation, distance
    return camera


@dataclass(frozen=True)
class Lens:
    """A camera as OpenGL uses it, with the size of its picture.

    Attributes:
        position: (3,) m, the eye.
        axes: (3, 3), rows right, up and forward; unit vectors in the world.
        half: (2,) m, half width and half height of the visible area: for a perspective camera, at a
            distance of one metre; for an orthographic camera, at any distance.
        orthographic: True if rays are parallel.
        size: (2,) px, width and height of the picture.
    """

    position: Array
    axes: Array
    half: Array
    orthographic: bool
    size: tuple[int, int]

    @classmethod
    def of(cls, scene: mujoco.MjvScene, size: tuple[int, int]) -> Lens:
        """Returns the camera of an updated MuJoCo scene, for a picture of `size` pixels."""
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
        """Returns pixels (..., 2) of world points (..., 3), and bool (...,): True for points in
        front of the camera."""
        seen = (np.asarray(world, float) - self.position) @ self.axes.T
        depth = seen[..., 2]
        ahead = depth > 1e-6
        scale = np.ones_like(depth) if self.orthographic else np.where(ahead, depth, 1.0)
        unit = seen[..., :2] / (scale[..., None] * self.half)
        pixels = (unit * np.array([0.5, -0.5]) + 0.5) * np.array(self.size, float)
        return pixels, ahead

    def ray(self, pixel: ArrayLike) -> tuple[Array, Array]:
        """Returns start (3,) and unit direction (3,), in the world, of the ray of a pixel (2,)."""
        unit = (np.asarray(pixel, float) / np.array(self.size) - 0.5) * np.array([2.0, -2.0])
        sideways = (unit * self.half) @ self.axes[:2]
        if self.orthographic:
            return self.position + sideways, self.axes[2]
        direction = self.axes[2] + sideways
        return self.position, direction / np.linalg.norm(direction)

    def pick(self, pixel: ArrayLike, surface: Surface) -> Array | None:
        """Returns the point (2,) of the surface's plane under a pixel (2,), m in surface axes.

        Returns None if the ray does not meet the plane.
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
