"""A demonstration as the columns of LeRobot: a row is a step of 16 ms."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from models.arithmetic import Array
from models.frames import FINGERS
from models.scene import CONTROL_PERIOD
from sandbox.datasets.demonstration import Demonstration

RATE = 1.0 / CONTROL_PERIOD
"""Hz, rows per second of simulated time."""
STATE, SURROUNDINGS = "observation.state", "observation.environment_state"
"""Columns of what is seen: of the hand, and of everything else."""
ACTION, EXACT = "action", "exact_action"
"""Columns of the action: in single precision, which LeRobot's policies learn in, and as it was
done, which gives the same states again."""
REWARD, DONE, SUCCESS, HASH = "next.reward", "next.done", "next.success", "next.state_hash"
"""Columns of what a step leads to."""

_AROUND = ("objects", "goals", "properties", "time")
"""Parts of an observation that are not the hand's."""
_COUNTERS = ("frame_index", "episode_index", "index", "task_index")


@dataclass(frozen=True)
class Feature:
    """Declaration of a column.

    Attributes:
        dtype: Its type, as NumPy and LeRobot name it.
        names: Name of each number of a row; None where it is a single one.
    """

    dtype: str
    names: tuple[str, ...] | None = None

    def as_json(self) -> dict[str, Any]:
        """The feature as `meta/info.json` has it."""
        size = len(self.names) if self.names else 1
        names = list(self.names) if self.names else None
        return {"dtype": self.dtype, "shape": [size], "names": names}


def features_of(episode: Demonstration, options: Mapping[str, Any]) -> dict[str, Feature]:
    """The columns of a data set.

    Args:
        episode: Any of its demonstrations.
        options: Options of its environment.
    """
    seen = episode.observations
    hands = [hand["side"] for hand in options["settings"]["hands"]]
    acts = _action_names(episode.actions.shape[1], hands)
    single = {name: Feature("int64") for name in _COUNTERS}
    return {
        STATE: Feature("float32", _names(seen, [n for n in seen if n not in _AROUND])),
        SURROUNDINGS: Feature("float32", _names(seen, [n for n in seen if n in _AROUND])),
        ACTION: Feature("float32", acts),
        EXACT: Feature("float64", acts),
        REWARD: Feature("float32"),
        DONE: Feature("bool"),
        SUCCESS: Feature("bool"),
        HASH: Feature("string"),
        "timestamp": Feature("float32"),
        **single,
    }


class Columns:
    """The columns of one episode.

    Args:
        episode: The demonstration, of T steps.
        number: Its number in the data set.
        first: Number of rows before it.

    Attributes:
        numbers: Column -> (T, n) values.
        hashes: (T) hashes of the states after the steps.
    """

    def __init__(self, episode: Demonstration, number: int, first: int) -> None:
        count = len(episode.rewards)
        steps, last = np.arange(count), np.arange(count) == count - 1
        seen = episode.observations
        by_place = [[n for n in seen if (n in _AROUND) == around] for around in (False, True)]
        state, around = (_flat(seen, names, count) for names in by_place)
        counters = (steps, np.full(count, number), first + steps, np.zeros(count, int))
        self.numbers: dict[str, Array] = {
            STATE: state,
            SURROUNDINGS: around,
            ACTION: episode.actions,
            EXACT: episode.actions,
            REWARD: episode.rewards[:, None],
            DONE: last[:, None],
            SUCCESS: (last & episode.success)[:, None],
            "timestamp": (steps / RATE)[:, None],
            **{n: v[:, None] for n, v in zip(_COUNTERS, counters, strict=True)},
        }
        # Truths count as 0 and 1.
        self.numbers = {name: np.asarray(v, float) for name, v in self.numbers.items()}
        self.hashes = episode.hashes[1:]

    def __len__(self) -> int:
        return len(self.hashes)

    def table(self, features: Mapping[str, Feature]) -> Any:
        """The columns as a table of pyarrow, with the types of the features."""
        import pyarrow as arrow

        columns = {}
        for name, feature in features.items():
            if name == HASH:
                columns[name] = arrow.array(self.hashes, arrow.string())
                continue
            values = self.numbers[name].astype(feature.dtype)
            flat = arrow.array(values.ravel())
            wide = feature.names is not None
            columns[name] = (
                arrow.FixedSizeListArray.from_arrays(flat, values.shape[1]) if wide else flat
            )
        return arrow.table(columns)

    @staticmethod
    def read(table: Any, row: Mapping[str, Any]) -> Demonstration:
        """The demonstration of an episode's rows.

        Args:
            table: The rows, as a table of pyarrow.
            row: The episode's row in the table of episodes.

        Raises:
            KeyError: A column is missing.
        """
        values = {name: np.array(table[name].to_pylist()) for name in (STATE, SURROUNDINGS, EXACT)}
        return Demonstration(
            int(row["seed"]),
            {name: values[name].astype(np.float32) for name in (STATE, SURROUNDINGS)},
            values[EXACT],
            np.array(table[REWARD].to_pylist()),
            row["terminated"],
            not row["terminated"],
            (row["first_state_hash"], *table[HASH].to_pylist()),
            json.loads(row["about"]),
        )


def _flat(seen: Mapping[str, Array], names: list[str], count: int) -> Array:
    """(count, n) observations before each step, side by side."""
    return np.concatenate([seen[name][:count].reshape(count, -1) for name in names], axis=1)


def _names(seen: Mapping[str, Array], parts: list[str]) -> tuple[str, ...]:
    """A name for each number: that of the part, and its place there."""
    return tuple(
        ".".join([part, *map(str, place)])
        for part in parts
        for place in product(*map(range, seen[part].shape[1:]))
    )


def _action_names(size: int, hands: list[str]) -> tuple[str, ...]:
    """Names of the numbers of an action: of each finger whether it touches, and where."""
    own = [f"{finger}.{what}" for finger in FINGERS for what in ("touch", "x", "y")]
    if size > len(own) * len(hands):
        own.append("lift")
    if len(hands) == 1:
        return tuple(own)
    return tuple(f"{hand}.{name}" for hand in hands for name in own)
