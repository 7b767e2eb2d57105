"""A task's things in their real scene, for tests that put them where they want them."""

from __future__ import annotations

from typing import Generic, Self, TypeVar

import mujoco
import numpy as np

from models.hand import Hand
from models.rotations import quaternion_exp
from models.scene import Scene, SceneSpec
from tasks.sensing import Sensing
from tasks.task import Measure, Task
from tests.support.simulation import put

T = TypeVar("T", bound=Task)
AWAY = np.concatenate([[0.0, 0.0, 0.30], np.zeros(45)])
"""(48,) pose of a hand above everything on a table."""


class TaskScene(Generic[T]):
    """A task's scene with a hand that touches nothing.

    Args:
        task: The task.
        away: (48,) pose of the hand.
    """

    def __init__(self, task: T, away: np.ndarray = AWAY) -> None:
        self.task = task
        spec = SceneSpec(
            (Hand(),),
            task.objects,
            task.table_friction,
            own_friction=task.own_friction,
            painted=task.painted,
        )
        self.scene = Scene(spec)
        self.data = mujoco.MjData(self.scene.model)
        put(self.scene, self.data, away)
        self.scene.set_solid(0, frozenset())
        self.sensing = Sensing(self.scene, self.data)

    def at_goals(self) -> Self:
        """Puts the objects at their goals, at rest; returns the scene."""
        for goal in self.task.goals:
            joint = self.data.joint(goal.object)
            joint.qpos[:3] = goal.position
            joint.qpos[3:] = quaternion_exp([0.0, 0.0, goal.yaw])
        return self

    def measure(self) -> Measure:
        """What the task says of its things, exactly as they are now."""
        mujoco.mj_forward(self.scene.model, self.data)
        return self.task.measure(self.sensing)
