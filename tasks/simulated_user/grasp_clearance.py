"""Chooses a grasp of a box with room for the fingers, beside neighbours and at its goal."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import cos, sin

import numpy as np

from models.arithmetic.arrays import Array
from models.objects import Box
from models.surface import Surface
from tasks.simulated_user.grasp import Grasp, wrapped
from tasks.user import SeenObject, UserConfiguration

_ROOM = 0.014
"""m, least distance of the middle of a fingertip from a neighbour's face."""
_EDGE = 0.003
"""m, least distance of a finger from the border of the screen."""
_CROWDED = 150.0
"""rad/m, additional rotation of the wrist that is as bad as lacking one metre of room."""
_AGAIN = 2.0
"""rad, additional rotation of the wrist that is as bad as repeating a grasp that has just
failed."""
_LINK = ((0.010, 0.010), (0.018, 0.020))
"""m from a fingertip towards the palm, and upwards, to the rest of the finger, which leans over
objects on that side."""


@dataclass(frozen=True)
class Surroundings:
    """The surroundings of a box to grasp, as the user sees them.

    Attributes:
        surface: The area that fingers can touch.
        neighbours: The other objects.
        goal: (2,) m, goal of the box; None to ignore the goal.
    """

    surface: Surface
    neighbours: tuple[SeenObject, ...] = ()
    goal: Array | None = None


def roomiest_grasp(
    box: SeenObject,
    turn: float,
    c: UserConfiguration,
    around: Surroundings,
    failed: Grasp | None = None,
) -> Grasp:
    """Chooses faces and thumb side with the best compromise between room and comfort.

    Args:
        box: The box as seen, upright.
        turn: rad by which it is to be turned.
        c: The user whose comfort counts.
        around: Objects that may be in the way, and the surface.
        failed: A grasp that has just failed.
    """
    assert isinstance(box.shape, Box)
    half = box.shape.half_size
    options = []
    for quarter in range(4):
        axis = box.yaw + quarter * np.pi / 2
        start, end = axis - c.natural_axis, axis + turn - c.natural_axis
        width, face = (half[0], half[1]) if quarter % 2 == 0 else (half[1], half[0])
        grasp = Grasp(axis, 2 * width, 2 * face)
        cost = max(abs(wrapped(start)), abs(wrapped(end)))
        cost += _CROWDED * _missing_room(grasp, turn, box, c, around)
        if failed and abs(wrapped(axis - failed.axis)) < np.pi / 4:
            cost += _AGAIN
        options.append((cost, quarter, grasp))
    return min(options, key=lambda o: o[:2])[2]


def _missing_room(
    grasp: Grasp, turn: float, box: SeenObject, c: UserConfiguration, around: Surroundings
) -> float:
    """Missing room in m: beside neighbours, at the border, and at the border at the goal."""
    places = grasp.places(np.asarray(box.position[:2]), c.opening, c)
    short = max(_ROOM - _nearest(places, grasp.axis, float(box.position[2]), around.neighbours), 0)
    short += _beyond(places, around.surface)
    if around.goal is not None:
        there = replace(grasp, axis=grasp.axis + turn)
        short += _beyond(there.places(around.goal, -c.squeeze, c), around.surface)
    return short


def _nearest(places: Array, axis: float, height: float, neighbours: Iterable[SeenObject]) -> float:
    """Least distance in m of the middles of the fingers' last links to the other objects."""
    palm = np.array([sin(axis), -cos(axis)])
    links = [(places + along * palm, height + up) for along, up in ((0.0, 0.0), *_LINK)]
    points = np.vstack([np.column_stack([xy, np.full(len(xy), z)]) for xy, z in links])
    distances = [float(o.shape.clearance(points, o.position, o.rotation).min()) for o in neighbours]
    return min(distances, default=np.inf)


def _beyond(places: Array, surface: Surface) -> float:
    """Distance in m by which fingers would have to touch beyond the border."""
    xy = surface.to_surface(np.column_stack([places, np.zeros(len(places))]))
    return float(max(_EDGE - min(xy.min(), (surface.size - xy).min()), 0.0))
