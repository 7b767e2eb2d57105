"""A data set that was read from files, in whichever form it was kept."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from models.errors import InputError
from sandbox.datasets.demonstration import Demonstration


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
