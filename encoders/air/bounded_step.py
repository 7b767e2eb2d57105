"""Gauss-Newton steps of a pose whose joints stay in their ranges."""

from __future__ import annotations

import mujoco
import numpy as np

from models.arithmetic import Array, Mask, solve_positive
from models.pose import JOINTS, POSE_SIZE, ROOT_ROTATION
from models.rotations import quaternion_exp, quaternion_log

LONGEST = 0.5
"""Largest change (m or rad) of any component of a pose in one step."""
_ROUNDS = 4
"""Largest number of rounds in which joints are fixed at the ends of their ranges."""
_AT_END = 1e-9
"""Angle (rad) within which a joint is at the end of its range."""


def bounded_step(q: Array, square: Array, down: Array, lower: Array, upper: Array) -> Array:
    """The Gauss-Newton step (48,) of a pose.

    A joint at the end of its range is fixed if the step would move it further out.

    Args:
        q: (48,) pose.
        square: (48, 48) positive definite, J'J of the residuals.
        down: (48,) J'r of the residuals.
        lower: (42,) rad, lower ends of the joints' ranges.
        upper: (42,) rad, upper ends of the joints' ranges.
    """
    held = np.zeros(POSE_SIZE, bool)
    for _ in range(_ROUNDS):
        step = _solved(square, down, held)
        joints = q[JOINTS] + step[JOINTS]
        out = (joints < lower) & (q[JOINTS] <= lower + _AT_END)
        out |= (joints > upper) & (q[JOINTS] >= upper - _AT_END)
        out &= ~held[JOINTS]
        if not out.any():
            break
        held[JOINTS] |= out
    return np.minimum(np.maximum(step, -LONGEST), LONGEST)


def stepped(q: Array, step: Array, lower: Array, upper: Array) -> Array:
    """The pose (48,) after a step; the root turns in its own frame."""
    moved = q + step
    moved[ROOT_ROTATION] = _turned(q[ROOT_ROTATION], step[ROOT_ROTATION])
    moved[JOINTS] = np.minimum(np.maximum(moved[JOINTS], lower), upper)
    return moved


def _solved(square: Array, down: Array, held: Mask) -> Array:
    """The step (48,) that solves the equations; its fixed components are 0."""
    S, r = square.copy(), -down
    if held.any():
        S[held] = 0.0
        S[:, held] = 0.0
        S[held, held] = 1.0
        r[held] = 0.0
    return solve_positive(S, r)


def _turned(w: Array, turn: Array) -> Array:
    """The rotation vector (3,) of exp(w) exp(turn)."""
    product = np.zeros(4)
    mujoco.mju_mulQuat(product, quaternion_exp(w), quaternion_exp(turn))
    mujoco.mju_normalize4(product)
    return quaternion_log(product)
