"""Goal dictionaries, for methods that learn from hindsight."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces

from models.arithmetic.arrays import Array
from models.errors import InputError
from sandbox.gym.learning.environment import LearningEnv

ARRIVED = 0.010
"""m within which a thing counts as arrived."""

GoalObservation = dict[str, Array]


class Hindsight(gymnasium.Env[GoalObservation, Array]):
    """Observations with `observation`, `achieved_goal` and `desired_goal`.

    The goals are places (g, 3) m, of the things that have goals and where they should be, flat. The
    reward of a step is `compute_reward` of it: 0 if all things are within `ARRIVED` of their goals,
    and -1 otherwise. Turns do not count in it; `info["is_success"]` is the task's own verdict.

    Args:
        env: An environment of a task with goals, which is this one's own from then on.

    Attributes:
        learning: That environment.

    Raises:
        InputError: The task has no goals.
    """

    metadata = LearningEnv.metadata

    def __init__(self, env: LearningEnv) -> None:
        space = env.observation_space
        assert isinstance(space, spaces.Dict)
        if "goals" not in space.spaces:
            raise InputError("this task has no goals to learn from", where=env.settings.task)
        self.learning: LearningEnv = env
        self.render_mode = env.render_mode
        self.action_space = env.action_space
        self._rest: list[str] = [name for name in space.spaces if name != "goals"]
        rest = [space[name] for name in self._rest]
        low = np.concatenate([np.ravel(box.low) for box in rest if isinstance(box, spaces.Box)])
        high = np.concatenate([np.ravel(box.high) for box in rest if isinstance(box, spaces.Box)])
        goals = space["goals"]
        assert isinstance(goals, spaces.Box)
        where = spaces.Box(goals.low[:, :3].ravel(), goals.high[:, :3].ravel(), dtype=np.float64)
        shown: Any = spaces.Dict(
            {
                "observation": spaces.Box(low, high, dtype=np.float64),
                "achieved_goal": where,
                "desired_goal": spaces.Box(where.low, where.high, dtype=np.float64),
            }
        )
        self.observation_space = shown

    def compute_reward(self, achieved_goal: Array, desired_goal: Array, info: Any) -> Any:
        """Reward of places (..., 3 g) for wanted places (..., 3 g); -1 or 0, float64 (...)."""
        apart = np.asarray(achieved_goal, float) - np.asarray(desired_goal, float)
        off = np.sqrt(np.sum(apart.reshape(*apart.shape[:-1], -1, 3) ** 2, axis=-1))
        return -(off.max(axis=-1) > ARRIVED).astype(np.float64)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[GoalObservation, dict[str, Any]]:
        """Starts a new trial; see `LearningEnv.reset`."""
        super().reset(seed=seed)
        seen, info = self.learning.reset(seed=seed, options=options)
        return self._goals(seen), info

    def step(self, action: Array) -> tuple[GoalObservation, float, bool, bool, dict[str, Any]]:
        """One control period."""
        seen, _, terminated, truncated, info = self.learning.step(action)
        goals = self._goals(seen)
        reward = self.compute_reward(goals["achieved_goal"], goals["desired_goal"], info)
        return goals, float(reward), terminated, truncated, info

    def render(self) -> Any:
        """The picture of now; see `LearningEnv.render`."""
        return self.learning.render()

    def close(self) -> None:
        """Gives back what draws."""
        self.learning.close()

    def _goals(self, seen: dict[str, Array]) -> GoalObservation:
        session = self.learning.session
        assert session is not None
        names = [thing.name for thing in session.task.objects]
        places = [seen["objects"][names.index(goal.object), :3] for goal in session.task.goals]
        return {
            "observation": np.concatenate([np.ravel(seen[name]) for name in self._rest]),
            "achieved_goal": np.ravel(places),
            "desired_goal": np.ravel(seen["goals"][:, :3]),
        }


def make(**options: Any) -> Hindsight:
    """An environment with goal dictionaries.

    Args:
        options: As for `LearningEnv`, without a reward.

    Raises:
        InputError: A reward is asked for, or the task has no goals.
    """
    if "reward" in options:
        raise InputError(
            "goal dictionaries bring their own reward", where="reward", got=options["reward"]
        )
    return Hindsight(LearningEnv(**options))
