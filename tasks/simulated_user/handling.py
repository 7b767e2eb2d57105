"""How a person goes about a kind of thing: what is still missing, where to grasp, what it turns on.

What a person sees of a thing is its shape, place and turn. A wrench on a bolt is seen to be on one.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError
from models.mjcf_thing import MjcfThing
from models.objects import JAW, Box, Thing, Wrench
from tasks.simulated_user.grasp import Grasp, choose_grasp, choose_handle_grasp, within_comfort
from tasks.simulated_user.own_handling import OwnHandling
from tasks.task import Goal
from tasks.user import SeenObject, UserConfiguration

Array = NDArray[np.float64]

_TURN_GRIP, _SLIDE_GRIP = 0.032, 0.004
"""m along a wrench of size 1, where fingers close: near the handle's end for the longest lever
about a bolt, at the middle of a free one."""
_LEVER = _TURN_GRIP - JAW
"""m from a bolt to where fingers close; on a longer handle no farther out, where the way is longer
and soon off the screen."""
_ROOM = 0.030
"""m of a handle, at least, between its beginning and where fingers close."""


class Handling(Protocol):
    """What a person knows about moving one kind of thing.

    Attributes:
        good: m and rad within which they are content and let go.
        enough: m and rad within which a thing that lies still is not touched again.
        patience: How often they look at a hand that stays a ghost before they lift it.
    """

    good: tuple[float, float]
    enough: tuple[float, float]
    patience: int

    def missing(self, seen: SeenObject, goal: Goal) -> tuple[Array, float]:
        """Shift (2,) m and turn, rad, from the thing as seen to its goal."""
        ...

    def grasp(
        self, seen: SeenObject, turn: float, c: UserConfiguration, failed: Grasp | None = None
    ) -> Grasp:
        """Where thumb and fingers go; `failed` is how they came down in vain just now."""
        ...

    def pivot(self, seen: SeenObject) -> Array:
        """(2,) m, what a turn goes about."""
        ...

    def reach(self, seen: SeenObject, grasp: Grasp, turn: float, c: UserConfiguration) -> float:
        """rad of the turn that this grasp allows."""
        ...


class BoxHandling:
    """A box is grasped in its middle and looks the same every quarter turn."""

    good = (0.003, float(np.deg2rad(2.5)))
    enough = (0.008, float(np.deg2rad(8.0)))
    patience = 14

    def missing(self, seen: SeenObject, goal: Goal) -> tuple[Array, float]:
        """To the nearest of the four places that look alike."""
        quarter = np.pi / 2
        turn = (goal.yaw - seen.yaw + quarter / 2) % quarter - quarter / 2
        return np.asarray(goal.position[:2]) - seen.position[:2], float(turn)

    def grasp(
        self, seen: SeenObject, turn: float, c: UserConfiguration, failed: Grasp | None = None
    ) -> Grasp:
        """Across the most comfortable faces."""
        return choose_grasp(seen, turn, c)

    def pivot(self, seen: SeenObject) -> Array:
        """Its middle."""
        return np.array(seen.position[:2])

    def reach(self, seen: SeenObject, grasp: Grasp, turn: float, c: UserConfiguration) -> float:
        """All: it is never more than an eighth turn."""
        return turn


class WrenchHandling:
    """A wrench is grasped across its handle, and again when the hand has turned far enough.

    Args:
        wrench: Its shape; on a bolt it turns about this, and nothing else can be done with it.
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
        """The turn of the handle, and for a free wrench the shift of its middle."""
        turn = float((goal.yaw - seen.yaw + np.pi) % (2 * np.pi) - np.pi)
        off = np.asarray(goal.position[:2]) - seen.position[:2]
        return (np.zeros(2) if self._bolted else off), turn

    def grasp(
        self, seen: SeenObject, turn: float, c: UserConfiguration, failed: Grasp | None = None
    ) -> Grasp:
        """Thumb on one side of the handle, fingers on the other; round about if that failed."""
        return choose_handle_grasp(seen, turn, self._grip, c, failed.side if failed else None)

    def pivot(self, seen: SeenObject) -> Array:
        """The bolt, or a free wrench's middle."""
        if self._bolted:
            return np.array(self._wrench.bolt_place(seen.position[:2], seen.yaw))
        return np.array(seen.position[:2])

    def reach(self, seen: SeenObject, grasp: Grasp, turn: float, c: UserConfiguration) -> float:
        """As far as the wrist goes."""
        return within_comfort(grasp.axis_on(seen.yaw), turn, c)


def handling_of(shape: Thing) -> Handling:
    """How a thing of this shape is handled."""
    if isinstance(shape, Wrench):
        return WrenchHandling(shape)
    if isinstance(shape, MjcfThing):
        return OwnHandling(shape)
    if not isinstance(shape, Box):
        raise InputError(
            "the simulated user does not know how to handle this",
            got=type(shape).__name__,
            expected="Box, Wrench or MjcfThing",
            remedy="Give the task a user of its own: docs/write-a-task.md",
        )
    return BoxHandling()
