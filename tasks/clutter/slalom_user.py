"""Simulated user who drags a box between standing things, along a way that keeps clear of them."""

from __future__ import annotations

from dataclasses import replace
from math import cos, sin

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length, matrix_product, small_product
from models.objects import Box
from models.surface import Surface
from tasks.clutter.clear_way import Footprint, clear_leg, lacking_room
from tasks.simulated_user.grasp import Grasp
from tasks.simulated_user.grasp_clearance import Surroundings, roomiest_grasp
from tasks.simulated_user.hand import Hand
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.user import SkilledUser
from tasks.user import SeenObject, Sight, UserConfiguration

_TIP = 0.008
"""m, radius of a fingertip as the user assumes it, with a little room."""
_LEANS, _THUMB_LEANS = (0.006,), (0.012, 0.024)
"""m from a fingertip outwards to points of the finger, and of the thumb, that are still lower than
things to go round: both lean outwards, fingers only a little before they arch over the box."""
_THERE = 0.006
"""m from its goal, within which a box is turned."""
_SHARES = (-1.0, -0.5, 0.0, 0.5, 1.0)
"""Shares of half an edge, at which points on a box's outline are looked at."""


class AmongHandling(BoxHandling):
    """Handling of a box among things that must not be touched.

    Args:
        surface: The screen.

    Attributes:
        around: What is in the way, and the goal.
    """

    def __init__(self, surface: Surface) -> None:
        self.around = Surroundings(surface)

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp across the faces with the best compromise between comfort and room: where the
        fingers come down, and on the way to the goal."""
        place, goal = np.asarray(seen.position[:2]), self.around.goal
        assert goal is not None and isinstance(seen.shape, Box)
        half = seen.shape.half_size

        def lacking(grasp: Grasp) -> float:
            at_start = footprint(seen.rotation, half, grasp.places(np.zeros(2), 0.0, hand))
            there = replace(grasp, axis=grasp.axis + turn).places(np.zeros(2), 0.0, hand)
            at_goal = footprint(matrix_product(_about_z(turn), seen.rotation), half, there)
            around = self.around
            return lacking_room(place, goal, at_start, at_goal, around.neighbours, around.surface)

        return roomiest_grasp(seen, turn, hand, self.around, failed, lacking)


class SlalomUser(SkilledUser):
    """Drags a box to its goal in legs, each of them clear of all other things on the table.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
    """

    drags = 20

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._among = AmongHandling(surface)
        self._handling = self._among

    def _act(self, sight: Sight, now: float) -> None:
        (goal,) = sight.goals
        self._among.around = Surroundings(
            self.surface,
            tuple(o for name, o in sight.objects.items() if name != goal.object),
            np.asarray(goal.position[:2]),
        )
        super()._act(sight, now)

    def _leg(self, sight: Sight, box: SeenObject, off: Array, turn: float) -> tuple[Array, float]:
        """The part of the way to go next; the box is turned once it is there."""
        if length(off) < _THERE:
            return off, turn
        place = np.asarray(box.position[:2])
        ids = self._fingers.ids()
        assert self._grasp is not None and isinstance(box.shape, Box)
        tips = (
            np.array([sight.tips[i][:2] for i in ids]) - place
            if all(i in sight.tips for i in ids)
            else self._grasp.places(np.zeros(2), 0.0, self._hand)
        )
        things = self._among.around.neighbours
        moved = footprint(box.rotation, box.shape.half_size, tips)
        leg = clear_leg(place, place + off, moved, things, self.surface)
        return leg, 0.0


def _about_z(turn: float) -> Array:
    """Rotation (3, 3) by an angle, rad, about the vertical."""
    c, s = cos(turn), sin(turn)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def footprint(rotation: Array, half_size: tuple[float, float, float], tips: Array) -> Footprint:
    """What moves along with a box: its outline and the fingers.

    Args:
        rotation: (3, 3) of the box.
        half_size: (3,) m, half its edges.
        tips: (n, 2) m from its middle, thumb first.
    """
    a, b, _ = half_size
    on_edges = [(s, t) for s in _SHARES for t in _SHARES if max(abs(s), abs(t)) == 1.0]
    within = [(s, t) for s in (-0.5, 0.0, 0.5) for t in (-0.5, 0.0, 0.5)]
    places = small_product(np.array(on_edges + within) * (a, b), rotation[:2, :2].T)
    outwards = [tip / length(tip) for tip in tips]
    leaning = [
        tip + way * out
        for i, (tip, out) in enumerate(zip(tips, outwards, strict=True))
        for way in (_LEANS if i else _THUMB_LEANS)
    ]
    fingers = np.vstack([tips, *leaning])
    radii = [0.0] * len(on_edges) + [0.5 * min(a, b)] * len(within) + [_TIP] * len(fingers)
    return Footprint(np.vstack([places, fingers]), np.array(radii), tips)
