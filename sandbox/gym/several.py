"""Several environments of one process, stepped one after another."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import gymnasium
import numpy as np

from models.arithmetic.arrays import Array


class Answer(NamedTuple):
    """What environments answered to what each was asked.

    Attributes:
        error: What the first of them that failed raised; the others after it were not asked. None
            if all answered.
        seen: (n, m) observations, a row for each environment, their parts one after another.
        outcomes: (n, 3) reward, and 1 where a trial ended and where it was cut short.
        infos: Of each.
    """

    error: Exception | None
    seen: Array
    outcomes: Array
    infos: list[dict[str, Any]]


class Several:
    """Equal environments, each of which starts anew at the step after its trial is over.

    Args:
        id: An environment's id, with its module: `MODULE:ID`; without one, of this package.
        count: Number of environments.
        options: Options of the environment.

    Attributes:
        first: The first of them.
    """

    def __init__(self, id: str, count: int, options: Mapping[str, Any]) -> None:
        full = id if ":" in id else f"sandbox.gym:{id}"
        self._envs: list[Any] = [gymnasium.make(full, **options) for _ in range(count)]
        self._over = [False] * count
        self.first = self._envs[0]
        self._names = list(self.first.observation_space)

    def answer(self, what: str, each: Iterable[Any]) -> Answer:
        """Asks every environment.

        Args:
            what: `reset` or `step`.
            each: For every environment a seed and options of `reset`; or its action.
        """
        count = len(self._envs)
        seen: list[Array] = []
        outcomes, infos = np.zeros((count, 3)), list[dict[str, Any]]()
        error: Exception | None = None
        try:
            for i, (env, asked) in enumerate(zip(self._envs, each, strict=True)):
                if what == "reset":
                    one, info = env.reset(seed=asked[0], options=asked[1])
                    self._over[i] = False
                elif self._over[i]:
                    one, info = env.reset()
                    self._over[i] = False
                else:
                    one, *outcomes[i], info = env.step(asked)
                    self._over[i] = bool(outcomes[i, 1:].any())
                seen.append(np.concatenate([one[name].ravel() for name in self._names]))
                infos.append(info)
        except Exception as raised:  # for the process that asks, which raises it
            error = raised
        return Answer(error, np.array(seen), outcomes, infos)

    def close(self) -> None:
        """Closes all."""
        for env in self._envs:
            env.close()
