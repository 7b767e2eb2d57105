"""Current positions of goals: some are fixed in the world, others on top of a moving object."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import atan2
from typing import Protocol

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length

_NEAR = 0.030
"""m, distance from its own goal below which an object counts as placed, so that a goal on top of it
follows it. Before, the goal on top is shown above the object's own goal."""


@dataclass(frozen=True)
class Goal:
    """Intended pose of an object; views draw the object's ghost there.

    Attributes:
        object: Name of the object.
        position: (3,) m, centre of the object at the goal; with `on`, relative to the centre of
            that object, in the world's directions.
        yaw: rad about the vertical; with `on`, relative to that object.
        on: Name of the object on which it should stand, at that object's current position. `place`
            converts such goals to positions in the world.
        shown: False for an object that only has to stay where it is; views draw nothing for it.
    """

    object: str
    position: tuple[float, float, float]
    yaw: float
    on: str | None = None
    shown: bool = True


class Posed(Protocol):
    """An object with a position (3,) m and a rotation (3, 3) in the world."""

    @property
    def position(self) -> Array: ...

    @property
    def rotation(self) -> Array: ...


def place(goals: Sequence[Goal], poses: Mapping[str, Posed]) -> tuple[Goal, ...]:
    """Converts goals to their current positions in the world; none of the results has `on` set.

    Args:
        goals: Goals in order, lower ones first.
        poses: Current poses of the objects, by name.
    """
    placed: dict[str, Goal] = {}
    for goal in goals:
        if goal.on is None:
            placed[goal.object] = goal
            continue
        below = poses[goal.on]
        base, yaw = np.asarray(below.position), flat_yaw(below.rotation)
        planned = placed.get(goal.on)
        if planned and length(base - planned.position) > _NEAR:
            base, yaw = np.asarray(planned.position), planned.yaw
        x, y, z = (base + goal.position).tolist()
        placed[goal.object] = Goal(goal.object, (x, y, z), yaw + goal.yaw)
    return tuple(placed[goal.object] for goal in goals)


def flat_yaw(rotation: Array) -> float:
    """Yaw in rad of the object's most horizontal axis; x before y before z.

    A box that stands on its x face has an upright x axis, but its other edges still have a yaw.
    """
    steep = [round(10.0 * abs(z)) for z in rotation[2].tolist()]
    x, y, _ = rotation[:, steep.index(min(steep))].tolist()
    return atan2(y, x)
