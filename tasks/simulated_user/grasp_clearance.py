"""Chooses a grasp of a box with room for the fingers, beside neighbours and at its goal."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from math import cos, sin

import numpy as np

from models.arithmetic.arrays import Array
from models.objects import Box
from models.surface import Surface
from tasks.simulated_user.grasp import Grasp, grasp_across, wrapped
from tasks.simulated_user.hand import Hand
from tasks.simulated_user.screen import beyond_border
from tasks.user import SeenObject

_ROOM = 0.014
"""m, least distance of the middle of a fingertip from a neighbour's face."""
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
    hand: Hand,
    around: Surroundings,
    failed: Grasp | None = None,
    lacking: Callable[[Grasp], float] | None = None,
) -> Grasp:
    """Chooses faces and thumb side with the best compromise between room and comfort.

    Args:
        box: The box as seen, upright.
        turn: rad by which it is to be turned.
        hand: The hand of the user whose comfort counts.
        around: Objects that may be in the way, and the surface.
        failed: A grasp that has just failed.
        lacking: Returns room in m that a grasp lacks elsewhere, such as on the way to the goal.
    """
    assert isinstance(box.shape, Box)
    half = box.shape.half_size
    natural = hand.natural_axis
    options = []
    for quarter in range(4):
        axis = box.yaw + quarter * np.pi / 2
        start, end = axis - natural, axis + turn - natural
        width, face = (half[0], half[1]) if quarter % 2 == 0 else (half[1], half[0])
        grasp = grasp_across(axis, 2 * width, 2 * face, hand)
        cost = max(abs(wrapped(start)), abs(wrapped(end)))
        cost += _CROWDED * _missing_room(grasp, turn, box, hand, around)
        if lacking is not None:
            cost += _CROWDED * lacking(grasp)
        if failed and abs(wrapped(axis - failed.axis)) < np.pi / 4:
            cost += _AGAIN
        options.append((cost, quarter, grasp))
    return min(options, key=lambda o: o[:2])[2]


def _missing_room(
    grasp: Grasp, turn: float, box: SeenObject, hand: Hand, around: Surroundings
) -> float:
    """Missing room in m: beside neighbours, at the border, and at the border at the goal."""
    places = grasp.places(np.asarray(box.position[:2]), grasp.opening(hand), hand)
    short = max(_ROOM - _nearest(places, grasp.axis, float(box.position[2]), around.neighbours), 0)
    short += beyond_border(places, around.surface)
    if around.goal is not None:
        there = replace(grasp, axis=grasp.axis + turn)
        closed = there.places(around.goal, -hand.configuration.squeeze, hand)
        short += beyond_border(closed, around.surface)
    return short


def _nearest(places: Array, axis: float, height: float, neighbours: Iterable[SeenObject]) -> float:
    """Least distance in m of the middles of the fingers' last links to the other objects."""
    palm = np.array([sin(axis), -cos(axis)])
    links = [(places + along * palm, height + up) for along, up in ((0.0, 0.0), *_LINK)]
    points = np.vstack([np.column_stack([xy, np.full(len(xy), z)]) for xy, z in links])
    distances = [float(o.shape.clearance(points, o.position, o.rotation).min()) for o in neighbours]
    return min(distances, default=np.inf)
