"""Many environments at once, divided over as many processes as there are processors."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from multiprocessing import get_context
from multiprocessing.connection import Connection
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector.utils import batch_space

from models.arithmetic.arrays import Array
from models.errors import InputError
from sandbox.gym.several import Answer, Several


class ManyEnvs(gymnasium.vector.VectorEnv):
    """Equal environments, which are stepped together.

    Each process has several environments and steps them one after another. The process that asks
    has its share, too, as it would only wait for the others. A process for each environment, as in
    `gymnasium.vector.AsyncVectorEnv`, makes processors change from one to the next several times a
    step. Episodes are those of one environment alone: same seeds and actions, same states. An
    environment that is over starts anew at the next step (Gymnasium's `AutoresetMode.NEXT_STEP`),
    and its action of that step is left out.

    Args:
        id: An environment's id, such as `hand_sandbox/BoxToGoalLearn-v1`. What registers another id
            is named before it, `MODULE:ID`, since every process imports it.
        count: Number of environments.
        processes: Number of processes, with this one; None takes as many as there are processors to
            use.
        **options: Options of the environment.

    Raises:
        InputError: There are no environments or processes, or an option is not allowed.
    """

    metadata = {  # noqa: RUF012 as the base class has it
        "autoreset_mode": gymnasium.vector.AutoresetMode.NEXT_STEP
    }

    def __init__(self, id: str, count: int, processes: int | None = None, **options: Any) -> None:
        if processes is None:
            here = hasattr(os, "sched_getaffinity")
            # A container or a scheduler may leave fewer of them to this program.
            processes = len(os.sched_getaffinity(0)) if here else os.cpu_count() or 1
        for what, number in (("environments", count), ("processes", processes)):
            if number < 1:
                raise InputError(f"there must be {what}", where="many", got=number, expected=">= 1")
        shares = [len(part) for part in np.array_split(np.arange(count), processes)]
        own, *others = [share for share in shares if share]
        self._several = Several(id, own, options)
        first = self._several.first
        self.spec = first.spec
        self.num_envs = count
        self.single_observation_space = first.observation_space
        self.single_action_space = first.action_space
        parts = [(name, space.shape) for name, space in first.observation_space.items()]
        self._parts = [(name, shape, int(np.prod(shape))) for name, shape in parts]
        self.observation_space = batch_space(self.single_observation_space, count)
        self.action_space = batch_space(self.single_action_space, count)
        # Processes begin from nothing: threads and OpenGL of this one do not come along.
        context = get_context("spawn")
        self._shares = others
        self._pipes: list[Connection] = []
        self._processes = []
        for share in others:
            ours, theirs = context.Pipe()
            process = context.Process(target=_work, args=(theirs, id, share, options), daemon=True)
            process.start()
            theirs.close()
            self._pipes.append(ours)
            self._processes.append(process)

    @property
    def pids(self) -> list[int]:
        """Numbers of the other processes."""
        return [process.pid or 0 for process in self._processes]

    def reset(
        self,
        *,
        seed: int | Sequence[int | None] | None = None,
        options: dict[str, Any] | None = None,
    ) -> tuple[dict[str, Array], dict[str, Any]]:
        """Starts a new trial in each.

        Args:
            seed: Of each; or of the first, and the others follow; or None, and they are drawn.
            options: As of one environment, for all.
        """
        count = self.num_envs
        seeds = [seed] * count if seed is None else seed
        if isinstance(seeds, int):
            seeds = list(range(seeds, seeds + count))
        if len(seeds) != count:
            raise InputError(
                "there must be a seed for each", where="reset", got=len(seeds), expected=str(count)
            )
        seen, _, infos = self._together("reset", [(own, options) for own in seeds])
        return seen, self._told(infos)

    def step(self, actions: Array) -> tuple[dict[str, Array], Array, Array, Array, dict[str, Any]]:
        """One control period of each.

        Args:
            actions: (count, n), of each.
        """
        if len(actions) != self.num_envs:
            raise InputError(
                "there must be an action for each",
                where="step",
                got=len(actions),
                expected=str(self.num_envs),
            )
        seen, outcomes, infos = self._together("step", actions)
        rewards, ended, cut = outcomes.T
        return seen, rewards.copy(), ended > 0.0, cut > 0.0, self._told(infos)

    def close_extras(self, **kwargs: Any) -> None:
        """Ends the other processes."""
        self._several.close()
        for pipe in self._pipes:
            pipe.close()
        for process in self._processes:
            process.join()

    def _together(self, what: str, each: Any) -> tuple[dict[str, Array], Array, list[Any]]:
        """What all environments answer to what each is asked: what is seen, rewards and ends
        (count, 3), and infos."""
        own = begun = self.num_envs - sum(self._shares)
        for pipe, share in zip(self._pipes, self._shares, strict=True):
            self._kept(partial(pipe.send, (what, each[begun : begun + share])))
            begun += share
        answers: list[Answer] = [self._several.answer(what, each[:own])]
        answers += [self._kept(pipe.recv) for pipe in self._pipes]
        for error, *_ in answers:
            if error is not None:
                raise error
        _, flat, outcomes, infos = zip(*answers, strict=True)
        whole = np.concatenate(flat)
        seen, begun = {}, 0
        for name, shape, size in self._parts:
            seen[name] = whole[:, begun : begun + size].reshape(-1, *shape)
            begun += size
        return seen, np.concatenate(outcomes), [info for row in infos for info in row]

    def _kept(self, act: Callable[[], Any]) -> Any:
        try:
            return act()
        except (EOFError, OSError):
            raise InputError(
                "a process with environments has ended",
                where="many",
                remedy="Its own error is above, if it had one; memory may have run out",
            ) from None

    def _told(self, infos: Sequence[dict[str, Any]]) -> dict[str, Any]:
        out: dict[str, Any] = {}
        for name in infos[0]:
            values = [info.get(name) for info in infos]
            kind = type(values[0])
            if any(type(value) is not kind for value in values) or kind is dict:
                break
            column = np.empty(len(values), kind if kind in (bool, int, float) else object)
            column[:] = values
            out[name], out[f"_{name}"] = column, np.ones(len(values), bool)
        else:
            if all(len(info) == len(infos[0]) for info in infos):
                return out
        out = {}
        for number, info in enumerate(infos):
            out = self._add_info(out, info, number)
        return out


def _work(pipe: Connection, id: str, count: int, options: Mapping[str, Any]) -> None:
    """Steps environments in a process of their own, until the pipe is closed."""
    several = Several(id, count, options)
    while True:
        try:
            what, each = pipe.recv()
        except (EOFError, KeyboardInterrupt):
            break
        pipe.send(several.answer(what, each))
    several.close()
