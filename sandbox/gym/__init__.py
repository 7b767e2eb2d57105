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

from sandbox.gym.environment import HandSandboxEnv
from tasks.registry import find_task, task_names
from tasks.task import Task

__all__ = ["NAMESPACE", "HandSandboxEnv", "learning_id", "register_task"]

NAMESPACE = "hand_sandbox"

_FOR_LEARNING = {"Learn": "environment:LearningEnv", "Hindsight": "hindsight:make"}
"""What follows a task's name in an id -> where its environment is made."""


def register_task(task: str) -> tuple[str, str]:
    """Registers a task of your own; built-in and installed ones are registered on import.

    Args:
        task: Name of the task, or its place such as `FILE.py:Class`.

    Returns:
        The two ids, with touches and with poses as actions.

    Raises:
        InputError: The task is unknown, or cannot be used.
    """
    kind = find_task(task)
    for suffix, place in _FOR_LEARNING.items():
        id = _id(kind, suffix)
        if id not in gymnasium.registry:
            gymnasium.register(id, f"sandbox.gym.learning.{place}", kwargs={"task": task})
    ids = []
    for suffix, action in (("", "touch"), ("Pose", "pose")):
        ids.append(_id(kind, suffix))
        if ids[-1] not in gymnasium.registry:
            gymnasium.register(
                ids[-1],
                "sandbox.gym.environment:HandSandboxEnv",
                kwargs={"task": task, "action": action},
            )
    return ids[0], ids[1]


def learning_id(task: str) -> str:
    """The id of a task's environment for learning, which is registered if it was not.

    Raises:
        InputError: The task is unknown, or cannot be used.
    """
    register_task(task)
    return _id(find_task(task), "Learn")


def _id(kind: type[Task], suffix: str) -> str:
    name = "".join(word.capitalize() for word in kind.name.split("-"))
    return f"{NAMESPACE}/{name}{suffix}-v{kind.version}"


for _name in task_names():
    try:
        register_task(_name)
    except InputError as _error:
        # Only this task is missing; gymnasium.make then reports an unknown id.
        warnings.warn(str(_error), stacklevel=1)
