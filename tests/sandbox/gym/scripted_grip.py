"""A policy in a page of code: three fingers close on the box, carry it to its goal and let go.

It sees observations and gives actions, and works with the slots of either environment.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from models.arithmetic import Array

FINGERS = {0: (-1.0, 0.0), 1: (1.0, 0.010), 2: (1.0, -0.012)}
"""Finger -> side of the box and m along it: the thumb to the left, two fingers to the right."""
HALF = 0.025
"""m, half an edge of the box."""
OPEN, CLOSED = HALF + 0.020, HALF + 0.003
"""m from the box's middle."""
SPEED = 0.0012
"""m, way of the grip in a control period."""


class ScriptedGrip:
    """Plays one episode of box-to-goal.

    Args:
        surface: (2,) m, size of the touch surface, whose middle is the world's origin.
    """

    def __init__(self, surface: Array) -> None:
        self._surface = surface
        self._middle: Array | None = None
        self._width, self._yaw, self._let_go = OPEN, 0.0, 0

    def __call__(self, seen: dict[str, Any]) -> Array:
        """The action (15,) for an observation."""
        box, goal = seen["objects"][0], seen["goals"][0]
        if self._middle is None:
            self._middle, self._yaw = box[:2].copy(), _quarter(_yaw(box[3:7]))
        turn = _quarter(goal[3] - self._yaw)
        way = goal[:2] - self._middle
        far = float(np.hypot(*way))
        action = np.zeros(15)
        if self._let_go:
            self._let_go += 1
            self._width += 0.0006
            if self._let_go > 45:
                return action
        elif seen["solid"].sum() < len(FINGERS) and self._width == OPEN:
            pass
        elif self._width > CLOSED:
            self._width -= 0.0005
        elif far > 1e-4 or abs(turn) > 1e-3:
            part = min(1.0, SPEED / max(far, SPEED * abs(turn) / 0.01, 1e-9))
            self._middle = self._middle + part * way
            self._yaw += part * turn
        elif np.hypot(*(box[:2] - goal[:2])) < 0.006 or seen["time"][0] > 12.0:
            self._let_go = 1
        c, s = np.cos(self._yaw), np.sin(self._yaw)
        for finger, (side, along) in FINGERS.items():
            x, y = side * self._width, along
            place = self._middle + np.array([c * x - s * y, s * x + c * y])
            action[3 * finger : 3 * finger + 3] = (
                1.0,
                self._surface[0] / 2 + place[0],
                self._surface[1] / 2 - place[1],
            )
        return action


def _yaw(quaternion: Array) -> float:
    w, x, y, z = quaternion
    return float(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))


def _quarter(angle: float) -> float:
    """The same angle of a cube, within 45 degrees of 0."""
    return float((angle + np.pi / 4) % (np.pi / 2) - np.pi / 4)
