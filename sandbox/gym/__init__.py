"""Every task as an environment of Gymnasium, the extra `gym`.

    import gymnasium

    env = gymnasium.make("sandbox.gym:hand_sandbox/BoxToGoal-v1")

Importing this module registers two ids for every task, ours and those of installed packages:
`hand_sandbox/BoxToGoal-v1`, whose actions are touches, and `hand_sandbox/BoxToGoalPose-v1`, whose
actions are poses of the hand. The version is the task's. One agent moves all hands of a task.

Two more ids of every task are for learning: `hand_sandbox/BoxToGoalLearn-v1`, with a slot for every
finger and observations that can be chosen, and `hand_sandbox/BoxToGoalHindsight-v1`, with goal
dictionaries.
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

from sandbox.gym.environment import HandSandboxEnv
from tasks.discovery import place_file, place_member
from tasks.registry import find_task, task_names
from tasks.task import Task

__all__ = ["NAMESPACE", "HandSandboxEnv", "learning_id", "register_task"]

NAMESPACE = "hand_sandbox"

_PLAIN = "sandbox.gym.environment:HandSandboxEnv"
_FOR_LEARNING = {"Learn": "environment:LearningEnv", "Hindsight": "hindsight:make"}
"""What follows a task's name in an id -> where its environment is made."""


def register_task(task: str) -> tuple[str, str]:
    """Registers a task of your own; built-in and installed ones are registered on import.

    Args:
        task: Name of the task, or its place such as `FILE.py:Class`.

    Returns:
        The two ids, with touches and with poses as actions.

    Raises:
        InputError: The task is unknown or cannot be used, or an id is another task's.
    """
    kind = find_task(task)
    made: dict[str, tuple[str, dict[str, str]]] = {
        "": (_PLAIN, {"action": "touch"}),
        "Pose": (_PLAIN, {"action": "pose"}),
        **{s: (f"sandbox.gym.learning.{place}", {}) for s, place in _FOR_LEARNING.items()},
    }
    new = {}
    for suffix, (entry, more) in made.items():
        id = _id(kind, suffix)
        if id in gymnasium.registry:
            _check_own(gymnasium.registry[id], entry, task, more)
        else:
            new[id] = (entry, {"task": task, **more})
    for id, (entry, kwargs) in new.items():
        gymnasium.register(id, entry, kwargs=kwargs)
    return _id(kind, ""), _id(kind, "Pose")


def learning_id(task: str) -> str:
    """The id of a task's environment for learning, which is registered if it was not.

    Raises:
        InputError: The task is unknown, or cannot be used.
    """
    register_task(task)
    return _id(find_task(task), "Learn")


def _check_own(spec: EnvSpec, entry: str, task: str, more: dict[str, str]) -> None:
    """Refuses the id of another task.

    Raises:
        InputError: What is registered under it is not this environment of this task.
    """
    there = dict(spec.kwargs)
    other = str(there.pop("task", ""))
    if spec.entry_point != entry or there != more or not _same_task(other, task):
        raise InputError(
            f"the id {spec.id} is another task's",
            where=task,
            got=other or str(spec.entry_point),
            remedy="Give the task a name of its own",
        )


def _same_task(one: str, other: str) -> bool:
    """True if two names or places are those of one task, whose file may have changed since."""
    if one == other:
        return True
    try:
        files = place_file(one), place_file(other)
        if None in files:
            return find_task(one) is find_task(other)
        return files[0] == files[1] and place_member(one) == place_member(other)
    except InputError:
        # The first one is not there any more.
        return False


def _id(kind: type[Task], suffix: str) -> str:
    name = "".join(word.capitalize() for word in kind.name.split("-"))
    return f"{NAMESPACE}/{name}{suffix}-v{kind.version}"


for _name in task_names():
    try:
        register_task(_name)
    except InputError as _error:
        # Only this task is missing; gymnasium.make then reports an unknown id.
        warnings.warn(str(_error), stacklevel=1)
