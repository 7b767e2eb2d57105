"""Detection of a diverged simulation: non-finite numbers and impossible speeds."""

from __future__ import annotations

from math import isfinite

import mujoco
import numpy as np

from models.arithmetic.products import squared_lengths
from models.scene import Scene

FASTEST = 50.0
"""m/s, highest speed of an object. At this speed it moves 10 cm in a step of 2 ms, more than its
own width, and passes through other objects without a detected contact."""
FASTEST_TURN = 5000.0
"""rad/s, highest angular speed of a hand's joint or an object: more than a turn in 2 ms."""

_SLOW = 40.0
"""m/s and rad/s, norm of all joint velocities below which no object can be as fast as `FASTEST`."""

_WARNINGS = {
    mujoco.mjtWarning.mjWARN_BADQPOS: "positions are not finite",
    mujoco.mjtWarning.mjWARN_BADQVEL: "velocities are not finite",
    mujoco.mjtWarning.mjWARN_BADQACC: "accelerations are not finite",
    mujoco.mjtWarning.mjWARN_BADCTRL: "the commanded pose is not finite",
}
"""Warnings of MuJoCo that mean divergence; it also calls numbers beyond 1e10 not finite."""


def command_error(data: mujoco.MjData) -> str:
    """Description of an error in the commanded pose; empty if it is valid."""
    ctrl = data.ctrl
    if isfinite(ctrl.dot(ctrl)) or np.all(np.isfinite(ctrl)):  # any order: is it finite
        return ""
    return "the commanded pose is not finite"


def state_error(scene: Scene, data: mujoco.MjData) -> str:
    """Description of an error in the state of a simulation; empty if it is valid."""
    # Fast path for the usual, valid state: a number that is not finite makes a dot product not
    # finite, and no object is fast while all joint velocities are small.
    qpos, qvel = data.qpos, data.qvel
    slow = isfinite(qpos.dot(qpos)) and qvel.dot(qvel) < _SLOW**2  # any order: a rough first look
    if slow and not any(data.warning.number.tolist()):
        return ""
    for kind, words in _WARNINGS.items():
        if data.warning[kind].number:
            return words
    if not (np.all(np.isfinite(data.qpos)) and np.all(np.isfinite(data.qvel))):
        return "the state is not finite"
    for name, body in scene.object_bodies.items():
        # Spatial velocity about the subtree's centre of mass: turn, then straight motion.
        turn, speed = np.sqrt(squared_lengths(data.cvel[body].reshape(2, 3)))
        if speed > FASTEST:
            return f"{name} moves at {speed:.0f} m/s"
        if turn > FASTEST_TURN:
            return f"{name} turns at {turn:.0f} rad/s"
    if np.max(np.abs(data.qvel), initial=0.0) > FASTEST_TURN:
        return f"a joint of a hand turns at {np.max(np.abs(data.qvel)):.0f} rad/s"
    return ""
