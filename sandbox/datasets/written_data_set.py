"""Export of recordings as one data set."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from models.errors import InputError
from sandbox.datasets.data_set import LEROBOT, MINARI
from sandbox.datasets.npz_file import check_npz, write_npz
from sandbox.datasets.played_trial import (
    Demonstration,
    broken_off,
    changed_task,
    check_equal,
    demonstrate,
    environment_of,
    open_demonstration,
)
from tasks.registry import find_task


@dataclass
class Exported:
    """Summary of an export.

    Attributes:
        where: Name, size and place of the data set, for people.
        episodes, steps, successes, simulated: Numbers of episodes, steps, successful episodes and
            episodes of the simulated user.
        differing: Recordings whose recorded states differ from those of the environment.
        changed: Recordings whose external task has changed since, each with a remedy.
        broken_off: Number of a study's attempts that were ended early. They are left out.
    """

    where: str = ""
    episodes: int = 0
    steps: int = 0
    successes: int = 0
    simulated: int = 0
    differing: list[str] = field(default_factory=list)
    changed: list[str] = field(default_factory=list)
    broken_off: int = 0


def export_data_set(
    files: Sequence[Path],
    to: Path,
    name: str = "",
    successes_only: bool = False,
    observe: Sequence[str] = ("all",),
    done: Callable[[int], None] = lambda count: None,
) -> Exported:
    """Plays recordings through their environment and writes the observations as a data set.

    Args:
        files: The recordings.
        to: `minari`, `lerobot`, or a file `.npz`.
        name: Name of a data set of Minari or LeRobot.
        successes_only: True leaves out episodes without success.
        observe: Parts of observations.
        done: Called with the number of recordings played so far.

    Raises:
        InputError: A recording cannot be a demonstration, recordings have different environments,
            no episode is left, or the data set cannot be written.
    """
    import gymnasium

    from sandbox.gym import HandSandboxEnv, register_task

    if str(to) == MINARI:
        from sandbox.datasets.minari_file import check_name

        check_name(name)
    elif str(to) == LEROBOT:
        from sandbox.datasets.lerobot_folder import check_folder

        folder = check_folder(name)
    else:
        check_npz(to)
    exported = Exported()
    # Check all recordings before the first one is played.
    counted, environments = [], []
    for file in files:
        recording = open_demonstration(file)
        if broken_off(recording):
            exported.broken_off += 1
            continue
        counted.append(file)
        environments.append(environment_of(recording, observe))
    if not counted:
        raise InputError(
            "no demonstration is left",
            got=f"{len(files)} recordings, all of attempts that were ended early",
        )
    files = counted
    for file, other in zip(files, environments, strict=True):
        check_equal(environments[0], other, str(file))
    task, options = environments[0]
    env: Any = gymnasium.make(register_task(task), **options)

    def played() -> Iterator[Demonstration]:
        own = env.unwrapped
        assert isinstance(own, HandSandboxEnv)
        for number, file in enumerate(files, start=1):
            recording = open_demonstration(file)
            one = demonstrate(recording, own)
            done(number)
            if successes_only and not one.success:
                continue
            exported.episodes += 1
            exported.steps += len(one.rewards)
            exported.successes += one.success
            exported.simulated += bool(one.about["simulated"])
            if not one.about["same_states_as_recorded"]:
                exported.differing.append(str(file))
            changed = changed_task(recording)
            if changed:
                exported.changed.append(f"{file}: {changed}")
            yield one

    some = _not_empty(played(), files)
    if str(to) == MINARI:
        from sandbox.datasets.minari_file import write_minari

        spaces = (env.observation_space, env.action_space)
        *_, size, place = write_minari(name, env.spec, spaces, some)
        exported.where = f"{name}, {size:.1f} MB in {place}"
    elif str(to) == LEROBOT:
        from sandbox.datasets.lerobot_folder import write_lerobot

        kind = find_task(task)
        (words, *_) = (kind.__doc__ or kind.name).strip().splitlines()
        write_lerobot(folder, words, task, options, some)
        whole = sum(file.stat().st_size for file in folder.rglob("*") if file.is_file())
        exported.where = f"{name}, {whole / 1e6:.1f} MB in {folder}"
    else:
        write_npz(to, task, options, some)
        exported.where = f"{to}, {to.stat().st_size / 1e6:.1f} MB"
    env.close()
    return exported


def _not_empty(episodes: Iterator[Demonstration], files: Sequence[Path]) -> Iterator[Demonstration]:
    """The same episodes; raises an error if there is none."""
    any_left = False
    for episode in episodes:
        any_left = True
        yield episode
    if not any_left:
        raise InputError(
            "no demonstration is left", got=f"{len(files)} recordings, none with success"
        )
