"""Measures many environments at once: steps a second in one process and in several.

    python -m benchmarks.many_environments --count 8 --steps 200

Environments for learning play box-to-goal with three fingers that rest beside the box. *One
process* steps them one after another; *a process each* are Gymnasium's `AsyncVectorEnv`; *one
process a core* divides them evenly. *Physics alone* are control periods of the same scene without
hands' reconstruction, observation and reward, by `mujoco.rollout` on one thread and on one a core.
Prints Markdown. On a busy machine several processes get more of it than one, so compare only on a
quiet one; the load is printed.
"""

from __future__ import annotations

import argparse
import os
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from time import perf_counter
from typing import Any

import gymnasium
import mujoco
import numpy as np
from mujoco import rollout

from benchmarks.machine import describe_machine
from models.arithmetic.arrays import Array
from models.scene import CONTROL_PERIOD
from sandbox.gym import learning_id

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


def loop(count: int, steps: int) -> float:
    """s that environments take in this process."""
    envs = [make() for _ in range(count)]
    for seed, env in enumerate(envs):
        env.reset(seed=seed)
    begun = perf_counter()
    for _ in range(steps):
        for env in envs:
            env.step(action())
    return perf_counter() - begun


def divided(count: int, steps: int, workers: int) -> float:
    """s that environments take, divided over processes that have begun already."""
    share = [count // workers + (i < count % workers) for i in range(workers)]
    with ProcessPoolExecutor(workers) as pool:
        return max(pool.map(partial(loop, steps=steps), share))


def vector(count: int, steps: int) -> float:
    """s that environments with a process each take."""
    envs = gymnasium.vector.AsyncVectorEnv([make for _ in range(count)])
    envs.reset(seed=list(range(count)))
    actions = np.tile(action(), (count, 1))
    begun = perf_counter()
    for _ in range(steps):
        envs.step(actions)
    spent = perf_counter() - begun
    envs.close()
    return spent


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
    parser.add_argument("--steps", type=int, default=200, help="control periods of each")
    parser.add_argument("--cores", type=int, default=os.cpu_count() or 1)
    options = parser.parse_args()
    count, steps, cores = options.count, options.steps, options.cores
    ways: dict[str, Callable[[], float]] = {
        "one process": lambda: loop(count, steps),
        "a process each": lambda: vector(count, steps),
        f"one process a core ({cores})": lambda: divided(count, steps, cores),
        "physics alone, one thread": lambda: physics(count, steps, 1),
        f"physics alone, {cores} threads": lambda: physics(count, steps, cores),
    }
    print(f"{describe_machine()}\n")
    print(f"| {count} environments | steps a second | ratio to one process |\n| --- | --- | --- |")
    first = 0.0
    for name, measure in ways.items():
        rate = count * steps / measure()
        first = first or rate
        print(f"| {name} | {rate:.0f} | {rate / first:.2f} |", flush=True)


if __name__ == "__main__":
    main()
