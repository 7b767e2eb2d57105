"""Tasks: a scene with a goal, a test of success, its score, and simulated users who play it.

The names in `__all__` are the public API; `docs/write-a-task.md` and `docs/from-python.md` explain
them. Every other module may change without notice.
"""

from typing import TYPE_CHECKING

from models import lazy_names  # before NumPy: `models` pins the BLAS kernel

if TYPE_CHECKING:
    from models.scene import PaintedRing
    from tasks.custom_task import CustomTask, judge, two_places
    from tasks.guarded import draw_task
    from tasks.registry import find_task, task_names
    from tasks.score import Score, Status
    from tasks.sensing import Sensing
    from tasks.task import Goal, Measure, Task
    from tasks.task_checks import check_task
    from tasks.user import Sight, User, UserConfiguration
else:
    __getattr__ = lazy_names(
        __name__,
        {
            "Goal": "tasks.task",
            "Measure": "tasks.task",
            "CustomTask": "tasks.custom_task",
            "PaintedRing": "models.scene",
            "Score": "tasks.score",
            "Sensing": "tasks.sensing",
            "Sight": "tasks.user",
            "Status": "tasks.score",
            "Task": "tasks.task",
            "User": "tasks.user",
            "UserConfiguration": "tasks.user",
            "check_task": "tasks.task_checks",
            "draw_task": "tasks.guarded",
            "find_task": "tasks.registry",
            "judge": "tasks.custom_task",
            "task_names": "tasks.registry",
            "two_places": "tasks.custom_task",
        },
    )

__all__ = [
    "CustomTask",
    "Goal",
    "Measure",
    "PaintedRing",
    "Score",
    "Sensing",
    "Sight",
    "Status",
    "Task",
    "User",
    "UserConfiguration",
    "check_task",
    "draw_task",
    "find_task",
    "judge",
    "task_names",
    "two_places",
]
