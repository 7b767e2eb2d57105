"""Legal poses: anatomic ranges of the joints, and speed limits of a commanded pose."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np
from numpy.typing import ArrayLike

from models.arithmetic.arrays import Array
from models.pose import JOINTS, ROOT_ROTATION
from models.rotations import unwrapped
from models.skeleton import Skeleton


def within_limits(q: ArrayLike, skeleton: Skeleton) -> Array:
    """Poses (..., 48) with every ball joint clamped, component by component, to its range.

    All servo targets must be clamped by this function: a ball joint's own limit in the simulation
    bounds only the total angle, and would let a finger bend sideways as far as it bends forward.
    """
    q = np.array(q, float)
    q[..., JOINTS] = np.clip(q[..., JOINTS], skeleton.lower, skeleton.upper)
    return q


def violations(q: ArrayLike, skeleton: Skeleton, tolerance: float = 1e-9) -> Array:
    """Number (...) of components outside their range by more than `tolerance` rad."""
    joints = np.asarray(q, float)[..., JOINTS]
    return np.sum(
        (joints < skeleton.lower - tolerance) | (joints > skeleton.upper + tolerance), axis=-1
    )


@dataclass(frozen=True)
class RateLimit:
    """Speed limits of a commanded pose, a safety net against jumps of the input.

    Attributes:
        linear: m/s of the root.
        angular: rad/s of the root and of every ball joint.
    """

    linear: float = 1.0
    angular: float = 12.0

    def or_faster(self, other: RateLimit) -> RateLimit:
        """Limits that allow the higher speed of both, for linear and angular motion."""
        return RateLimit(max(self.linear, other.linear), max(self.angular, other.angular))

    def __call__(self, previous: Array, target: Array, dt: float) -> Array:
        """Pose (48,) that moves from previous towards target as far as dt seconds allow.

        All parts are slowed by the same share, so that the fingers stay in step with the wrist.
        """
        if dt <= 0:
            return previous
        goal = target.copy()
        goal[ROOT_ROTATION] = unwrapped(target[ROOT_ROTATION], previous[ROOT_ROTATION])
        if self.linear == self.angular == inf:
            return goal
        step = goal - previous
        squares = step * step
        # Recorded sessions depend on the order in which the three are added: do not change it.
        linear, *angular = (squares[::3] + squares[2::3] + squares[1::3]).tolist()
        share = sqrt(max(linear / self.linear**2, max(angular) / self.angular**2)) / dt
        return previous + step / share if share > 1.0 else goal


GENTLE = RateLimit(0.6, 7.0)
"""Speed limits of hands no stronger than the profile `safe`. At 1 m/s and 12 rad/s, 30 N or 6000 N,
a tip may meet an object at 1.6 m/s, which is 3 mm in one physics step (measured at db485e42)."""
