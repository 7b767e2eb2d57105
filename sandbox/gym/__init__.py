"""Gymnasium environments of all tasks. They need the extra `gym`.

    import gymnasium

    env = gymnasium.make("sandbox.gym:hand_sandbox/BoxToGoal-v1")

Importing this module registers an id for every built-in task and for every task of an installed
package. The number after `-v` is the task's version. Options of `gymnasium.make` choose actions,
observations and rewards (`HandSandboxEnv`). One agent moves all hands of a task.
"""

from __future__ import annotations

import warnings

from models.errors import InputError

try:
    import gymnasium
except ImportError:
    raise InputError(
        "Gymnasium is not installed",
        where="sandbox.gym",
        remedy="pip install 'hand-sandbox[gym]'",
    ) from None

from gymnasium.envs.registration import EnvSpec

from models.plugins import place_file
from sandbox.gym.environment import HandSandboxEnv
from tasks.registry import TASK_PLUGINS, find_task, task_names

__all__ = ["NAMESPACE", "HandSandboxEnv", "register_task"]

NAMESPACE = "hand_sandbox"

_ENTRY = "sandbox.gym.environment:HandSandboxEnv"


def register_task(task: str) -> str:
    """Registers a task of your own. Built-in and installed tasks are registered on import.

    Args:
        task: Name of the task, or its place such as `FILE.py:Class`.

    Returns:
        The id of the task's environment.

    Raises:
        InputError: The task is unknown or cannot be used, or another task has the same id.
    """
    kind = find_task(task)
    name = "".join(word.capitalize() for word in kind.name.split("-"))
    id = f"{NAMESPACE}/{name}-v{kind.version}"
    if id in gymnasium.registry:
        _check_own(gymnasium.registry[id], task)
    else:
        gymnasium.register(id, _ENTRY, kwargs={"task": task})
    return id


def _check_own(spec: EnvSpec, task: str) -> None:
    """Checks that an id is registered for this task.

    Args:
        spec: Specification that is registered under the id.
        task: Name of the task, or its place (`FILE.py`, `FILE.py:CLASS` or `MODULE:CLASS`).

    Raises:
        InputError: The id is registered for another task or another environment.
    """
    other = str(spec.kwargs.get("task", ""))
    if spec.entry_point != _ENTRY or not _same_task(other, task):
        raise InputError(
            f"the id {spec.id} belongs to another task",
            where=task,
            got=other or str(spec.entry_point),
            remedy="Give the task a name of its own",
        )


def _same_task(one: str, other: str) -> bool:
    """True if two names or places are those of one task; its file may have changed in between."""
    if one == other:
        return True
    try:
        files = place_file(one), place_file(other)
        if None in files:
            return find_task(one) is find_task(other)
        members = TASK_PLUGINS.member_at(one), TASK_PLUGINS.member_at(other)
        return files[0] == files[1] and members[0] == members[1]
    except InputError:
        # The task that was registered first does not exist any more.
        return False


for _name in task_names():
    try:
        register_task(_name)
    except InputError as _error:
        # Only this task is unavailable. `gymnasium.make` then reports an unknown id.
        warnings.warn(str(_error), stacklevel=1)
