"""Tasks by name."""

from __future__ import annotations

from models.errors import InputError
from tasks.box_to_goal import BoxToGoal
from tasks.task import Task
from tasks.wrench_slide import WrenchSlide

TASKS: dict[str, type[Task]] = {task.name: task for task in (BoxToGoal, WrenchSlide)}


def find_task(name: str) -> type[Task]:
    """The task of a name.

    Raises:
        InputError: There is none.
    """
    if name not in TASKS:
        raise InputError("there is no such task", got=name, expected=", ".join(TASKS))
    return TASKS[name]
