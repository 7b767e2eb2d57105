"""Which of the ways to grasp a box leaves room for the fingers beside its neighbours."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from models.objects import Box
from models.surface import Surface
from tasks.simulated_user.configuration import UserConfiguration
from tasks.simulated_user.grasp import Grasp
from tasks.simulated_user.sight import SeenObject

Array = NDArray[np.float64]

_ROOM = 0.014
"""m that a fingertip's middle should stay away from a neighbour's face, or 7 mm from the border."""
_CROWDED = 150.0
"""rad/m: how much turning of the wrist a person accepts for room."""


def roomiest_grasp(
    box: SeenObject,
    turn: float,
    c: UserConfiguration,
    neighbours: Iterable[SeenObject],
    surface: Surface,
) -> Grasp:
    """The pair of faces, and the side for the thumb, with the best of room and comfort.

    Args:
        box: As it is seen, upright.
        turn: rad by which it is to be turned.
        c: Whose comfort.
        neighbours: What else stands around.
        surface: Where fingers can touch.
    """
    assert isinstance(box.shape, Box)
    half = box.shape.half_size
    options = []
    for quarter in range(4):
        axis = box.yaw + quarter * np.pi / 2
        start, end = axis - c.natural_axis, axis + turn - c.natural_axis
        width, face = (half[0], half[1]) if quarter % 2 == 0 else (half[1], half[0])
        grasp = Grasp(axis, 2 * width, 2 * face)
        short = max(_ROOM - _room(grasp, box, c, neighbours, surface), 0.0)
        cost = max(abs(_wrapped(start)), abs(_wrapped(end))) + _CROWDED * short
        options.append((cost, quarter, grasp))
    return min(options, key=lambda o: o[:2])[2]


def _room(
    grasp: Grasp,
    box: SeenObject,
    c: UserConfiguration,
    neighbours: Iterable[SeenObject],
    surface: Surface,
) -> float:
    """m, least distance of the opened fingers' middles to neighbours, or to 7 mm off the border."""
    places = grasp.places(np.asarray(box.position[:2]), c.opening, c)
    points = np.column_stack([places, np.full(len(places), box.position[2])])
    xy = surface.to_surface(points)
    room = float(min(xy.min(), (surface.size - xy).min())) + 0.007
    for other in neighbours:
        room = min(room, float(other.shape.clearance(points, other.position, other.rotation).min()))
    return room


def _wrapped(angle: float) -> float:
    return float((angle + np.pi) % (2 * np.pi) - np.pi)
