"""A hand and its touches turned together, for all tests of what should turn with a hand."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic import Array
from models.pose import ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp, log


def turned_pose(q: ArrayLike, angle: float, about: ArrayLike) -> Array:
    """Poses (..., 48), 3-D surface frame, turned about the normal at a point (2,) of the surface.

    The angle is in rad, counterclockwise on the screen.
    """
    q = np.array(q, float)
    x, y = np.asarray(about, float)
    middle, rotation = np.array([x, -y, 0.0]), exp([0.0, 0.0, angle])
    q[..., ROOT_POSITION] = middle + (q[..., ROOT_POSITION] - middle) @ rotation.T
    q[..., ROOT_ROTATION] = log(rotation @ exp(q[..., ROOT_ROTATION]))
    return q


def turned_places(xy: ArrayLike, angle: float, about: ArrayLike) -> Array:
    """Touches (..., 2) m on the surface, whose y points down, turned in the same way."""
    x, y = np.moveaxis(np.asarray(xy, float) - about, -1, 0)
    cos, sin = np.cos(angle), np.sin(angle)
    return np.asarray(about) + np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1)
