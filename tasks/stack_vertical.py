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

_TRIES = 20_000
"""Draws before a surface is said to be too small."""


@dataclass(frozen=True)
class StackVertical(Stacking):
    """Lift a box with touches that go up the screen, put it down on another one, and let go."""

    name: ClassVar[str] = "stack-vertical"
    touch_height: ClassVar[float] = -0.006
    plane: ClassVar[str] = "front"

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Self:
        """The trial of a seed; same seed and surface, same trial.

        Raises:
            InputError: The surface has no room for the boxes.
        """
        rng = np.random.default_rng([seed, cls.version, 20])
        for _ in range(_TRIES):
            edges = rng.uniform(*EDGE, cls.count)
            # The wider box may be the one that comes to stand on the other.
            low = edges.max() / 2 + SIDE
            across = low + rng.uniform(0.0, 1.0, cls.count) * (surface.size[0] - 2 * low)
            if surface.size[0] > 2 * low and abs(across[1] - across[0]) >= edges.mean() + GAP:
                break
        else:
            raise too_small(cls.name, surface, "7.76x5.82in")
        masses = rng.uniform(*MASS, cls.count)
        places = np.column_stack([surface.origin[0] + across, np.zeros(cls.count)])
        return cls.of(seed, edges, masses, places, np.zeros(cls.count))
