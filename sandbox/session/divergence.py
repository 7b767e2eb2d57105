"""When a simulation has left the region where its numbers mean something."""

from __future__ import annotations

from math import isfinite

import mujoco
import numpy as np

from models.scene import Scene

FASTEST = 50.0
"""m/s of an object: 10 cm in a step of 2 ms, farther than the objects are wide. It passes through
things without ever being seen to touch them."""
FASTEST_TURN = 5000.0
"""rad/s of anything, hand or object: more than a whole turn in a step of 2 ms."""

_SLOW = 40.0
"""m/s and rad/s of all joints together, at which nothing moves as fast as `FASTEST`."""

_WARNINGS = {
    mujoco.mjtWarning.mjWARN_BADQPOS: "positions are not finite",
    mujoco.mjtWarning.mjWARN_BADQVEL: "velocities are not finite",
    mujoco.mjtWarning.mjWARN_BADQACC: "accelerations are not finite",
    mujoco.mjtWarning.mjWARN_BADCTRL: "the commanded pose is not finite",
}
"""What MuJoCo notices by itself; it also calls numbers beyond 1e10 not finite."""


def command_error(data: mujoco.MjData) -> str:
    """Error in the commanded pose, in words; empty if it is valid."""
    ctrl = data.ctrl
    if isfinite(ctrl.dot(ctrl)) or np.all(np.isfinite(ctrl)):
        return ""
    return "the commanded pose is not finite"


def state_error(scene: Scene, data: mujoco.MjData) -> str:
    """Error in the state of a simulation, in words; empty if it is valid."""
    # Nearly always nothing is, which a few sums tell: whatever is not finite makes one of them so,
    # and nothing is fast where no joint is.
    qpos, qvel = data.qpos, data.qvel
    slow = isfinite(qpos.dot(qpos)) and qvel.dot(qvel) < _SLOW**2
    if slow and not any(data.warning.number.tolist()):
        return ""
    for kind, words in _WARNINGS.items():
        if data.warning[kind].number:
            return words
    if not (np.all(np.isfinite(data.qpos)) and np.all(np.isfinite(data.qvel))):
        return "the state is not finite"
    for name, body in scene.object_bodies.items():
        # Spatial velocity about the subtree's centre of mass: turn, then straight motion.
        turn, speed = np.linalg.norm(data.cvel[body].reshape(2, 3), axis=1)
        if speed > FASTEST:
            return f"{name} moves at {speed:.0f} m/s"
        if turn > FASTEST_TURN:
            return f"{name} turns at {turn:.0f} rad/s"
    if np.max(np.abs(data.qvel), initial=0.0) > FASTEST_TURN:
        return f"a joint of a hand turns at {np.max(np.abs(data.qvel)):.0f} rad/s"
    return ""
