"""How a person goes about a thing they have never seen: by its outline."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from models.mjcf_thing import MjcfThing
from models.objects import Box
from tasks.simulated_user.grasp import Grasp, choose_grasp, within_comfort
from tasks.task import Goal
from tasks.user import SeenObject, UserConfiguration

Array = NDArray[np.float64]


@dataclass(frozen=True)
class OutlineGrasp(Grasp):
    """A pinch across the box about a thing.

    Attributes:
        offset: (2,) m, the box's middle in the thing's frame, as seen from above.
    """

    offset: tuple[float, float] = (0.0, 0.0)

    def middle(self, seen: SeenObject) -> Array:
        """(2,) m, the box's middle in the world."""
        return np.asarray(seen.position[:2] + seen.rotation[:2, :2] @ self.offset)


class OwnHandling:
    """A thing of any shape is grasped like the box about it.

    Args:
        thing: Its outline, and how often it looks the same in a turn.
    """

    good = (0.003, float(np.deg2rad(2.5)))
    enough = (0.006, float(np.deg2rad(6.0)))
    patience = 14

    def __init__(self, thing: MjcfThing) -> None:
        low, high = thing.bounds
        half = 0.5 * (high - low)
        self._looks_alike = thing.looks_alike
        self._middle = 0.5 * (low + high)
        self._box = Box(thing.name, (half[0], half[1], half[2]), thing.mass, thing.position)

    def missing(self, seen: SeenObject, goal: Goal) -> tuple[Array, float]:
        """To the nearest place that looks alike; a round thing is turned right as it is."""
        off = np.asarray(goal.position[:2]) - seen.position[:2]
        if self._looks_alike == 0:
            return off, 0.0
        part = 2 * np.pi / self._looks_alike
        return off, float((goal.yaw - seen.yaw + part / 2) % part - part / 2)

    def grasp(
        self, seen: SeenObject, turn: float, c: UserConfiguration, failed: Grasp | None = None
    ) -> Grasp:
        """Across the most comfortable sides of the box about it."""
        about = SeenObject(self._box, seen.position, seen.rotation)
        grasp = choose_grasp(about, turn, c)
        return OutlineGrasp(
            **{**vars(grasp), "side": grasp.axis - seen.yaw},
            offset=(float(self._middle[0]), float(self._middle[1])),
        )

    def pivot(self, seen: SeenObject) -> Array:
        """Its origin, which is what goals are about."""
        return np.array(seen.position[:2])

    def reach(self, seen: SeenObject, grasp: Grasp, turn: float, c: UserConfiguration) -> float:
        """As far as the wrist goes."""
        return within_comfort(grasp.axis_on(seen.yaw), turn, c)
