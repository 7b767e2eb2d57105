"""What a finger before an upright surface cannot get at."""

from __future__ import annotations

from math import cos, sin

import numpy as np

from models.objects import SceneObject
from models.surface import Surface

_SHARES = np.linspace(0.0, 1.0, 50)
"""Of the height of a surface, at which points of its sides are looked at."""


def over_a_side(thing: SceneObject, surface: Surface) -> bool:
    """True if an object, as it starts before an upright surface, sticks out over a side of it.

    Nobody can grip it there, so that a session would put it back for ever.

    Args:
        thing: The object; its yaw is about the vertical.
        surface: The surface as placed in the world.
    """
    position = np.asarray(thing.position, float)
    away = surface.rotation.T @ (position - surface.corner)
    x, off = float(away[0]), float(away[2])
    width, height = surface.size.tolist()
    if not 0.0 < x < width:
        return True
    side = 0.0 if x < width / 2 else width
    points = surface.to_world(np.column_stack([np.full(len(_SHARES), side), height * _SHARES]), off)
    c, s = cos(thing.yaw), sin(thing.yaw)
    turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return bool(thing.clearance(points, position, turned).min() < 0.0)
