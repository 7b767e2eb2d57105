"""Data sets of LeRobot: folders in the format LeRobotDataset v3.0. They need the extra `datasets`.

Source: the format as lerobot 0.4.4 writes and reads it.
"""

from __future__ import annotations

import json
import os
import re
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from models.arithmetic import Array
from models.errors import InputError
from models.frames import FINGERS
from models.scene import CONTROL_PERIOD
from sandbox.datasets.data_set import DataSet, check_schema
from sandbox.datasets.played_trial import Demonstration
from sandbox.recording.versions import versions

RATE = 1.0 / CONTROL_PERIOD
"""Hz, rows per second of simulated time."""
STATE, SURROUNDINGS = "observation.state", "observation.environment_state"
"""Columns of the observation: of the hand, and of everything else."""
ACTION, EXACT = "action", "exact_action"
"""Columns of the action: in single precision, for LeRobot's policies; and in double precision,
which gives the same states again."""
REWARD, DONE, SUCCESS, HASH = "next.reward", "next.done", "next.success", "next.state_hash"
"""Columns of the results of a step."""

_AROUND = ("objects", "goals", "properties", "time")
"""Parts of an observation that are not the hand's."""
_COUNTERS = ("frame_index", "episode_index", "index", "task_index")


@dataclass(frozen=True)
class Feature:
    """Declaration of a column.

    Attributes:
        dtype: Type of the column, named as in NumPy and LeRobot.
        names: Name of each number in a row; None if a row has a single number.
    """

    dtype: str
    names: tuple[str, ...] | None = None

    def as_json(self) -> dict[str, Any]:
        """The feature in the form of `meta/info.json`."""
        size = len(self.names) if self.names else 1
        names = list(self.names) if self.names else None
        return {"dtype": self.dtype, "shape": [size], "names": names}


def features_of(episode: Demonstration, options: Mapping[str, Any]) -> dict[str, Feature]:
    """The declarations of the columns of a data set.

    Args:
        episode: Any demonstration of the data set.
        options: Options of the data set's environment.
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
        number: Number of the episode in the data set.
        first: Number of rows before the episode.

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
        # Booleans become 0 and 1.
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
    """Values (count, n) of some parts of the observations before each step, side by side."""
    return np.concatenate([seen[name][:count].reshape(count, -1) for name in names], axis=1)


def _names(seen: Mapping[str, Array], parts: list[str]) -> tuple[str, ...]:
    """A name for each number: the name of the part, and the indices in the part."""
    return tuple(
        ".".join([part, *map(str, place)])
        for part in parts
        for place in product(*map(range, seen[part].shape[1:]))
    )


def _action_names(size: int, hands: list[str]) -> tuple[str, ...]:
    """Names of the numbers of an action: for each finger, whether it touches, and its place."""
    own = [f"{finger}.{what}" for finger in FINGERS for what in ("touch", "x", "y")]
    if size > len(own) * len(hands):
        own.append("lift")
    if len(hands) == 1:
        return tuple(own)
    return tuple(f"{hand}.{name}" for hand in hands for name in own)


QUANTILES = (0.01, 0.10, 0.50, 0.90, 0.99)
"""The quantiles that LeRobot stores, named q01, q10 and so on."""

Statistics = dict[str, Array]
"""Name -> (n,) values: min, max, mean, std, the quantiles, and the number of rows as count (1,)."""


def statistics_of(values: Array) -> Statistics:
    """Statistics of every column of (T, n) values."""
    return {
        "min": values.min(axis=0),
        "max": values.max(axis=0),
        "mean": values.mean(axis=0),
        "std": values.std(axis=0),
        "count": np.array([len(values)]),
        **dict(zip(map(_name, QUANTILES), np.quantile(values, QUANTILES, axis=0), strict=True)),
    }


def combined(parts: Sequence[Statistics]) -> Statistics:
    """Statistics of several episodes together.

    A quantile is the mean of the episodes' quantiles, weighted by the episodes' lengths, as in
    LeRobot. All other statistics are exact.
    """
    counts = np.array([part["count"][0] for part in parts], float)
    share = (counts / counts.sum())[:, None]
    means = np.array([part["mean"] for part in parts])
    mean = (share * means).sum(axis=0)
    squares = np.array([part["std"] for part in parts]) ** 2 + (means - mean) ** 2
    return {
        "min": np.min([part["min"] for part in parts], axis=0),
        "max": np.max([part["max"] for part in parts], axis=0),
        "mean": mean,
        "std": np.sqrt((share * squares).sum(axis=0)),
        "count": np.array([int(counts.sum())]),
        **{
            name: (share * np.array([part[name] for part in parts])).sum(axis=0)
            for name in map(_name, QUANTILES)
        },
    }


def _name(quantile: float) -> str:
    return f"q{round(100 * quantile):02d}"


VERSION = "v3.0"
"""Version of LeRobot's format."""
FILE_SIZE = 100
"""Size in MB after which a new file of frames begins, as in LeRobot."""
FILES = 1000
"""Number of files in one folder, as in LeRobot."""
OURS = "meta/hand_sandbox.json"
"""File with the values that have no place in LeRobot's files: task and options of the environment,
and versions."""
KIND, SCHEMA = "hand sandbox demonstrations", 2

