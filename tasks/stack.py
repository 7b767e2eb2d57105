"""Stack two boxes, or three, on the table, with a second control that lifts the hand."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length
from models.surface import Surface
from tasks.stacking import EDGE, MASS, YAW, Stacking, too_small

SIDE = 0.012
"""m between the face of an unrotated box and the surface's border at the start: about a fingertip's
breadth, for touches beside the box on that side as well."""
GAP = 0.030
"""m, least distance of two boxes' centres at the start beyond half the sum of their edges, so that
fingers have room between them."""

_TRIES = 20_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class Stack(Stacking):
    """Lift a box, put it down on another one, and let it stand there.

    Scene: two boxes with edges of 40 to 60 mm and masses of 50 to 250 g on a table, friction 0.5
    against the table and 1 against each other. Touches move the hand over the table; the device's
    lift control raises it by up to 12 cm.
    Goal: the ghost of the second box on top of the base, wherever the base stands now.
    Success: the second box stands on the base and touches neither the table nor anything else that
    bears it, its centre within 0.35 of the smaller edge of the base's centre seen from above; the
    base stands on the table; both are tilted by less than 3 degrees (a cube is a cube: any of its
    faces may be below), slower than 1 cm/s and touched by no hand; all for 0.5 s without a break,
    within 60 s. What bears what is known from contact forces: more than 0.6 of a box's weight.
    Start: edges, masses, and yaws within 45 degrees of the surface's axes all uniform; centres
    uniform over the surface less half an edge and 12 mm; all drawn anew until the centres are at
    least 30 mm farther apart than half the sum of the edges.
    History: version 1.
    """

    name: ClassVar[str] = "stack"
    lift_range: ClassVar[float] = 0.12

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Self:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            InputError: The surface is too small for the boxes.
        """
        rng = np.random.default_rng([seed, cls.version, 10 + cls.count])
        # The smallest boxes must fit at opposite corners, or no draw can succeed.
        widest = surface.size - EDGE[0] - 2 * SIDE
        possible = np.all(widest > 0) and length(widest) > EDGE[0] + GAP
        for _ in range(_TRIES if possible else 0):
            edges = rng.uniform(*EDGE, cls.count)
            shares = rng.uniform(0.0, 1.0, (cls.count, 2))
            low = edges[:, None] / 2 + SIDE
            places = low + shares * (surface.size - 2 * low)
            if np.all(surface.size > 2 * low) and _apart(places, edges):
                break
        else:
            raise too_small(cls.name, surface, (7.76, 5.82))
        masses, yaws = rng.uniform(*MASS, cls.count), rng.uniform(-YAW, YAW, cls.count)
        return cls.of(seed, edges, masses, surface.to_world(places)[:, :2], yaws)


@dataclass(frozen=True)
class StackThree(Stack):
    """Stack three boxes: the second on the base, the third on the second.

    Scene, success and start are those of `stack`, with one box more and a lift of up to 18 cm.
    Boxes are drawn together with their places, so that large ones are rarer than small ones.
    History: version 1.
    """

    name: ClassVar[str] = "stack-three"
    count: ClassVar[int] = 3
    lift_range: ClassVar[float] = 0.18


def _apart(places: Array, edges: Array) -> bool:
    """True if all boxes are far enough from each other."""
    for i in range(len(edges)):
        for j in range(i):
            least = (edges[i] + edges[j]) / 2 + GAP
            if length(places[i] - places[j]) < least:
                return False
    return True
