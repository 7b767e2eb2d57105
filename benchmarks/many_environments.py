"""Measures many environments at once: steps a second in one process and in several.

    python -m benchmarks.many_environments --count 8 --steps 50 --rounds 5

Environments for learning play box-to-goal with three fingers that rest beside the box. *One
process* steps them one after another. *Together* are `sandbox.gym.many.ManyEnvs`, where each
process has several; *a process each* are Gymnasium's `AsyncVectorEnv`. All ways have begun before
anything is measured, and take turns in each round, the first one of a round last in the next.

*Steps a second* are by the clock, the median of all rounds. On a machine that does other work,
several processes get more of it than one, so the ratio by the clock says too much. That *by
processors* does not depend on it: the time that one process computes for the steps, over the time
that the other way's processes compute for them, evenly on all processors, plus that of the process
that asks. Where the process that asks has a share of the environments, it is the longer of the two.
On a quiet machine the ratio by the clock is this one, but for what processes wait.

*Physics alone* are control periods of the same scene without hands' reconstruction, observation and
reward, by `mujoco.rollout` on one thread and on one a processor. Prints Markdown.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from time import perf_counter, process_time
from typing import Any

import gymnasium
import mujoco
import numpy as np
from mujoco import rollout

from benchmarks.machine import describe_machine
from models.arithmetic.arrays import Array
from models.scene import CONTROL_PERIOD
from sandbox.gym import learning_id
from sandbox.gym.many import ManyEnvs

FINGERS = ((0, 0.05, 0.09), (1, 0.06, 0.05), (2, 0.085, 0.045))
"""Label and place of each touch, m."""


def action() -> Array:
    """(15,) three fingers that touch."""
    rows = np.zeros((5, 3))
    for finger, x, y in FINGERS:
        rows[finger] = 1.0, x, y
    return rows.ravel()


def make() -> Any:
    """One environment."""
    return gymnasium.make(learning_id("box-to-goal"), observe="all")


class Way:
    """One way to step several environments.

    Args:
        name: Its name.
        step: Steps all of them once.
        pids: Its processes besides this one.
        shared: This process steps some of the environments while the others do.
    """

    def __init__(
        self,
        name: str,
        step: Callable[[], object],
        pids: Sequence[int] = (),
        shared: bool = False,
    ) -> None:
        self.name, self._step, self._pids, self._shared = name, step, pids, shared
        self.spent: list[float] = []
        self.alone: list[float] = []

    def measure(self, steps: int, cores: int) -> None:
        """Steps, and keeps the time by the clock, and that of a machine with nothing else to do,
        s: this process' time, and the others' side by side."""
        before, own, begun = [used(p) for p in self._pids], process_time(), perf_counter()
        for _ in range(steps):
            self._step()
        self.spent.append(perf_counter() - begun)
        own = process_time() - own
        others = [used(p) - then for p, then in zip(self._pids, before, strict=True)]
        side_by_side = max(sum(others) / cores, *others) if others else 0.0
        self.alone.append(max(own, side_by_side) if self._shared else own + side_by_side)


def used(pid: int) -> float:
    """s of processor time of a process and its threads (Linux)."""
    threads = Path(f"/proc/{pid}/task").glob("*/schedstat")
    return sum(int(each.read_text(encoding="utf-8").split()[0]) for each in threads) * 1e-9


def ways(count: int, cores: int) -> Iterator[Way]:
    """All ways, begun."""
    seeds: list[int | None] = [*range(count)]
    envs = [make() for _ in seeds]
    for seed, env in zip(seeds, envs, strict=True):
        env.reset(seed=seed)
    yield Way("one process", lambda: [env.step(action()) for env in envs])
    actions = np.tile(action(), (count, 1))
    many = ManyEnvs(learning_id("box-to-goal"), count, cores, observe="all")
    many.reset(seed=seeds)
    yield Way(f"together, {cores} processes", lambda: many.step(actions), many.pids, True)
    each: Any = gymnasium.vector.AsyncVectorEnv([make] * count)
    each.reset(seed=seeds)
    yield Way("a process each", lambda: each.step(actions), [p.pid for p in each.processes])


def physics(count: int, steps: int, threads: int) -> float:
    """s that the physics of as many control periods takes on threads."""
    env = make()
    env.reset(seed=0)
    session = env.unwrapped.session
    model, data = session.scene.model, session.data
    kind = mujoco.mjtState.mjSTATE_FULLPHYSICS
    state = np.empty(mujoco.mj_stateSize(model, kind))
    mujoco.mj_getState(model, data, state, kind)
    control = np.tile(data.ctrl, (count, steps * round(CONTROL_PERIOD / model.opt.timestep), 1))
    own = [mujoco.MjData(model) for _ in range(threads)]
    begun = perf_counter()
    rollout.rollout(model, own, np.tile(state, (count, 1)), control)
    return perf_counter() - begun


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--count", type=int, default=8, help="environments")
    parser.add_argument("--steps", type=int, default=50, help="control periods of each in a round")
    parser.add_argument("--cores", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--rounds", type=int, default=5)
    options = parser.parse_args()
    count, steps, cores = options.count, options.steps, options.cores
    print(f"{describe_machine()}\n")
    print(f"| {count} environments | steps a second | ratio by the clock | ratio by processors |")
    print("| --- | --- | --- | --- |")
    made = list(ways(count, cores))
    for turn in range(options.rounds):
        for way in made if turn % 2 == 0 else reversed(made):
            way.measure(steps, cores)
    first = made[0]
    for way in made:
        rate = count * steps / np.median(way.spent)
        clock = np.median(np.divide(first.spent, way.spent))
        alone = np.median(np.divide(first.alone, way.alone))
        print(f"| {way.name} | {rate:.0f} | {clock:.2f} | {alone:.2f} |", flush=True)
    for threads in (1, cores):
        rate = count * steps / physics(count, steps, threads)
        print(f"| physics alone, threads: {threads} | {rate:.0f} | | |", flush=True)


if __name__ == "__main__":
    main()
