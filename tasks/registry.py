"""Finds tasks by name: built-in tasks, tasks of installed packages, and tasks in a file.

A package offers a task under the task's name:

    [project.entry-points."hand_sandbox.tasks"]
    my-lab-push = "my_lab.tasks:Push"

A task is imported when its name is used. Errors in its code are reported then, and do not affect
other tasks.
"""

from __future__ import annotations

import re
from difflib import get_close_matches
from math import inf, isfinite
from pathlib import Path
from typing import Any

from models.errors import InputError
from models.plugins import PluginKind, Registry, package, place_file
from tasks.task import Task, TaskDefaults

TASKS: Registry[type[Task]] = Registry(
    {
        "box-to-goal": "tasks.box_to_goal:BoxToGoal",
        "wrench-turn": "tasks.wrench:WrenchTurn",
        "wrench-slide": "tasks.wrench:WrenchSlide",
        "stack": "tasks.stack:Stack",
        "stack-three": "tasks.stack:StackThree",
        "stack-vertical": "tasks.stack:StackVertical",
        "carry-together": "tasks.carry_together:CarryTogether",
        "slalom": "tasks.slalom:Slalom",
        "chords": "tasks.chords:Chords",
        "dial": "tasks.dial:Dial",
        "gather": "tasks.gather:Gather",
        "books": "tasks.books:Books",
        "insert": "tasks.insert:Insert",
        "close-case": "tasks.close_case:CloseCase",
        "single-keys": "tasks.single_keys:SingleKeys",
    }
)
"""Built-in tasks. To add one, write its module and add a line here."""

_NAME = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
_NUMBERS = ("version", "time_limit", "hold_time", "table_friction", "touch_height", "lift_range")
_OPTIONAL = (
    "hands",
    "fewest_fingers",
    "user",
    "painted",
    "pressed",
    "own_friction",
    "with_room",
    "shifted",
)


def is_task(value: Any) -> bool:
    """True for a class with the two methods of a task."""
    return isinstance(value, type) and all(
        callable(getattr(value, part, None)) for part in ("draw", "measure")
    )


TASK_PLUGINS: PluginKind[type[Task]] = PluginKind(
    "task", "hand_sandbox.tasks", InputError, TASKS, is_task
)


def find_task(name: str) -> type[Task]:
    """Finds a built-in task or one of an installed package by name, or one at `FILE.py:Class`.

    Raises:
        InputError: No task has this name, or it cannot be used.
    """
    if name in TASKS:
        return TASKS[name]
    in_place = TASK_PLUGINS.place_in(name) is not None
    if not in_place:
        _check_member(name)
    plugin = TASK_PLUGINS.find(name)
    if plugin is None:
        names = task_names()
        raise InputError(
            "no such task", got=name, expected=", ".join(names), remedy=_near(name, names)
        )
    task = completed(plugin.value, plugin.where)
    if not in_place and task.name != name:
        raise InputError(
            "the entry point and its task have different names",
            where=plugin.where,
            got=task.name,
            expected=name,
            remedy="Give the entry point the task's name",
        )
    if task.name in TASKS and TASKS[task.name] is not task:
        raise InputError(
            "another task has this name",
            where=name,
            got=task.name,
            remedy="Give it a different name",
        )
    return task


def task_names() -> tuple[str, ...]:
    """Names of the built-in tasks and of those that installed packages offer, loaded or not."""
    return TASK_PLUGINS.names()


def unusable_tasks() -> dict[str, str]:
    """Names of tasks in installed packages that cannot be used, with the reason."""
    reasons = {}
    for name, entries in TASK_PLUGINS.offered().items():
        if name in TASKS:
            others = ", ".join(package(e) for e in entries)
            reasons[name] = (
                f"the task from {others} is left out, because a built-in task has the same name"
            )
            continue
        try:
            find_task(name)
        except InputError as error:
            reasons[name] = str(error)
    return reasons


def claim_name(claimed: dict[str, tuple[str, type[Task]]], place: str, kind: type[Task]) -> None:
    """Reserves a task's name, so that no two of the requested tasks have the same name.

    Args:
        claimed: Name -> place of the task and the task. The new task is added.
        place: Name or place with which the task was requested.
        kind: The task.

    Raises:
        InputError: Another task has this name.
    """
    first, owner = claimed.setdefault(kind.name, (place, kind))
    if owner is not kind:
        raise InputError(
            "another of the tasks has the same name",
            where=place,
            got=kind.name,
            remedy=f"Give it a different name, or leave out {first}",
        )


def hands_of(task: type[Task] | Task) -> int:
    """Number of hands that a task needs; 1 by default."""
    return task.hands


def is_built_in(kind: type[Task]) -> bool:
    """True for a task of this package, False for one from a file or another package."""
    return kind.__module__.partition(".")[0] == __name__.partition(".")[0]


