"""Steps simulators for learning, ours and others, and asks them for the same states again.

    python benchmarks/neighbours.py sandbox                 # the extra gym
    path/to/its/python benchmarks/neighbours.py robosuite

Each is run with a Python that has it, so this file imports nothing of ours unless asked to. Printed
are its version, MuJoCo's, the environment, control steps and simulated seconds for a second of
processor time with random actions, and whether the same seed and actions give the same states
twice, in this process. Tasks, hands and control rates differ: the numbers say what a step costs,
and not which simulator is quicker at the same thing. *-* means that it cannot be asked.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from importlib.metadata import PackageNotFoundError, version
from time import process_time
from typing import Any, NamedTuple

import numpy as np

STEPS, REPEATED = 200, 50
"""Control steps that are timed, and that are compared."""


class Made(NamedTuple):
    """An environment that can be stepped.

    Attributes:
        reset: Begins from a seed.
        step: Does a random action of a generator.
        state: All numbers of the physics.
        period: s simulated by a step.
    """

    reset: Callable[[int], object]
    step: Callable[[Any], object]
    state: Callable[[], Any]
    period: float


def of_gymnasium(env: Any, state: Callable[[Any], Any], period: float) -> Made:
    """An environment with the interface of Gymnasium."""
    low, high = env.action_space.low, env.action_space.high
    low, high = np.maximum(low, -1e3), np.minimum(high, 1e3)

    def step(rng: Any) -> None:
        _, _, terminated, truncated, _ = env.step(
            rng.uniform(low, high).astype(env.action_space.dtype)
        )
        if bool(terminated) or bool(truncated):
            env.reset(seed=0)

    return Made(lambda seed: env.reset(seed=seed), step, lambda: state(env.unwrapped), period)


def _mujoco_state(env: Any) -> Any:
    return np.concatenate([env.data.qpos, env.data.qvel])


def sandbox() -> tuple[str, Made]:
    """Ours."""
    import gymnasium

    id = "hand_sandbox/BoxToGoalLearn-v1"
    env: Any = gymnasium.make(f"sandbox.gym:{id}")
    return id, of_gymnasium(env, lambda own: _mujoco_state(own.session), 0.016)


def gymnasium_robotics(id: str = "HandManipulateBlock-v1") -> tuple[str, Made]:
    """Gymnasium-Robotics."""
    import gymnasium
    import gymnasium_robotics as package

    gymnasium.register_envs(package)
    env: Any = gymnasium.make(id)
    return id, of_gymnasium(env, _mujoco_state, env.unwrapped.dt)


def robosuite() -> tuple[str, Made]:
    """robosuite."""
    import robosuite as package

    def made(seed: int) -> Any:
        return package.make(
            "Lift",
            robots="Panda",
            has_renderer=False,
            has_offscreen_renderer=False,
            use_camera_obs=False,
            seed=seed,
            horizon=10**6,
        )

    kept = [made(0)]

    def reset(seed: int) -> None:
        # Its seed is one of making, not of resetting.
        kept[0] = made(seed)
        kept[0].reset()

    def step(rng: Any) -> None:
        kept[0].step(rng.uniform(*kept[0].action_spec))

    period = 1.0 / kept[0].control_freq
    return "Lift, Panda", Made(reset, step, lambda: kept[0].sim.get_state().flatten(), period)


def mani_skill() -> tuple[str, Made]:
    """ManiSkill."""
    import gymnasium
    import mani_skill.envs  # noqa: F401 for its ids

    id = "PickCube-v1"
    env: Any = gymnasium.make(id, obs_mode="state", sim_backend="physx_cpu", render_backend="none")
    period = 1.0 / env.unwrapped.control_freq
    return id, of_gymnasium(env, lambda own: own.get_state().numpy().ravel(), period)


KINDS: dict[str, Callable[[], tuple[str, Made]]] = {
    "sandbox": sandbox,
    "gymnasium_robotics": gymnasium_robotics,
    "robosuite": robosuite,
    "mani_skill": mani_skill,
}


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "-"


def _states(made: Made) -> Any:
    made.reset(3)
    rng, out = np.random.default_rng(1), []
    for _ in range(REPEATED):
        made.step(rng)
        out.append(np.array(made.state(), float))
    return np.array(out)


def main() -> None:
    """Prints a row."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("name", choices=list(KINDS))
    kind = parser.parse_args().name
    package = {"sandbox": "hand-sandbox"}.get(kind, kind)
    try:
        id, made = KINDS[kind]()
        made.reset(0)
        rng = np.random.default_rng(0)
        made.step(rng)
        begun = process_time()
        for _ in range(STEPS):
            made.step(rng)
        rate = STEPS / (process_time() - begun)
        same = "yes" if np.array_equal(_states(made), _states(made)) else "no"
        row = [id, f"{rate:.0f}", f"{rate * made.period:.1f}", same]
    except (AssertionError, ImportError, RuntimeError) as error:
        row = [f"does not start: {type(error).__name__} {error}".strip(), "-", "-", "-"]
    print(f"| {kind} {_version(package)} | {_version('mujoco')} | {' | '.join(row)} |")


if __name__ == "__main__":
    main()
