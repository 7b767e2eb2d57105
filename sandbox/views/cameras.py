"""Cameras of films and windows."""

from __future__ import annotations

import mujoco
import numpy as np

from models.surface import Surface
from sandbox.session.messages import Snapshot

FILM_AZIMUTH, FILM_ELEVATION, FILM_DISTANCE = 28.0, -31.0, 0.43
"""deg, deg, m. From above on the thumb's side of a right hand, which hides neither the object nor
the goal from there; chosen by looking at pictures."""

WINDOW_AZIMUTH, WINDOW_ELEVATION, WINDOW_DISTANCE = 58.0, -50.0, 0.40
"""deg, deg, m. Close to the person's own view, so that the mouse's right and away agree with those
in the picture; turned just enough to show the thumb and what it touches."""

AIR_AZIMUTH, AIR_ELEVATION, AIR_DISTANCE, AIR_MIDDLE = 54.0, -34.0, 0.47, 0.055
"""deg, deg, m, and m over the table, for hands in the air: lower and farther away, so that a raised
hand is in the picture and its height can be seen; chosen by looking at pictures."""

FRONT_FILM_AZIMUTH, FRONT_FILM_ELEVATION, FRONT_FILM_DISTANCE = 64.0, -14.0, 0.42
"""deg, deg, m, before an upright surface: turned to the thumb's side far enough to see a box
between thumb and fingers, and from above, so that the table and stacked objects can be seen."""

TWO_AZIMUTH, TWO_ELEVATION, TWO_DISTANCE = 82.0, -48.0, 1.35
"""deg, deg, and multiples of the surface's width, for a film of two hands: from the person's side,
as hands that come from both sides hide what is behind them."""

FRONT_AZIMUTH, FRONT_ELEVATION, FRONT_DISTANCE = 90.0, -8.0, 0.36
"""deg, deg, m, the person's own view of an upright surface. Hands must be drawn translucent, since
they are in front of what they hold."""


def film_camera(snapshot: Snapshot, surface: Surface) -> mujoco.MjvCamera:
    """A camera that shows the objects, their goals and the hand over them."""
    if surface.upright:
        return _front(surface, FRONT_FILM_AZIMUTH, FRONT_FILM_ELEVATION, FRONT_FILM_DISTANCE)
    places = [o.position for o in snapshot.objects.values()]
    places += [np.asarray(goal.position) for goal in snapshot.goals]
    middle = np.mean(places, axis=0) if places else _middle(surface)
    spread = max((float(np.linalg.norm((p - middle)[:2])) for p in places), default=0.0)
    distance = FILM_DISTANCE + 1.2 * max(spread - 0.04, 0.0)
    if len(snapshot.hands) > 1:
        # Hands come from both sides, wherever the objects are.
        middle = np.array([*_middle(surface)[:2], middle[2]])
        return _at(middle, TWO_AZIMUTH, TWO_ELEVATION, TWO_DISTANCE * float(surface.size[0]))
    camera = _free(FILM_AZIMUTH, FILM_ELEVATION, distance)
    # The picture's centre is shifted up and towards the person, where the hand is.
    camera.lookat[:] = middle + np.array([0.005, -0.022, 0.042])
    return camera


def window_camera(surface: Surface, in_air: bool = False) -> mujoco.MjvCamera:
    """A camera that shows the whole surface from the person's side.

    Args:
        surface: The touch surface.
        in_air: The camera also shows the space above the surface.
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
    """A camera perpendicular to the surface, x to the right, without perspective."""
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
