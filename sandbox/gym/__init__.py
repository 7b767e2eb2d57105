"""Every task as an environment of Gymnasium, the extra `gym`.

    import gymnasium

    env = gymnasium.make("sandbox.gym:hand_sandbox/BoxToGoal-v1")

Importing this module registers two ids for every task, ours and those of installed packages:
`hand_sandbox/BoxToGoal-v1`, whose actions are touches, and `hand_sandbox/BoxToGoalPose-v1`, whose
actions are poses of the hand. The version is the task's. One agent moves all hands of a task.
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

__all__ = ["NAMESPACE", "HandSandboxEnv", "register_task"]

NAMESPACE = "hand_sandbox"


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
    name = "".join(word.capitalize() for word in kind.name.split("-"))
    ids = []
    for suffix, action in (("", "touch"), ("Pose", "pose")):
        ids.append(f"{NAMESPACE}/{name}{suffix}-v{kind.version}")
        if ids[-1] not in gymnasium.registry:
            gymnasium.register(
                ids[-1],
                "sandbox.gym.environment:HandSandboxEnv",
                kwargs={"task": task, "action": action},
            )
    return ids[0], ids[1]


for _name in task_names():
    try:
        register_task(_name)
    except InputError as _error:
        # Only this task is missing; gymnasium.make then reports an unknown id.
        warnings.warn(str(_error), stacklevel=1)
