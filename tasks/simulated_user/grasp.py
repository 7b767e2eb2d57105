"""Where a person would put thumb and fingers on a box."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from tasks.simulated_user.configuration import UserConfiguration
from tasks.simulated_user.sight import SeenObject

Array = NDArray[np.float64]

_TIP_RADIUS = 0.007
"""m, what a person takes a drawn fingertip to be."""


@dataclass(frozen=True)
class Grasp:
    """A pinch across a box.

    Attributes:
        axis: rad, direction from thumb to fingers in the world.
        width: m, distance of the two faces.
        face: m, width of the face that the fingers share.
    """

    axis: float
    width: float
    face: float

    def places(self, centre: Array, gap: float, c: UserConfiguration) -> Array:
        """(n, 2) m, fingertips, thumb first, at `gap` outside the faces (inside if negative)."""
        along = np.array([np.cos(self.axis), np.sin(self.axis)])
        across = np.array([along[1], -along[0]])
        others = c.fingers - 1
        pitch = min(c.pitch, (self.face - 0.004) / max(others - 1, 1))
        # No wider than a real hand opens: the outermost finger is the farthest from the thumb.
        widest = 0.5 * np.sqrt(c.longest_span**2 - (0.5 * (others - 1) * pitch) ** 2)
        reach = min(self.width / 2 + _TIP_RADIUS + gap, widest)
        # Index first: with the thumb to the lower left, the index is the leftmost finger.
        offsets = (np.arange(others) - (others - 1) / 2) * pitch
        fingers = centre + reach * along + offsets[:, None] * across
        return np.vstack([centre - reach * along, fingers])


def choose_grasp(box: SeenObject, turn: float, c: UserConfiguration) -> Grasp:
    """The pair of faces that is most comfortable at the start and at the end of a turn.

    Args:
        box: As it is seen.
        turn: rad by which it is to be turned.
        c: Whose comfort.
    """
    half = box.shape.half_size
    options = []
    for quarter in range(4):
        axis = box.yaw + quarter * np.pi / 2
        start, end = axis - c.natural_axis, axis + turn - c.natural_axis
        worst = max(abs(_wrapped(start)), abs(_wrapped(end)))
        width, face = (half[0], half[1]) if quarter % 2 == 0 else (half[1], half[0])
        options.append((worst, quarter, Grasp(axis, 2 * width, 2 * face)))
    return min(options, key=lambda o: o[:2])[2]


def _wrapped(angle: float) -> float:
    return float((angle + np.pi) % (2 * np.pi) - np.pi)
