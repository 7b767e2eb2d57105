"""Rewards of an agent in each step, and goal dictionaries for hindsight learning (HER)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from gymnasium import spaces

from models.arithmetic import Array
from models.errors import InputError
from sandbox.session.messages import Snapshot
from tasks.task import Task

REACH = 0.2
"""Largest part of an episode's reward for bringing fingertips to objects."""
NEAR = 0.10
"""Distance from an object at which a fingertip earns about a third of its part of `REACH`, m."""
TIPS = 3
"""Number of fingertips that count: those nearest to the object."""


class Reward:
    """Reward of one episode.

    The sum over an episode is bounded for every kind of reward. Success gives 1. `progress` adds
    the increase of the task's progress (0 to 1). `reach` adds, in addition to `progress`, at most
    `REACH` for bringing the three nearest fingertips to the nearest object. A decrease of progress
    or nearness costs as much as its increase gave.

    Args:
        kind: One of `sandbox.gym.environment_options.REWARDS`.
        snapshot: Snapshot at the beginning of the episode.
        progress: The task's progress at the beginning of the episode.
    """

    def __init__(self, kind: str, snapshot: Snapshot, progress: float) -> None:
        self._kind, self._won = kind, snapshot.score.success
        self._last = self._earned(snapshot, progress)

    def step(self, snapshot: Snapshot) -> float:
        """Reward of the control period that ended with a snapshot."""
        earned = self._earned(snapshot, snapshot.score.progress)
        gained = earned - self._last
        self._last = earned
        won, self._won = snapshot.score.success and not self._won, snapshot.score.success
        return gained + float(won)

    def _earned(self, snapshot: Snapshot, progress: float) -> float:
        return _EARNED[self._kind](snapshot, progress)


def reached(snapshot: Snapshot) -> float:
    """How near the three nearest fingertips are to the nearest object, 0 to 1."""
    return max(
        (
            _near(hand.tips, thing.position)
            for hand in snapshot.hands
            for thing in snapshot.objects.values()
        ),
        default=0.0,
    )


def _near(tips: Array, thing: Array) -> float:
    off = np.sqrt(np.sum((tips - thing) ** 2, axis=1))
    return float(np.mean(np.exp(-np.sort(off)[:TIPS] / NEAR)))


_EARNED: dict[str, Callable[[Snapshot, float], float]] = {
    "reach": lambda snapshot, progress: progress + REACH * reached(snapshot),
    "progress": lambda snapshot, progress: progress,
    "sparse": lambda snapshot, progress: 0.0,
}


ARRIVED = 0.010
"""Largest distance from its goal at which an object counts as arrived, m."""


def goal_space(space: spaces.Dict, task: str) -> spaces.Dict:
    """The space of goal dictionaries, float64.

    All entries are flat. `observation` has all parts of the plain observation except the goals.
    `achieved_goal` has the positions (g, 3) of the objects that have goals, and `desired_goal` the
    positions (g, 3) of the goals, m.

    Args:
        space: The space of plain observations.
        task: Name of the task, for errors.

    Raises:
        InputError: The task has no goals.
    """
    if "goals" not in space.spaces:
        raise InputError("this task has no goals to learn from", where=task, got="goal=True")
    boxes = {name: box for name, box in space.items() if isinstance(box, spaces.Box)}
    goals = boxes.pop("goals")
    return spaces.Dict(
        {
            "observation": spaces.Box(
                np.concatenate([box.low.ravel() for box in boxes.values()]),
                np.concatenate([box.high.ravel() for box in boxes.values()]),
                dtype=np.float64,
            ),
            "achieved_goal": _places(goals),
            "desired_goal": _places(goals),
        }
    )


def _places(goals: spaces.Box) -> spaces.Box:
    return spaces.Box(goals.low[:, :3].ravel(), goals.high[:, :3].ravel(), dtype=np.float64)


def goal_observation(seen: dict[str, Array], space: spaces.Dict, task: Task) -> dict[str, Array]:
    """The goal dictionary of a plain observation.

    Args:
        seen: The plain observation, see `HandSandboxEnv`.
        space: The space of plain observations; `observation` has the same order of parts.
        task: The drawn trial.
    """
    names = [shown.name for shown in task.objects]
    places = [seen["objects"][names.index(goal.object), :3] for goal in task.goals]
    return {
        "observation": np.concatenate([seen[name].ravel() for name in space if name != "goals"]),
        "achieved_goal": np.ravel(places),
        "desired_goal": seen["goals"][:, :3].ravel(),
    }


def goal_reward(achieved: Array, desired: Array) -> Any:
    """Reward for hindsight learning: 0 if all objects are within `ARRIVED` of their goals, or -1.

    Rotations do not count.

    Args:
        achieved: (..., 3 g) positions of the objects, m.
        desired: (..., 3 g) positions of their goals, m.

    Returns:
        Rewards (...), float64.
    """
    apart = np.asarray(achieved, float) - np.asarray(desired, float)
    off = np.sqrt(np.sum(apart.reshape(*apart.shape[:-1], -1, 3) ** 2, axis=-1))
    return -(off.max(axis=-1) > ARRIVED).astype(np.float64)
