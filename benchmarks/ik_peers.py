"""Other ways from touches to a pose, timed beside the encoder: inverse kinematics.

PCA-IK is the paper's rival, here the project's own; mink is a general library for inverse
kinematics on MuJoCo models, with the hand's own model, all fingers that touch as targets and a weak
pull towards the pose it starts from.
"""

from __future__ import annotations

from collections.abc import Callable

import mujoco
import numpy as np
from numpy.typing import NDArray

from models.arithmetic.arrays import Array
from models.errors import InputError
from models.frames import FINGERS
from models.kinematics import Kinematics
from models.pose import JOINTS, POSE_SIZE, ROOT_POSITION, ROOT_ROTATION
from models.rotations import quaternion_exp, quaternion_log
from models.skeleton import ADULT
from models.surface import METRES_PER_INCH
from tools.make_hand import HAND_FILE

PULL = 1e-2
"""Cost of leaving the first pose, per rad, against 1 per m for fingertips."""
SOLVER = "daqp"


def targets_of(u: Array, height: float) -> tuple[NDArray[np.intp], Array]:
    """Touching fingers (k,) of a contact vector, and their tips' targets (k, 3) m."""
    fingers = np.flatnonzero(u[10:])
    xy = u[:10].reshape(-1, 2)[fingers] * METRES_PER_INCH
    return fingers, np.column_stack([xy[:, 0], -xy[:, 1], np.full(len(fingers), height)])


def farthest_tip(q: Array, u: Array, height: float, kinematics: Kinematics) -> float:
    """m, the largest distance of a touching fingertip from its target."""
    fingers, targets = targets_of(u, height)
    return float(np.linalg.norm(kinematics.tips(q)[fingers] - targets, axis=1).max())


class Mink:
    """Inverse kinematics by mink.

    Args:
        iterations: Steps, always all of them.
        start: Pose (48,) that a contact vector (15,) starts from.
        height: m, of a touching fingertip's centre.

    Raises:
        InputError: mink or its solver is not installed.
    """

    def __init__(self, iterations: int, start: Callable[[Array], Array], height: float) -> None:
        try:
            import daqp  # noqa: F401
            import mink
        except ImportError as error:
            raise InputError(
                "this comparison needs mink and a solver",
                got=error.name,
                remedy="pip install mink daqp, or leave out --mink",
            ) from error
        self._mink, self._iterations, self._start, self._height = mink, iterations, start, height
        spec = mujoco.MjSpec.from_file(str(HAND_FILE))
        last = [*(ADULT.first_bone[1:] - 1), len(ADULT.bones) - 1]
        for name, bone in zip(FINGERS, last, strict=True):
            body = spec.body(f"right_{ADULT.bones[bone].name}")
            body.add_site(name=f"{name}_tip", pos=[0.0, ADULT.bones[bone].length, 0.0])
        self._configuration = mink.Configuration(spec.compile())
        self._tips = [mink.FrameTask(f"{name}_tip", "site", 1.0, 0.0) for name in FINGERS]
        self._posture = mink.PostureTask(self._configuration.model, PULL)

    def __call__(self, u: Array) -> Array:
        """(48,) pose of one contact vector (15,)."""
        mink, configuration = self._mink, self._configuration
        configuration.update(_qpos(self._start(u)))
        self._posture.set_target_from_configuration(configuration)
        fingers, targets = targets_of(u, self._height)
        for finger, target in zip(fingers, targets, strict=True):
            self._tips[finger].set_target(mink.SE3.from_translation(target))
        tasks = [*(self._tips[f] for f in fingers), self._posture]
        for _ in range(self._iterations):
            velocity = mink.solve_ik(configuration, tasks, 1.0, SOLVER, limits=[])
            configuration.integrate_inplace(velocity, 1.0)
        return _pose(configuration.q)


def _qpos(q: Array) -> Array:
    """MuJoCo's coordinates: three slides, then 15 quaternions."""
    turns = np.concatenate([q[ROOT_ROTATION], q[JOINTS]]).reshape(-1, 3)
    return np.concatenate([q[ROOT_POSITION], quaternion_exp(turns).ravel()])


def _pose(qpos: Array) -> Array:
    q = np.empty(POSE_SIZE)
    q[ROOT_POSITION] = qpos[:3]
    q[3:] = quaternion_log(qpos[3:].reshape(-1, 4)).ravel()
    return q
