"""Goal dictionaries, for methods that learn from hindsight."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces

from models.arithmetic import Array
from models.errors import InputError
from tasks.task import Task

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
