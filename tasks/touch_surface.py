"""How the touch surface of a task stands in the world, and the sides of an upright one."""

from __future__ import annotations

from math import cos, sin

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import stacked_applied
from models.objects import SceneObject
from models.surface import METRES_PER_INCH, Surface
from tasks.task import Task

BELOW_TABLE = 0.015
"""m by which an upright surface reaches below the table's top, so that fingers beside an object on
the table are still on the surface."""

_SHARES = np.linspace(0.0, 1.0, 50)
"""Of the height of a surface, at which points of its sides are looked at."""


def place_surface(surface: Surface, task: type[Task]) -> Surface:
    """Places a task's surface in the world: flat over the table, or upright before the person.

    A flat surface is `touch_height` above the table. An upright one is `touch_height` in front of
    world y = 0, the depth of the objects of an upright task.
    """
    if task.plane == "front":
        return surface.placed_upright(-task.touch_height, -BELOW_TABLE)
    return surface.centred_at((0.0, 0.0, task.touch_height))


def over_a_side(obj: SceneObject, surface: Surface) -> bool:
    """True if an object, as it starts before an upright surface, sticks out over a side of it.

    Nobody can grip it there, so that a session would put it back for ever.

    Args:
        obj: The object; its yaw is about the vertical.
        surface: The surface as placed in the world.
    """
    position = np.asarray(obj.position, float)
    x, _, off = stacked_applied(surface.rotation.T, position - surface.corner).tolist()
    if not 0.0 < x < surface.size[0]:
        return True
    c, s = cos(obj.yaw), sin(obj.yaw)
    turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return reaches_a_side(obj, position, turned, surface, (x, off))


def reaches_a_side(
    obj: SceneObject,
    position: Array,
    rotation: Array,
    surface: Surface,
    place: tuple[float, float],
) -> bool:
    """True if the nearer side of an upright surface runs through an object.

    Args:
        obj: The object.
        position: (3,) m, its middle in the world.
        rotation: (3, 3), world from object.
        surface: The surface as placed in the world.
        place: m, where its middle is along the surface, and how far off it.
    """
    x, off = place
    width, height = METRES_PER_INCH * surface.width_in, METRES_PER_INCH * surface.height_in
    side = 0.0 if x < width / 2 else width
    points = np.column_stack([np.full(len(_SHARES), side), height * _SHARES])
    return bool(obj.clearance(surface.to_world(points, off), position, rotation).min() < 0.0)
