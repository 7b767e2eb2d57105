"""The simulated user's handling of each kind of object: missing movement, grasp and pivot.

The user sees an object's shape, position and rotation, and whether a wrench is on a bolt. An object
of unknown kind is handled by its outline.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from models.arithmetic import Array, small_product
from models.errors import InputError
from models.objects import JAW, Box, SceneObject, Wrench
from tasks.simulated_user.grasp import Grasp, choose_grasp, choose_handle_grasp, within_comfort
from tasks.simulated_user.user_hand import Hand
from tasks.task import Goal
from tasks.user import SeenObject

if TYPE_CHECKING:
    from models.mjcf_object import MjcfObject


@dataclass(frozen=True)
class OutlineGrasp(Grasp):
    """A pinch across the bounding box of an object.

    Attributes:
        offset: (2,) m, middle of the bounding box in the frame of the object, seen from above.
    """

    offset: tuple[float, float] = (0.0, 0.0)

    def middle(self, seen: SeenObject) -> Array:
        """Position (2,) m of the bounding box's middle in the world."""
        return np.asarray(seen.position[:2] + small_product(seen.rotation[:2, :2], self.offset))


class OutlineHandling:
    """Handling of an object of any shape, which is grasped like its bounding box.

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
        """Grasp across the most comfortable sides of the bounding box.

        Thumb and fingers are opposite each other on the middle half of the sides, since the outline
        may be round.
        """
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


_TURN_GRIP, _SLIDE_GRIP = 0.032, 0.004
"""Positions (m) of the grip along a wrench of size 1: near the handle's end for the longest lever
about a bolt, and at the middle of a free wrench."""
_LEVER = _TURN_GRIP - JAW
"""Distance (m) from a bolt to the grip on a long handle. A grip farther out would soon leave the
screen."""
_ROOM = 0.030
"""Least distance (m) from the beginning of a handle to the grip."""


class Handling(Protocol):
    """Contract for moving one kind of object.

    Attributes:
        good: Errors (m, rad) within which the user lets go.
        enough: Errors (m, rad) within which the user does not touch an object at rest again.
        patience: Number of looks at a hand that remains a ghost before the user lifts it.
    """

    good: tuple[float, float]
    enough: tuple[float, float]
    patience: int

    def missing(self, seen: SeenObject, goal: Goal) -> tuple[Array, float]:
        """Remaining shift (2,) m and turn (rad) from the object as seen to its goal."""
        ...

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp for thumb and fingers; `failed` is the grasp that has just failed."""
        ...

    def pivot(self, seen: SeenObject) -> Array:
        """Pivot (2,) m of a turn."""
        ...

    def reach(self, seen: SeenObject, grasp: Grasp, turn: float, hand: Hand) -> float:
        """Part (rad) of a turn that this grasp allows."""
        ...


class BoxHandling:
    """Handling of a box. It is grasped in its middle, and looks the same after a quarter turn."""

    good = (0.003, float(np.deg2rad(2.5)))
    enough = (0.008, float(np.deg2rad(8.0)))
    patience = 14

    def missing(self, seen: SeenObject, goal: Goal) -> tuple[Array, float]:
        """Missing movement to the nearest of the four equivalent poses."""
        quarter = np.pi / 2
        turn = (goal.yaw - seen.yaw + quarter / 2) % quarter - quarter / 2
        return np.asarray(goal.position[:2]) - seen.position[:2], float(turn)

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp across the most comfortable faces."""
        return choose_grasp(seen, turn, hand)

    def pivot(self, seen: SeenObject) -> Array:
        """The middle of the box."""
        return np.array(seen.position[:2])

    def reach(self, seen: SeenObject, grasp: Grasp, turn: float, hand: Hand) -> float:
        """The whole turn; it is at most an eighth of a full turn."""
        return turn


class WrenchHandling:
    """Handling of a wrench: grasped across its handle, and regrasped after a large turn.

    Args:
        wrench: The wrench; on a bolt it can only turn about the bolt.
    """

    def __init__(self, wrench: Wrench) -> None:
        self._wrench = wrench
        self._bolted = wrench.bolt is not None
        self._grip = wrench.size * (_TURN_GRIP if self._bolted else _SLIDE_GRIP)
        if self._bolted and wrench.size > 1.0:
            self._grip = max(wrench.jaw + _LEVER, wrench.handle[0] + _ROOM)
        self.patience = 8
        self.good = (0.003, float(np.deg2rad(2.0)))
        self.enough = (0.007, float(np.deg2rad(3.5 if self._bolted else 5.5)))

    def missing(self, seen: SeenObject, goal: Goal) -> tuple[Array, float]:
        """Missing turn of the handle, and shift of the middle of a free wrench."""
        turn = float((goal.yaw - seen.yaw + np.pi) % (2 * np.pi) - np.pi)
        off = np.asarray(goal.position[:2]) - seen.position[:2]
        return (np.zeros(2) if self._bolted else off), turn

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp with thumb and fingers on either side of the handle; the sides are swapped after a
        failed grasp."""
        return choose_handle_grasp(seen, turn, self._grip, hand, failed.side if failed else None)

    def pivot(self, seen: SeenObject) -> Array:
        """The bolt, or a free wrench's middle."""
        if self._bolted:
            return np.array(self._wrench.bolt_place(seen.position[:2], seen.yaw))
        return np.array(seen.position[:2])

    def reach(self, seen: SeenObject, grasp: Grasp, turn: float, hand: Hand) -> float:
        """Part of the turn that the wrist allows."""
        return within_comfort(grasp.axis_on(seen.yaw), turn, hand)


def handling_of(shape: SceneObject) -> Handling:
    """Creates the handling of an object of this shape."""
    if isinstance(shape, Box):
        return BoxHandling()
    if isinstance(shape, Wrench):
        return WrenchHandling(shape)
    # Imported here because most tasks have no object from MJCF.
    from models.mjcf_object import MjcfObject

    if not isinstance(shape, MjcfObject):
        raise InputError(
            "the simulated user cannot handle this object",
            got=type(shape).__name__,
            expected="Box, Wrench or MjcfObject",
            remedy="Give the task its own simulated user: docs/write-a-task.md",
        )
    return OutlineHandling(shape)