def origin(name: str) -> dict[str, Any]:
    """Origin of an external task, needed to run it again; empty for built-in tasks.

    Returns:
        For a task of a module: `entry_point` (`module:Class`), and `package` and `version` if an
        installed package offers the task. For a task in a file: `file` (absolute path) and
        `member`. In both cases also `task_version`, the version of the task.
    """
    kind = find_task(name)
    if is_built_in(kind):
        return {}
    file = place_file(name)
    if file is not None:
        member = TASK_PLUGINS.member_at(name)
        return {"file": str(file), "member": member, "task_version": kind.version}
    return {**TASK_PLUGINS.package_of(kind, name), "task_version": kind.version}


def completed(value: Any, where: str) -> type[Task]:
    """Returns a loaded task, after adding the default members that it leaves out.

    Args:
        value: The loaded object.
        where: Place from which it was loaded, for error messages.

    Raises:
        InputError: The object is not a task, or a required member is missing or invalid.
    """
    if not is_task(value):
        raise InputError(
            "not a task",
            where=where,
            got=repr(value)[:80],
            expected="a class with the methods draw and measure",
            remedy="Add the methods, or name another class",
        )
    _check_members(value, where)
    for member in _OPTIONAL:
        if not hasattr(value, member):
            setattr(value, member, getattr(TaskDefaults, member))
    task: type[Task] = value
    return task


def _check_members(task: type[Any], where: str) -> None:
    """Checks the members of a task.

    Raises:
        InputError: A member is missing or invalid; the error names it.
    """
    name = getattr(task, "name", None)
    if not (isinstance(name, str) and _NAME.fullmatch(name)):
        raise InputError(
            "a task's name is missing or invalid",
            where=where,
            got=name,
            expected="small letters, digits and hyphens: my-lab-push",
        )
    if getattr(task, "plane", None) not in ("table", "front"):
        raise InputError(
            "a task's plane is missing or invalid",
            where=where,
            got=getattr(task, "plane", None),
            expected="table or front",
        )
    _check_numbers(task, where)
    user = getattr(task, "user", None)
    if user is not None and not callable(user):
        raise InputError(
            "`user`, the simulated user of a task, cannot be called",
            where=where,
            got=repr(user)[:80],
            expected="a class whose arguments are (configuration, surface, seed), or None",
        )
    missing: frozenset[str] = getattr(task, "__abstractmethods__", frozenset())
    if missing:
        raise InputError(
            "this task has abstract members",
            where=where,
            got=", ".join(sorted(missing)),
            remedy="Define them in the task's class",
        )


def _check_numbers(task: type[Any], where: str) -> None:
    """Checks the numbers of a task.

    Raises:
        InputError: A number is missing or out of range; the error names it.
    """
    for number in _NUMBERS:
        value = getattr(task, number, None)
        # Before an upright surface, fingertips may also be behind the object that they grip.
        least = -inf if number == "touch_height" and task.plane == "front" else 0.0
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or not (isfinite(value) and value >= least)
        ):
            raise InputError(
                f"a task's {number} is missing or invalid",
                where=where,
                got=value,
                expected="a number" if least else "a number that is not negative",
            )
    if not task.time_limit > 0:
        raise InputError("a task's time_limit must be above 0", where=where, got=task.time_limit)
    if task.hold_time > task.time_limit:
        raise InputError(
            "a task's hold_time must be at most its time_limit",
            where=where,
            got=f"{task.hold_time:g} s, and {task.time_limit:g} s",
        )
    hands = getattr(task, "hands", 1)
    if isinstance(hands, bool) or not isinstance(hands, int) or hands not in (1, 2):
        raise InputError("a task's hands are wrong", where=where, got=hands, expected="1 or 2")


def _check_member(name: str) -> None:
    """Checks that the class at a place is at the top level of its file or module.

    Raises:
        InputError: The class is inside another class or a function.
    """
    source, _, member = name.partition(":")
    parts = member.replace(".<locals>", "").split(".")
    if len(parts) > 1 and all(part.isidentifier() for part in parts):
        raise InputError(
            "a task inside a class or a function cannot be loaded",
            where=source,
            got=member,
            expected="a class at the top of its file or module",
            remedy=f"Name it there: {parts[-1]} = {'.'.join(parts)}"
            if "<locals>" not in member
            else "Move it there, or give it a name there",
        )


def _near(name: str, names: tuple[str, ...]) -> str:
    """The next step, for the error message about a task that does not exist."""
    # The user may mean their own file, whose name has underscores.
    near = get_close_matches(name.replace("_", "-"), names, 1)
    files = [path.name for path in Path().glob("*.py")]
    near += [file for file in get_close_matches(f"{name}.py", files, 1, 0.8) if not near]
    hint = f"Did you mean {near[0]}? " if near else ""
    return f"{hint}A task of your own is named by its file: FILE.py or FILE.py:CLASS"
