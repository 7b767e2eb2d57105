"""Solves for the most likely posture with given fingertips, for many frames at once.

    theta = argmin  sum over fingertips |tip - target|^2 / precision^2
                    + (theta - aim)' S^-1 (theta - aim) + a wall at the joints' limits

by Gauss-Newton. So poses are not polynomials of the touches: tips are trigonometric in the joints,
the solution contains an inverse, and the aim cannot be known from the touches alone.
"""

from __future__ import annotations

import numpy as np

from encoders.captures.subject.posture import Anatomy
from models.arithmetic import Array
from models.kinematics import Kinematics
from models.pose import JOINTS

ITERATIONS = 20

_FIRST_PRECISION = 0.02
"""m, precision of targets in the first iterations: at full precision, a far hand would
overshoot."""

_STEP = 0.15
"""rad, largest rotation of a joint in one iteration: tips are nearly linear in joints only so
far."""

_WALL = np.deg2rad(0.5)
"""rad, softness of a joint's wall."""

_BEFORE_LIMIT = np.deg2rad(2.0)
"""rad between the wall and the anatomic limit: room for the errors of measurement."""


class PostureSolver:
    """Computes postures of one anatomy on one skeleton."""

    def __init__(self, kinematics: Kinematics, anatomy: Anatomy) -> None:
        self._kinematics, self._hinges = kinematics, anatomy.hinges
        self._precision = np.linalg.inv(anatomy.covariance)
        skeleton = kinematics.skeleton
        self._lower = skeleton.lower + _BEFORE_LIMIT
        self._upper = skeleton.upper - _BEFORE_LIMIT

    def solve(self, aim: Array, targets: Array, precision: Array) -> Array:
        """Computes postures (n, 27).

        Args:
            aim: (n, 27) posture aimed at.
            targets: (n, 5, 3) m, of the fingertips, in the frame of the root's freedoms.
            precision: (n, 5, 3) m, required precision of each coordinate; infinite if it is free.
        """
        theta = aim.copy()
        joints = self._hinges[JOINTS]
        for i in range(ITERATIONS):
            # Geometric sequence from the first precision to the required one in the first half.
            share = min(1.0, 2 * i / ITERATIONS)
            sd = np.maximum(precision, _FIRST_PRECISION * 1e-3**share)
            weight = (1 / sd**2).reshape(len(aim), 15)
            q = theta @ self._hinges.T
            tips, by_pose = self._kinematics.tips_and_jacobian(q)
            J = by_pose.reshape(len(aim), 15, -1) @ self._hinges
            miss = (targets - tips).reshape(len(aim), 15)
            over = self._over(q[:, JOINTS])
            blocked = (over != 0) / _WALL**2
            weighted = np.swapaxes(J * weight[..., None], -1, -2)
            H = self._precision + weighted @ J
            H += np.einsum("nj,ja,jb->nab", blocked, joints, joints, optimize=True)
            g = (weighted @ miss[..., None])[..., 0] + (aim - theta) @ self._precision
            g -= (blocked * over) @ joints
            step = np.linalg.solve(H, g[..., None])[..., 0]
            largest = np.abs(step[:, 3:]).max(axis=1, keepdims=True)
            theta = theta + step * np.minimum(1.0, _STEP / np.maximum(largest, _STEP))
        return theta

    def _over(self, joints: Array) -> Array:
        """Signed angles (n, 42) rad beyond the walls."""
        return np.maximum(joints - self._upper, 0) + np.minimum(joints - self._lower, 0)
