"""Smoothing of the pose, in surface coordinates.

Never on poses relative to the leftmost contact: that reference jumps by the width of a hand when
another finger becomes the leftmost.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import atan2, cos, expm1, sin
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic.arrays import Array
from models.pose import ROOT_ROTATION
from models.rotations import turned_about_normal, unwrapped

_LEAST_TURN = 1e-12
"""rad, below which a hand has not turned."""


class Motion(NamedTuple):
    """Common motion of the touches since the previous frame."""

    carried: tuple[float, float]
    """m, on the surface: the way of their middle (y down)."""
    turn: float
    """rad, about their middle, counterclockwise as seen on the screen."""
    about: tuple[float, float]
    """m, where their middle was, on the surface."""


STILL = Motion((0.0, 0.0), 0.0, (0.0, 0.0))
"""Of no touches."""


def rigid_motion(before: ArrayLike, after: ArrayLike) -> Motion:
    """The best rigid motion from touches (n, 2) m to the same touches later.

    Touches that are NaN on either side take no part; fewer than two do not turn.
    """
    before, after = np.asarray(before, float), np.asarray(after, float)
    both = np.isfinite(before).all(axis=1) & np.isfinite(after).all(axis=1)
    if not both.any():
        return STILL
    a, b = before[both], after[both]
    middle, later = a.mean(axis=0), b.mean(axis=0)
    (ax, ay), (bx, by) = (a - middle).T, (b - later).T
    # The surface's y points down, so the turn on the screen has the other sign.
    turn = -atan2(np.sum(ax * by - ay * bx), np.sum(ax * bx + ay * by))
    (x, y), (right, down) = middle.tolist(), (later - middle).tolist()
    return Motion((right, down), float(turn), (x, y))


def common_motion(before: Sequence[Sequence[float]], after: Sequence[Sequence[float]]) -> Motion:
    """`rigid_motion` of a few touches [(x, y), ..] that are all known, in plain floats."""
    if not before:
        return STILL
    n = len(before)
    mx = my = lx = ly = across = along = 0.0
    for (ax, ay), (bx, by) in zip(before, after, strict=True):
        mx, my, lx, ly = mx + ax, my + ay, lx + bx, ly + by
    mx, my, lx, ly = mx / n, my / n, lx / n, ly / n
    for (ax, ay), (bx, by) in zip(before, after, strict=True):
        ax, ay, bx, by = ax - mx, ay - my, bx - lx, by - ly
        across += ax * by - ay * bx
        along += ax * bx + ay * by
    # The surface's y points down, so the turn on the screen has the other sign.
    return Motion((lx - mx, ly - my), -atan2(across, along), (mx, my))


class PoseFilter:
    """A first-order low-pass of the hand's posture that is carried along with the touches.

    The touches' common motion and turn pass at once, so that a dragged or turned hand has no lag;
    what the filter slows is the change of posture, as at a contact that comes or goes. It runs
    before the fingertip correction, which makes the tips exact again.

    Args:
        tau: s, time constant; 0 lets everything pass. The delay it adds to a change of posture is
            tau; to a change of place, none.
    """

    def __init__(self, tau: float) -> None:
        self.tau = tau
        self._state: Array | None = None

    def reset(self) -> None:
        """Forgets; the next pose passes unchanged."""
        self._state = None

    def step(
        self,
        q: ArrayLike,
        carried: Sequence[float],
        dt: float,
        turn: float = 0.0,
        about: Sequence[float] = (0.0, 0.0),
    ) -> Array:
        """Smoothed pose (48,).

        Args:
            q: (48,) encoder's pose in the 3-D surface frame.
            carried: m, motion of the touches since the last step, on the surface (y down).
            dt: s since the last step.
            turn: rad, of the touches since the last step, counterclockwise on the screen.
            about: m, middle of the touches before it, on the surface.
        """
        q = np.array(q, float)
        if self._state is None or self.tau <= 0:
            self._state = q
            return q.copy()
        state = self._state
        x, y = state[:2].tolist()
        along, down = carried
        if abs(turn) > _LEAST_TURN:
            c, s = cos(turn), sin(turn)
            left, up = about[0], -about[1]
            x, y = left + c * (x - left) - s * (y - up), up + s * (x - left) + c * (y - up)
            state[ROOT_ROTATION] = turned_about_normal(state[ROOT_ROTATION], turn)
        state[0], state[1] = x + along, y - down
        root = q[ROOT_ROTATION]
        near = unwrapped(root, state[ROOT_ROTATION])
        if near is not root:
            root[:] = near
        self._state = state + -expm1(-dt / self.tau) * (q - state)
        return self._state.copy()
