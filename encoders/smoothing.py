"""Smoothing of the pose, in surface coordinates.

Never on poses relative to the leftmost contact: that reference jumps by the width of a hand when
another finger becomes the leftmost.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.pose import ROOT_POSITION, ROOT_ROTATION
from models.rotations import exp, log, unwrap_near

Array = NDArray[np.float64]

_LEAST_TURN = 1e-12
"""rad, below which a hand has not turned."""


class Motion(NamedTuple):
    """What touches have done together since the frame before."""

    carried: Array
    """(2,) m, on the surface: the way of their middle (y down)."""
    turn: float
    """rad, about their middle, counterclockwise as seen on the screen."""
    about: Array
    """(2,) m, where their middle was, on the surface."""


def rigid_motion(before: ArrayLike, after: ArrayLike) -> Motion:
    """The best rigid motion from touches (n, 2) m to the same touches later.

    Touches that are NaN on either side take no part; fewer than two do not turn.
    """
    before, after = np.asarray(before, float), np.asarray(after, float)
    both = np.isfinite(before).all(axis=1) & np.isfinite(after).all(axis=1)
    if not both.any():
        return Motion(np.zeros(2), 0.0, np.zeros(2))
    a, b = before[both], after[both]
    middle, later = a.mean(axis=0), b.mean(axis=0)
    (ax, ay), (bx, by) = (a - middle).T, (b - later).T
    # The surface's y points down, so the turn on the screen has the other sign.
    turn = -np.arctan2(np.sum(ax * by - ay * bx), np.sum(ax * bx + ay * by))
    return Motion(later - middle, float(turn), middle)


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
        carried: ArrayLike,
        dt: float,
        turn: float = 0.0,
        about: ArrayLike = (0.0, 0.0),
    ) -> Array:
        """Smoothed pose (48,).

        Args:
            q: (48,) encoder's pose in the 3-D surface frame.
            carried: (2,) m, motion of the touches since the last step, on the surface (y down).
            dt: s since the last step.
            turn: rad, of the touches since the last step, counterclockwise on the screen.
            about: (2,) m, middle of the touches before it, on the surface.
        """
        q = np.array(q, float)
        if self._state is None or self.tau <= 0:
            self._state = q
            return q.copy()
        state = self._state
        if abs(turn) > _LEAST_TURN:
            x, y = np.asarray(about, float)
            middle = np.array([x, -y, 0.0])
            turned = exp([0.0, 0.0, turn])
            state[ROOT_POSITION] = middle + turned @ (state[ROOT_POSITION] - middle)
            state[ROOT_ROTATION] = log(turned @ exp(state[ROOT_ROTATION]))
        state[0] += carried[0]  # type: ignore[index]
        state[1] -= carried[1]  # type: ignore[index]
        q[ROOT_ROTATION] = unwrap_near(q[ROOT_ROTATION], state[ROOT_ROTATION])
        self._state = state + -np.expm1(-dt / self.tau) * (q - state)
        return self._state.copy()
