"""Finds tasks by name: built-in ones, those of installed packages, and those in a file."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import Any

from models.errors import HandSandboxError, InputError
from models.outside import failure, package
from models.surface import Surface
from tasks.box_to_goal import BoxToGoal
from tasks.carry_together import CarryTogether
from tasks.checks import check_names, check_places, check_repeatable, check_values
from tasks.discovery import (
    check_member,
    is_place,
    load_offered,
    load_place,
    offered,
    place_file,
    place_member,
)
from tasks.stack import Stack, StackThree
from tasks.stack_vertical import StackVertical
from tasks.task import Task
from tasks.wrench_slide import WrenchSlide
from tasks.wrench_turn import WrenchTurn

IN_ROOMS = (
    ("tasks.clutter.slalom", "Slalom"),
    ("tasks.mechanisms.chords", "Chords"),
    ("tasks.mechanisms.dial", "Dial"),
    ("tasks.clutter.gather", "Gather"),
    ("tasks.clutter.books", "Books"),
    ("tasks.mechanisms.insert", "Insert"),
    ("tasks.mechanisms.close_case", "CloseCase"),
    ("tasks.mechanisms.single_keys", "SingleKeys"),
)
"""Module and class of built-in tasks in rooms of their own, which build upon this room."""

TASKS: dict[str, type[Task]] = {
    task.name: task
    for task in (
        BoxToGoal,
        WrenchTurn,
        WrenchSlide,
        Stack,
        StackThree,
        StackVertical,
        CarryTogether,
        *(getattr(import_module(module), member) for module, member in IN_ROOMS),
    )
}


def find_task(name: str) -> type[Task]:
    """Finds a built-in task or one of an installed package by name, or one at `FILE.py:Class`.

    Raises:
        InputError: No task has this name, or it cannot be used.
    """
    if name in TASKS:
        return TASKS[name]
    if not is_place(name):
        check_member(name)
        task = load_offered(name)
        if task is None:
            names = task_names()
            raise InputError(
                "no such task", got=name, expected=", ".join(names), remedy=_near(name, names)
            )
        return task
    task = load_place(name)
    if TASKS.get(task.name, task) is not task:
        raise InputError(
            "another task has this name",
            where=name,
            got=task.name,
            remedy="Give it a name of its own",
        )
    return task


def claim_name(claimed: dict[str, tuple[str, type[Task]]], place: str, kind: type[Task]) -> None:
    """Notes whose name a task's is, among tasks that are counted by their names.

    Args:
        claimed: Name -> place and task that has it; it is added to.
        place: Name or place under which the task was asked for.
        kind: The task.

    Raises:
        InputError: Another task has the name.
    """
    first, owner = claimed.setdefault(kind.name, (place, kind))
    if owner is not kind:
        raise InputError(
            "another of the tasks has the same name",
            where=place,
            got=kind.name,
            remedy=f"Give it a name of its own, or leave out {first}",
        )


def _near(name: str, names: tuple[str, ...]) -> str:
    """The next step for whoever asked for a task that there is not."""
    # Somebody's own file may be meant, whose name has underscores.
    near = get_close_matches(name.replace("_", "-"), names, 1)
    files = [path.name for path in Path().glob("*.py")]
    near += [file for file in get_close_matches(f"{name}.py", files, 1, 0.8) if not near]
    hint = f"Did you mean {near[0]}? " if near else ""
    return f"{hint}A task of your own is named by its file: FILE.py or FILE.py:CLASS"


def task_names() -> tuple[str, ...]:
    """Names of the built-in tasks and of those that installed packages offer, loaded or not."""
    return (*TASKS, *sorted(set(offered()) - set(TASKS)))


def unusable_tasks() -> dict[str, str]:
    """Names of tasks in installed packages that cannot be used, with the reason."""
    reasons = {}
    for name, entries in offered().items():
        if name in TASKS:
            others = ", ".join(package(e) for e in entries)
            reasons[name] = f"{others} offers a task of the same name as ours, which is left out"
            continue
        try:
            load_offered(name)
        except InputError as error:
            reasons[name] = str(error)
    return reasons


def hands_of(task: type[Task] | Task) -> int:
    """Number of hands that a task needs; 1 by default."""
    return task.hands


def draw_task(kind: type[Task], seed: int, surface: Surface) -> Task:
    """Draws the trial of a seed and checks it.

    A trial of a task from outside is drawn twice, and placed, before it is played.

    Raises:
        InputError: The task's own code fails, two draws of the seed differ, a goal names an unknown
            object, or objects overlap or are off the surface.
    """
    where = f"{kind.name}, seed {seed}"
    if seed < 0:
        raise InputError("the seed is out of range", where="seed", got=seed, expected="0 or more")
    with _guarded(where):
        task = kind.draw(seed, surface)
        if not is_built_in(kind):
            check_values(task, where)
        check_names(task, where)
        if not is_built_in(kind):
            check_repeatable(task, kind.draw(seed, surface), where)
            check_places(task, surface, where)
    return task


@contextmanager
def _guarded(where: str) -> Iterator[None]:
    """Converts any error of a task's own code to one of one line."""
    try:
        yield
    except HandSandboxError:
        raise
    except (Exception, SystemExit) as error:
        raise InputError("the task cannot be drawn", where=where, got=failure(error)) from error


def is_built_in(kind: type[Task]) -> bool:
    """True for a task of this package, False for one from a file or another package."""
    return kind.__module__.partition(".")[0] == __name__.partition(".")[0]


def origin(name: str) -> dict[str, Any]:
    """Origin of an external task, needed to run it again; empty for built-in tasks.

    Returns:
        `entry_point` as `module:Class`, with `package` and `version` where one is installed; or
        `file`, absolute, and `member`. Either way with the task's version as `task_version`.
    """
    kind = find_task(name)
    if is_built_in(kind):
        return {}
    file = place_file(name)
    if file is not None:
        return {"file": str(file), "member": place_member(name), "task_version": kind.version}
    source = {
        "entry_point": f"{kind.__module__}:{kind.__qualname__}",
        "task_version": kind.version,
    }
    dist = next((e.dist for e in offered().get(name, []) if e.dist), None)
    return {**source, "package": dist.name, "version": dist.version} if dist else source
