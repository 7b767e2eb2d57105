"""Data sets of Minari. They need the extra `datasets`."""

from __future__ import annotations

import os
import re
import shutil
import warnings
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from models.errors import InputError
from sandbox.datasets.played_trial import Demonstration
from sandbox.recording.versions import versions

_NAME = re.compile(r"(?![\w-]/[^/]*$)([\w-]+/)*[\w-]+-v\d+")


def need_minari() -> Any:
    """The module `minari`.

    Raises:
        InputError: Minari or h5py is not installed.
    """
    try:
        import h5py  # noqa: F401
        import minari
    except ImportError:
        raise InputError(
            "Minari is not installed",
            where="--to minari",
            remedy="pip install 'hand-sandbox[datasets]'",
        ) from None
    return minari


def check_name(name: str) -> None:
    """Checks the name of a new data set.

    Raises:
        InputError: The name does not have Minari's form, or the data set or its folder exists.
    """
    if not _NAME.fullmatch(name):
        raise InputError(
            "not a name of a data set of Minari",
            where="--name",
            got=name or "nothing",
            expected="such as hand_sandbox/box-to-goal/mine-v0",
        )
    minari = need_minari()
    folder = dataset_folder(name)
    try:
        there = name in minari.list_local_datasets()
        other = not there and folder.exists()
    except OSError as error:
        raise InputError(
            "the data set cannot be written", where=str(folder), got=error.strerror
        ) from None
    if there:
        raise InputError(
            "there is a data set of this name",
            where="--name",
            got=name,
            remedy=f"Choose another name, or `minari delete {name}`",
        )
    if other:
        raise InputError(
            "another folder is in the place of this data set",
            where="--name",
            got=f"{name}, in {folder}",
            remedy="Choose another name, or delete the folder",
        )


def dataset_folder(name: str) -> Path:
    """The folder in which Minari stores a local data set."""
    root = os.environ.get("MINARI_DATASETS_PATH")
    return (Path("~/.minari/datasets").expanduser() if root is None else Path(root)) / name


def write_minari(
    name: str, spec: Any, spaces: tuple[Any, Any], episodes: Iterable[Demonstration]
) -> tuple[int, int, float, str]:
    """Writes a data set into Minari's folder, one episode after another.

    If an error occurs, the incomplete data set is removed. Every step's `infos` have `state_hash`
    and `seed`. Further values are in the metadata of each episode.

    Args:
        name: Name of the data set.
        spec: Gymnasium's specification of the environment.
        spaces: Spaces of observations and actions.
        episodes: The demonstrations; at least one.

    Returns:
        Number of episodes and steps, size in MB, and the folder.

    Raises:
        InputError: The data set cannot be written.
    """
    check_name(name)
    folder = dataset_folder(name)
    try:
        return _write(name, spec, spaces, episodes)
    except OSError as error:
        shutil.rmtree(folder, ignore_errors=True)
        got = error.strerror or str(error)
        raise InputError("the data set cannot be written", where=str(folder), got=got) from None
    except BaseException:
        # Nothing that looks like a data set must remain, even if the program is stopped.
        shutil.rmtree(folder, ignore_errors=True)
        raise


def _write(
    name: str, spec: Any, spaces: tuple[Any, Any], episodes: Iterable[Demonstration]
) -> tuple[int, int, float, str]:
    minari = need_minari()
    from minari.data_collector import EpisodeBuffer

    about: list[dict[str, Any]] = []
    data: Any = None
    for episode in episodes:
        count = len(episode.rewards)
        last = np.arange(count) == count - 1
        buffer = EpisodeBuffer(
            seed=episode.seed,
            observations=dict(episode.observations),
            actions=episode.actions,
            rewards=episode.rewards.tolist(),
            terminations=(last & episode.terminated).tolist(),
            truncations=(last & episode.truncated).tolist(),
            infos={
                "state_hash": list(episode.hashes),
                "seed": np.full(count + 1, episode.seed),
            },
        )
        about.append(_attributes(episode.about))
        if data is None:
            with warnings.catch_warnings():
                # Minari warns about missing authors and a missing address. The person who publishes
                # the data set adds them.
                warnings.simplefilter("ignore")
                data = minari.create_dataset_from_buffers(
                    name,
                    [buffer],
                    env=spec,
                    observation_space=spaces[0],
                    action_space=spaces[1],
                    description="Demonstrations of touches, by Hand Sandbox.",
                    requirements=_requirements(),
                )
        else:
            data.storage.update_episodes([buffer])
    data.storage.update_episode_metadata(about)
    simulated = int(sum(each["simulated"] for each in about))
    data.storage.update_metadata(
        {
            "algorithm_name": _who(simulated, len(about)),
            "simulated_episodes": simulated,
            "hand_sandbox_versions": versions(),
        }
    )
    storage = data.storage
    return len(about), storage.total_steps, float(storage.get_size()), str(storage.data_path)


def _who(simulated: int, episodes: int) -> str:
    """Text about who made the demonstrations: people, the simulated user, or both."""
    if 0 < simulated < episodes:
        return "people and a simulated user"
    return "simulated user" if simulated else "people"


def _attributes(about: Mapping[str, Any]) -> dict[str, Any]:
    """Values about an episode as HDF5 attributes: texts, numbers and booleans."""
    import json

    return {
        key: value if isinstance(value, bool | int | float | str) else json.dumps(value)
        for key, value in about.items()
    }


def _requirements() -> list[str]:
    here = versions()
    return [f"hand-sandbox=={here['hand-sandbox']}", f"mujoco=={here['mujoco']}"]
