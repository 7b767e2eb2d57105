"""Where goals are now: some are places in the world, others are on top of something that moves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from tasks.sensing import length

Array = NDArray[np.float64]

_NEAR = 0.030
"""m; a thing nearer than this to its own goal is where it belongs, and what goes on it goes there.
Farther away, what goes on it is shown where the thing will be."""


@dataclass(frozen=True)
class Goal:
    """Where an object should end up; views draw the object's ghost there.

    Attributes:
        object: Name of the object.
        position: (3,) m, centre of the object at the goal; where `on` is set, how far from that
            object's centre, in the world's directions.
        yaw: rad about the vertical; where `on` is set, against that object's.
        on: Name of the object on which it should stand, wherever that is now. Whoever looks at
            goals takes them from `place`, which has put them into the world.
    """

    object: str
    position: tuple[float, float, float]
    yaw: float
    on: str | None = None


class Posed(Protocol):
    """Anything with a place (3,) m and a rotation (3, 3) in the world."""

    @property
    def position(self) -> Array: ...

    @property
    def rotation(self) -> Array: ...


def place(goals: Sequence[Goal], poses: Mapping[str, Posed]) -> tuple[Goal, ...]:
    """The goals in the world, as things stand now; none of them has `on` set any more.

    Args:
        goals: In an order in which what is below comes first.
        poses: Where the objects are, by name.
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
    """rad about the vertical of whichever of a thing's axes lies flattest; x before y before z.

    A box on another of its faces has its x axis upright, and still edges with a direction.
    """
    steep = [round(10.0 * abs(z)) for z in rotation[2].tolist()]
    x, y, _ = rotation[:, steep.index(min(steep))].tolist()
    return float(np.arctan2(y, x))
