"""A data set that was read from files, its kinds, and playing its demonstrations back.

Nothing here needs the extra `gym`: `sandbox export` writes motion without it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from models.arithmetic import Array
from models.errors import InputError

if TYPE_CHECKING:
    from sandbox.datasets.played_trial import Demonstration


@dataclass(frozen=True)
class DataSet:
    """A data set that was read.

    Attributes:
        task: The task of its environment, a name or a place.
        options: Options of its environment (`sandbox.gym.HandSandboxEnv`); JSON values.
        episodes: The demonstrations.
    """

    task: str
    options: dict[str, Any]
    episodes: tuple[Demonstration, ...]


def check_schema(path: Path, schema: Any, expected: int, to: str) -> None:
    """Checks that a data set has the form that this version reads.

    Args:
        path: The data set.
        schema: Number of its form.
        expected: Number of the form that this version reads and writes.
        to: The words after `sandbox export RECORDING --to` that write one.

    Raises:
        InputError: It has another form.
    """
    if schema != expected:
        raise InputError(
            "this data set is of another version",
            where=str(path),
            got=f"schema {schema}",
            expected=f"schema {expected}",
            remedy=f"Export its recordings again: `sandbox export RECORDING --to {to}`",
        )


MINARI, LEROBOT, NPZ = "minari", "lerobot", ".npz"
"""Words after --to that stand for data sets, and the ending of a file that is one."""
NAMED = {MINARI: "hand_sandbox/box-to-goal/mine-v0", LEROBOT: "me/box-to-goal"}
"""Word of a kind whose data sets have names -> such a name."""


def is_data_set(to: Path) -> bool:
    """True if a word after --to stands for a data set.

    Raises:
        InputError: It is that of a data set, and lacks a part.
    """
    if str(to) == "npz":
        raise InputError("name the file", where=f"--to {to}", expected="FILE.npz")
    return str(to) in NAMED or to.suffix.lower() == NPZ


def first_difference(env: Any, seed: int, actions: Array, hashes: Sequence[str]) -> int | None:
    """Plays an episode's actions and compares every state.

    Args:
        env: The data set's environment.
        seed: Seed of the episode.
        actions: (T, n) actions.
        hashes: (T + 1) hashes of the states.

    Returns:
        Number of steps before the first state that differs; None if all are equal.
    """
    _, info = env.reset(seed=seed)
    if info["state_hash"] != hashes[0]:
        return 0
    for step, (action, expected) in enumerate(zip(actions, hashes[1:], strict=True), start=1):
        *_, info = env.step(action)
        if info["state_hash"] != expected:
            return step
    return None
