"""Data sets read from files, the kinds of data sets, and the comparison of played-back states.

`sandbox export` imports this module even when it writes motion. The module must therefore not need
the extra `gym`.
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
    """A data set that was read from files.

    Attributes:
        task: Name of the environment's task, or its place (`FILE.py`, `FILE.py:CLASS` or
            `MODULE:CLASS`).
        options: Options of the environment (`sandbox.gym.HandSandboxEnv`); JSON values.
        episodes: The demonstrations.
    """

    task: str
    options: dict[str, Any]
    episodes: tuple[Demonstration, ...]


def check_schema(path: Path, schema: Any, expected: int, to: str) -> None:
    """Checks that a data set has the format that this program reads.

    Args:
        path: The data set.
        schema: Number of the data set's format.
        expected: Number of the format that this program reads and writes.
        to: The words after `sandbox export RECORDING --to` that write such a data set.

    Raises:
        InputError: The data set has another format.
    """
    if schema != expected:
        raise InputError(
            "this data set has the format of another version",
            where=str(path),
            got=f"schema {schema}",
            expected=f"schema {expected}",
            remedy=f"Export its recordings again: `sandbox export RECORDING --to {to}`",
        )


MINARI, LEROBOT, NPZ = "minari", "lerobot", ".npz"
"""Values of --to that mean data sets, and the ending of a file that is a data set."""
NAMED = {MINARI: "hand_sandbox/box-to-goal/mine-v0", LEROBOT: "me/box-to-goal"}
"""Kind of data set -> example of a name, for kinds whose data sets have names."""


def is_data_set(to: Path) -> bool:
    """True if a value of --to means a data set.

    Raises:
        InputError: The value is `npz`, which lacks the name of a file.
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
