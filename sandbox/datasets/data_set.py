"""A data set that was read from files, in whichever form it was kept."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sandbox.datasets.demonstration import Demonstration


@dataclass(frozen=True)
class DataSet:
    """A data set that was read.

    Attributes:
        environment: Id and options of its environment.
        episodes: The demonstrations.
    """

    environment: dict[str, Any]
    episodes: tuple[Demonstration, ...]
