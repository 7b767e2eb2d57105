"""The simulated user's handling of an object of unknown kind, by its outline."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import small_product
from models.mjcf_object import MjcfObject
from models.objects import Box
from tasks.simulated_user.grasp import Grasp, choose_grasp, within_comfort
from tasks.simulated_user.hand import Hand
from tasks.task import Goal
from tasks.user import SeenObject


@dataclass(frozen=True)
class OutlineGrasp(Grasp):
    """A pinch across the bounding box of an object.

    Attributes:
        offset: (2,) m, the box's middle in the frame of the object as it is seen from above.
    """

    offset: tuple[float, float] = (0.0, 0.0)

    def middle(self, seen: SeenObject) -> Array:
        """Position (2,) m of the box's middle in the world."""
        return np.asarray(seen.position[:2] + small_product(seen.rotation[:2, :2], self.offset))


class OutlineHandling:
    """Handling of an object of any shape, grasped like its bounding box.

    Args:
        obj: The object, with its outline and rotational symmetry.
    """

    good = (0.003, float(np.deg2rad(2.5)))
    enough = (0.006, float(np.deg2rad(6.0)))
    patience = 14

    def __init__(self, obj: MjcfObject) -> None:
        low, high = obj.bounds
        half = 0.5 * (high - low)
        self._symmetry = obj.symmetry
        self._middle = 0.5 * (low + high)
        self._box = Box(obj.name, (half[0], half[1], half[2]), obj.mass, obj.position)

    def missing(self, seen: SeenObject, goal: Goal) -> tuple[Array, float]:
        """Missing movement to the nearest equivalent pose; a round object needs no turn."""
        off = np.asarray(goal.position[:2]) - seen.position[:2]
        if self._symmetry == 0:
            return off, 0.0
        part = 2 * np.pi / self._symmetry
        return off, float((goal.yaw - seen.yaw + part / 2) % part - part / 2)

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp across the most comfortable sides of the bounding box: thumb and fingers opposite
        each other, on the middle half, as outlines may be round."""
        about = SeenObject(self._box, seen.position, seen.rotation)
        grasp = choose_grasp(about, turn, hand)
        a, b, _ = self._box.half_size
        face = 2 * b if grasp.width == 2 * a else 2 * a
        x, y = self._middle[:2].tolist()
        on_middle = {"side": grasp.axis - seen.yaw, "skew": 0.0, "fingers": hand.fitting(face / 2)}
        return OutlineGrasp(
            **{**vars(grasp), **on_middle},
            offset=(x, -y if seen.mirrored else y),
        )

    def pivot(self, seen: SeenObject) -> Array:
        """The object's origin, to which goals refer."""
        return np.array(seen.position[:2])

    def reach(self, seen: SeenObject, grasp: Grasp, turn: float, hand: Hand) -> float:
        """Part of the turn that the wrist allows."""
        return within_comfort(grasp.axis_on(seen.yaw), turn, hand)
