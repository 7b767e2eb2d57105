"""Data sets as a single NumPy file, .npz. It needs no other library."""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from models.arithmetic import Array
from models.errors import InputError
from sandbox.datasets.data_set import DataSet, check_schema
from sandbox.datasets.played_trial import Demonstration

KIND, SCHEMA = "hand sandbox demonstrations", 2
OBSERVATION = "observation."
"""Prefix of the arrays of observations."""


def check_npz(path: Path) -> None:
    """Checks, before recordings are played, that a file can be written.

    Raises:
        InputError: The path is a folder, or no file can be created in its folder.
    """
    try:
        if path.is_dir():
            raise InputError("this is a folder", where=str(path), expected="a file")
        part = _temporary(path)
        part.touch()
        part.unlink()
    except OSError as error:
        raise InputError(
            "the data set cannot be written", where=str(path), got=error.strerror
        ) from None


def _temporary(path: Path) -> Path:
    """The file that is written first, in the same folder."""
    return path.with_name(f".{path.name}.part")


def write_npz(
    path: Path, task: str, options: Mapping[str, Any], episodes: Iterable[Demonstration]
) -> None:
    """Writes a data set. An existing file is replaced once the data set is complete.

    In every episode, `observation.NAME` and `state_hash` have one row more than `action`, `reward`,
    `terminated` and `truncated`: the row before the first step. `steps` has the number of steps of
    each episode. `about` is JSON text.

    Args:
        path: The file.
        task: Name of the environment's task, or its place (`FILE.py`, `FILE.py:CLASS` or
            `MODULE:CLASS`).
        options: Options of the environment; JSON values.
        episodes: The demonstrations; at least one.

    Raises:
        InputError: The file cannot be written.
    """
    whole = list(episodes)
    arrays: dict[str, Any] = {
        f"{OBSERVATION}{name}": np.concatenate([e.observations[name] for e in whole])
        for name in whole[0].observations
    }
    ends = [np.arange(len(e.rewards)) == len(e.rewards) - 1 for e in whole]
    arrays |= {
        "action": np.concatenate([e.actions for e in whole]),
        "reward": np.concatenate([e.rewards for e in whole]),
        "terminated": np.concatenate(
            [at & e.terminated for at, e in zip(ends, whole, strict=True)]
        ),
        "truncated": np.concatenate([at & e.truncated for at, e in zip(ends, whole, strict=True)]),
        "state_hash": np.array([hash for e in whole for hash in e.hashes]),
        "steps": np.array([len(e.rewards) for e in whole]),
        "seed": np.array([e.seed for e in whole]),
        "about": np.array(
            json.dumps(
                {
                    "kind": KIND,
                    "schema": SCHEMA,
                    "task": task,
                    "options": dict(options),
                    "episodes": [e.about for e in whole],
                }
            )
        ),
    }
    part = _temporary(path)
    try:
        with part.open("wb") as file:
            np.savez_compressed(file, **arrays)
        part.replace(path)
    except OSError as error:
        part.unlink(missing_ok=True)
        raise InputError(
            "the data set cannot be written", where=str(path), got=error.strerror
        ) from None


def read_npz(path: Path) -> DataSet:
    """Reads a data set.

    Raises:
        InputError: The file cannot be read, is incomplete, is of another version, or is not a data
            set.
    """
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        about = json.loads(str(arrays.pop("about")))
        if about["kind"] != KIND:
            raise ValueError(about["kind"])
        check_schema(path, about["schema"], SCHEMA, "FILE.npz")
        episodes = tuple(_episodes(arrays, about["episodes"]))
        return DataSet(about["task"], about["options"], episodes)
    except OSError as error:
        raise InputError("cannot be read", where=str(path), got=error.strerror) from None
    except (ValueError, KeyError, TypeError, EOFError, zipfile.BadZipFile) as error:
        raise InputError(
            "this is not a complete data set",
            where=str(path),
            got=str(error),
            remedy="`sandbox export RECORDING --to FILE.npz` writes a data set",
        ) from None


def _episodes(arrays: Mapping[str, Array], about: list[Any]) -> Iterator[Demonstration]:
    steps = [int(count) for count in arrays["steps"]]
    after = [sum(steps[:i]) for i in range(len(steps) + 1)]
    if len(arrays["action"]) != after[-1] or len(arrays["state_hash"]) != after[-1] + len(steps):
        raise ValueError("the lengths of arrays and episodes do not match")
    for i, (count, known) in enumerate(zip(steps, about, strict=True)):
        of = slice(after[i], after[i] + count)
        # Observations have one more row in each episode.
        seen = slice(after[i] + i, after[i] + i + count + 1)
        yield Demonstration(
            int(arrays["seed"][i]),
            {
                name.removeprefix(OBSERVATION): values[seen]
                for name, values in arrays.items()
                if name.startswith(OBSERVATION)
            },
            arrays["action"][of],
            arrays["reward"][of],
            bool(arrays["terminated"][of].any()),
            bool(arrays["truncated"][of].any()),
            tuple(arrays["state_hash"][seen].tolist()),
            known,
        )
