"""Stack two boxes before an upright surface, with one hand and nothing else."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from models.surface import Surface
from tasks.stacking import EDGE, MASS, Stacking, too_small

SIDE = 0.020
"""m from a box's face to the surface's border, for fingers that stand open beside it."""
GAP = 0.030
"""m between the faces of the two boxes at the start, for fingers between them."""
HEADROOM = 0.045
"""m by which a surface must exceed the height of the middle of the upper box on the lower one: the
part below the table, the height at which the box is carried, and the fingers above its middle."""

_TRIES = 4_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class StackVertical(Stacking):
    """Lift a box by dragging it up the screen, put it down on another one, and let go.

    Scene: two boxes with edges of 40 to 60 mm and masses of 50 to 250 g on a table, friction 0.5
    against the table and 1 against each other. The touch surface stands upright before them, its
    lower edge 15 mm below the table's top: right on it is right in the world, and up is up, so
    that one hand does it all. Its plane is such that fingertips close in the plane of the boxes'
    middles; the hand comes to it from the front.
    Help along the depth, which the person neither sees nor controls: (1) of a finger that touches,
    only the ball of its tip is solid. A thumb that holds a box reaches down over the box below, and
    with the whole of its last link solid it pushes that box away. (2) As everywhere, a hand turns
    solid only when it is down, its simulated fingertips are where they should be, and none of them
    is inside a box. (3) A box that nobody could grip any more is put back after half a second: one
    into which the fingers' plane no longer reaches by 5 mm, and one that sticks out over a side of
    the surface. Until then boxes move freely along the depth and turn freely out of the plane;
    nothing guides them.
    Goal: the ghost of the second box on top of the base, wherever the base stands now.
    Success: as in `stack`: the second box stands on the base and touches neither the table nor
    anything else that bears it, its centre within 0.35 of the smaller edge of the base's centre
    seen from above, depth included; the base stands on the table; both are tilted by less than 3
    degrees, slower than 1 cm/s and touched by no hand; all for 0.5 s without a break, within 60 s.
    Start: edges and masses uniform; centres uniform over the surface's width less half the wider
    edge and 20 mm, drawn anew until there are 30 mm between the boxes; all faces square to the
    surface.
    History: version 1.
    """

    name: ClassVar[str] = "stack-vertical"
    touch_height: ClassVar[float] = -0.006
    plane: ClassVar[str] = "front"

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Self:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            InputError: The surface is too small for the boxes.
        """
        rng = np.random.default_rng([seed, cls.version, 20])
        width, height = surface.size
        for _ in range(_TRIES):
            edges = rng.uniform(*EDGE, cls.count)
            # The wider box may be the upper one.
            low = edges.max() / 2 + SIDE
            across = low + rng.uniform(0.0, 1.0, cls.count) * (width - 2 * low)
            fits = width > 2 * low and height >= edges[0] + edges[1] / 2 + HEADROOM
            if fits and abs(across[1] - across[0]) >= edges.mean() + GAP:
                break
        else:
            raise too_small(cls.name, surface, (7.76, 5.82))
        masses = rng.uniform(*MASS, cls.count)
        places = np.column_stack([surface.origin[0] + across, np.zeros(cls.count)])
        return cls.of(seed, edges, masses, places, np.zeros(cls.count))
