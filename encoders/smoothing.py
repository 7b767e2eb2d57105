"""Smoothing of the pose, in surface coordinates.

Never on poses relative to the leftmost contact: that reference jumps by the width of a hand when
another finger becomes the leftmost.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.pose import ROOT_ROTATION
from models.rotations import unwrap_near

Array = NDArray[np.float64]


class PoseFilter:
    """A first-order low-pass of the hand's posture that is carried along with the touches.

    The touches' common motion passes at once, so that a dragged hand has no lag; what the filter
    slows is the change of posture, as at a contact that comes or goes. It runs before the fingertip
    correction, which makes the tips exact again.

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

    def step(self, q: ArrayLike, carried: ArrayLike, dt: float) -> Array:
        """Smoothed pose (48,).

        Args:
            q: (48,) encoder's pose in the 3-D surface frame.
            carried: (2,) m, motion of the touches since the last step, on the surface (y down).
            dt: s since the last step.
        """
        q = np.array(q, float)
        if self._state is None or self.tau <= 0:
            self._state = q
            return q.copy()
        state = self._state
        state[0] += carried[0]  # type: ignore[index]
        state[1] -= carried[1]  # type: ignore[index]
        q[ROOT_ROTATION] = unwrap_near(q[ROOT_ROTATION], state[ROOT_ROTATION])
        self._state = state + -np.expm1(-dt / self.tau) * (q - state)
        return self._state.copy()