_NAME = re.compile(r"[A-Za-z0-9][\w.-]*/[A-Za-z0-9][\w.-]*")
_FILE = "chunk-{chunk_index:03d}/file-{file_index:03d}"
_DATA, _EPISODES = f"data/{_FILE}.parquet", f"meta/episodes/{_FILE}.parquet"


def need_parquet() -> Any:
    """The module `pyarrow`, with `pyarrow.parquet` in it.

    Raises:
        InputError: pyarrow or pandas is not installed.
    """
    try:
        import pandas  # noqa: F401
        import pyarrow
        import pyarrow.parquet
    except ImportError:
        raise InputError(
            "pyarrow and pandas are not installed",
            where="--to lerobot",
            remedy="pip install 'hand-sandbox[datasets]'",
        ) from None
    return pyarrow


def lerobot_folder(name: str) -> Path:
    """The folder in which LeRobot looks for a local data set.

    Args:
        name: Name of the data set, `OWNER/NAME`.

    Raises:
        InputError: The name has another form.
    """
    if not _NAME.fullmatch(name):
        raise InputError(
            "not a name of a data set of LeRobot",
            where="--name",
            got=name or "nothing",
            expected="OWNER/NAME, such as me/box-to-goal",
        )
    caches = Path(os.environ.get("XDG_CACHE_HOME") or "~/.cache")
    home = Path(os.environ.get("HF_HOME") or caches / "huggingface")
    return Path(os.environ.get("HF_LEROBOT_HOME") or home / "lerobot").expanduser() / name


def check_folder(name: str) -> Path:
    """The folder of a new data set.

    Raises:
        InputError: The name has a wrong form, the folder exists, or pyarrow is missing.
    """
    folder = lerobot_folder(name)
    if folder.exists():
        raise InputError(
            "there is a data set of this name",
            where="--name",
            got=f"{name}, in {folder}",
            remedy="Choose another name, or delete the folder",
        )
    need_parquet()
    return folder


def write_lerobot(
    folder: Path,
    words: str,
    task: str,
    options: Mapping[str, Any],
    episodes: Iterable[Demonstration],
) -> None:
    """Writes a data set, one episode after another. The folder appears once the set is complete.

    Args:
        folder: The folder; it must not exist.
        words: Description of the task in words, for LeRobot's policies.
        task: Name of the environment's task, or its place (`FILE.py`, `FILE.py:CLASS` or
            `MODULE:CLASS`).
        options: Options of the environment; JSON values.
        episodes: The demonstrations; at least one.

    Raises:
        InputError: The folder cannot be written.
    """
    beside = folder.with_name(f".{folder.name}.part")
    try:
        shutil.rmtree(beside, ignore_errors=True)
        (beside / "meta").mkdir(parents=True)
        _write(beside, words, task, options, episodes)
        beside.rename(folder)
    except OSError as error:
        raise InputError(
            "the data set cannot be written", where=str(folder), got=error.strerror
        ) from None
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _write(
    folder: Path,
    words: str,
    task: str,
    options: Mapping[str, Any],
    episodes: Iterable[Demonstration],
) -> None:
    arrow = need_parquet()
    features: dict[str, Feature] = {}
    rows: list[dict[str, Any]] = []
    statistics: list[dict[str, Statistics]] = []
    with _Frames(folder) as frames:
        for number, episode in enumerate(episodes):
            features = features or features_of(episode, options)
            columns = Columns(episode, number, frames.count)
            own = {name: statistics_of(values) for name, values in columns.numbers.items()}
            statistics.append(own)
            first, file = frames.count, frames.write(columns.table(features))
            rows.append(
                {
                    "episode_index": number,
                    "tasks": [words],
                    "length": len(columns),
                    "dataset_from_index": first,
                    "dataset_to_index": frames.count,
                    "data/chunk_index": file // FILES,
                    "data/file_index": file % FILES,
                    "meta/episodes/chunk_index": 0,
                    "meta/episodes/file_index": 0,
                    **_known(episode),
                    **_listed(own),
                }
            )
    path = _path(folder, _EPISODES, 0)
    path.parent.mkdir(parents=True)
    arrow.parquet.write_table(arrow.Table.from_pylist(rows), path)
    _write_tasks(folder, words)
    whole = {name: combined([own[name] for own in statistics]) for name in statistics[0]}
    stats = {name: {k: v.tolist() for k, v in own.items()} for name, own in whole.items()}
    _write_json(folder / "meta/stats.json", stats)
    robot = options["settings"]["physics"]["robot"] or "hand_sandbox"
    _write_json(folder / "meta/info.json", _info(features, robot, len(rows), frames.count))
    ours = {"kind": KIND, "schema": SCHEMA, "task": task, "options": dict(options)}
    _write_json(folder / OURS, {**ours, "versions": versions()})


