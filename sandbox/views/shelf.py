"""The visible table at an upright surface: a shelf that ends in front of the objects.

The hand comes from the front and from below, where an endless table would hide it completely.
"""

from __future__ import annotations

import mujoco
import numpy as np

from models.arithmetic import Array
from models.scene import TABLE

FRONT, BACK, HALF_WIDTH, THICKNESS = -0.034, 0.16, 0.30, 0.014
"""m: world y of its front and back edge, x of its sides, and its thickness. The front edge is just
in front of the largest object's."""
PANE = 0.040
"""m in front of the touch surface, distance at which touches are marked, so that objects do not
hide the marks."""

SHELF = (0.31, 0.37, 0.41)


def hide_table(model: mujoco.MjModel, group: int) -> None:
    """Hides the endless table, and the mat on it, by moving them into a group that is not drawn."""
    for name in (TABLE, "mat"):
        model.geom_group[model.geom(name).id] = group


def shelf() -> tuple[Array, Array]:
    """Half size (3,) and centre (3,) of the shelf that is drawn instead, m."""
    half = np.array([HALF_WIDTH, (BACK - FRONT) / 2, THICKNESS / 2])
    return half, np.array([0.0, (BACK + FRONT) / 2, -THICKNESS / 2])
