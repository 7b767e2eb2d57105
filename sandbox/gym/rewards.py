"""Rewards of an agent, step by step, and goal dictionaries for learning from hindsight."""

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
"""Share of an episode's reward that bringing fingertips to objects can earn."""
NEAR = 0.10
"""m, distance at which a fingertip has earned about a third of it."""
TIPS = 3
"""Number of fingertips that count, the nearest ones."""


class Reward:
    """Reward of one episode.

    Of every choice the sum is bounded: success gives 1, `progress` what the task's progress grew by
    (0 to 1), and `reach` besides that at most `REACH` for the way of the three nearest fingertips
    to the nearest object. Going back costs what coming gave.

    Args:
        kind: One of `sandbox.gym.environment_options.REWARDS`.
        snapshot: The beginning of the episode.
        progress: The task's progress then.
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
"""m within which an object counts as arrived."""


def goal_space(space: spaces.Dict, task: str) -> spaces.Dict:
    """The space of goal dictionaries, float64.

    `observation` is all that is seen but the goals, flat. `achieved_goal` and `desired_goal` are
    places (g, 3) m, of the objects that have goals and where they should be, flat.

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
        space: The space of plain observations, whose order `observation` has.
        task: The trial.
    """
    names = [shown.name for shown in task.objects]
    places = [seen["objects"][names.index(goal.object), :3] for goal in task.goals]
    return {
        "observation": np.concatenate([seen[name].ravel() for name in space if name != "goals"]),
        "achieved_goal": np.ravel(places),
        "desired_goal": seen["goals"][:, :3].ravel(),
    }


def goal_reward(achieved: Array, desired: Array) -> Any:
    """Reward of places (..., 3 g) m for desired places (..., 3 g) m.

    It is 0 if all objects are within `ARRIVED` of their goals, and -1 otherwise. Turns do not
    count.

    Returns:
        (...) float64.
    """
    apart = np.asarray(achieved, float) - np.asarray(desired, float)
    off = np.sqrt(np.sum(apart.reshape(*apart.shape[:-1], -1, 3) ** 2, axis=-1))
    return -(off.max(axis=-1) > ARRIVED).astype(np.float64)