class _Frames:
    """Writes the files of frames. A new file begins once the current file is full.

    Args:
        folder: Folder of the data set.

    Attributes:
        count: Number of frames so far.
    """

    def __init__(self, folder: Path) -> None:
        self._folder, self._file = folder, 0
        self._writer: Any = None
        self.count = 0

    def __enter__(self) -> _Frames:
        return self

    def __exit__(self, *error: object) -> None:
        self._close()

    def write(self, table: Any) -> int:
        """Writes the frames of an episode; returns the number of their file."""
        path = _path(self._folder, _DATA, self._file)
        if self._writer is not None and path.stat().st_size >= FILE_SIZE * 2**20:
            self._close()
            self._file += 1
            path = _path(self._folder, _DATA, self._file)
        if self._writer is None:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._writer = need_parquet().parquet.ParquetWriter(path, table.schema)
        self._writer.write_table(table)
        self.count += len(table)
        return self._file

    def _close(self) -> None:
        if self._writer is not None:
            self._writer.close()
            self._writer = None


def _known(episode: Demonstration) -> dict[str, Any]:
    """The columns of an episode that only Hand Sandbox has."""
    return {
        "seed": episode.seed,
        "success": episode.success,
        "terminated": episode.terminated,
        "simulated": bool(episode.about["simulated"]),
        "first_state_hash": episode.hashes[0],
        "about": json.dumps(episode.about),
    }


def _listed(own: Mapping[str, Statistics]) -> dict[str, Any]:
    """Statistics of an episode, as columns."""
    return {
        f"stats/{name}/{what}": value.tolist()
        for name, each in own.items()
        for what, value in each.items()
    }


def _info(
    features: Mapping[str, Feature], robot: str, episodes: int, frames: int
) -> dict[str, Any]:
    """Content of `meta/info.json`."""
    return {
        "codebase_version": VERSION,
        "robot_type": robot,
        "total_episodes": episodes,
        "total_frames": frames,
        "total_tasks": 1,
        "chunks_size": FILES,
        "data_files_size_in_mb": FILE_SIZE,
        "video_files_size_in_mb": 2 * FILE_SIZE,
        "fps": RATE,
        "splits": {"train": f"0:{episodes}"},
        "data_path": _DATA,
        "video_path": None,
        "features": {name: feature.as_json() for name, feature in features.items()},
    }


def _write_tasks(folder: Path, words: str) -> None:
    """Writes the table of tasks. LeRobot finds a task in the table by the description."""
    import pandas

    index = pandas.Index([words], dtype=object)
    pandas.DataFrame({"task_index": [0]}, index=index).to_parquet(folder / "meta/tasks.parquet")


def read_lerobot(folder: Path) -> DataSet:
    """Reads a data set that `write_lerobot` wrote, with all values that playing it back needs.

    Observations are those of LeRobot: `observation.state` and `observation.environment_state` in
    float32, without the last observation of an episode.

    Raises:
        InputError: The folder cannot be read, is incomplete, or is from another program or version.
    """
    arrow = need_parquet()
    try:
        ours = json.loads((folder / OURS).read_text(encoding="utf-8"))
        info = json.loads((folder / "meta/info.json").read_text(encoding="utf-8"))
        if (ours["kind"], info["codebase_version"]) != (KIND, VERSION):
            raise ValueError(f"{ours['kind']}, {info['codebase_version']}")
        check_schema(folder, ours["schema"], SCHEMA, "lerobot --name OWNER/NAME")
        rows = arrow.parquet.read_table(
            _path(folder, _EPISODES, 0),
            columns=["seed", "about", "terminated", "first_state_hash", "length"],
        ).to_pylist()
        files = sorted(folder.glob("data/*/*.parquet"))
        tables = [arrow.parquet.read_table(file) for file in files]
        frames = arrow.concat_tables(tables)
        lengths = [row["length"] for row in rows]
        if len(frames) != sum(lengths) or len(rows) != info["total_episodes"]:
            raise ValueError(f"{len(frames)} frames of {sum(lengths)}")
        starts = np.cumsum([0, *lengths])
        episodes = [
            Columns.read(frames.slice(start, row["length"]), row)
            for start, row in zip(starts, rows, strict=False)
        ]
        return DataSet(ours["task"], ours["options"], tuple(episodes))
    except OSError as error:
        raise InputError(
            "cannot be read as a data set of LeRobot", where=str(folder), got=str(error)
        ) from None
    except (ValueError, KeyError, TypeError) as error:
        raise InputError(
            "this is not a complete data set",
            where=str(folder),
            got=" ".join(str(error).split()),
            remedy="`sandbox export RECORDING --to lerobot --name OWNER/NAME` writes a data set",
        ) from None


def _path(folder: Path, pattern: str, file: int) -> Path:
    return folder / pattern.format(chunk_index=file // FILES, file_index=file % FILES)


def _write_json(path: Path, values: Mapping[str, Any]) -> None:
    path.write_text(json.dumps(values, indent=4, ensure_ascii=False), encoding="utf-8")
