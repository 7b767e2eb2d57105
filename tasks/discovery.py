"""Loads external tasks: from installed packages by entry point, from a file or a module.

A package offers its tasks under the name of the task:

    [project.entry-points."hand_sandbox.tasks"]
    my-lab-push = "my_lab.tasks:Push"

Errors in a task are reported when it is loaded; they do not affect other tasks.
"""

from __future__ import annotations

import importlib
import re
from importlib.metadata import EntryPoint
from pathlib import Path
from types import ModuleType
from typing import Any

from models import outside
from models.errors import HandSandboxError, InputError
from models.outside import failure, load_file, package
from tasks.task import Task, TaskDefaults

GROUP = "hand_sandbox.tasks"
"""Group of the entry points; each has the name of its task."""

_NAME = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
_FILE = re.compile(r"(?P<file>.+\.py)(:(?P<member>[A-Za-z_]\w*))?")
_MODULE = re.compile(r"(?P<module>[A-Za-z_][\w.]*):(?P<member>[A-Za-z_]\w*)")
_NUMBERS = ("version", "time_limit", "hold_time", "table_friction", "touch_height", "lift_range")


def offered() -> dict[str, list[EntryPoint]]:
    """Entry points of installed packages by name; loads none of them."""
    return outside.offered(GROUP)


def load_offered(name: str) -> type[Task] | None:
    """Loads a task that a package offers; returns None if no package offers it.

    Raises:
        InputError: Two packages offer it, or the offered object is not a task.
    """
    entries = offered().get(name, [])
    if not entries:
        return None
    if len(entries) > 1:
        raise InputError(
            "several packages offer a task of this name",
            where=name,
            got="; ".join(f"{e.value} of {package(e)}" for e in entries),
            remedy=f"Uninstall all but one, or name it by its place, such as {entries[0].value}",
        )
    entry = entries[0]
    where = f"entry point {name} = {entry.value} of {package(entry)}"
    task = adapted(_guarded(entry.load, where), where)
    if task.name != name:
        raise InputError(
            "the entry point and its task have different names",
            where=where,
            got=task.name,
            expected=name,
        )
    return task


def is_place(text: str) -> bool:
    """True for a text of the form `FILE.py`, `FILE.py:Class` or `module:Class`."""
    return bool(_FILE.fullmatch(text) or _MODULE.fullmatch(text))


def load_place(text: str) -> type[Task]:
    """Loads the task at a place; see `is_place`.

    Raises:
        InputError: The file or module does not exist, or contains no task.
    """
    in_file = _FILE.fullmatch(text)
    if in_file:
        module = _module_of(Path(in_file["file"]))
        member = in_file["member"] or _only_task(module, in_file["file"])
    else:
        match = _MODULE.fullmatch(text)
        assert match is not None
        module_name, member = match["module"], match["member"]
        module = _guarded(lambda: importlib.import_module(module_name), text)
    task = getattr(module, member, None)
    if task is None:
        raise InputError(
            "the module has nothing of this name",
            where=text,
            got=member,
            expected=_names(_tasks_in(module)),
        )
    return adapted(task, text)


def place_file(text: str) -> Path | None:
    """Absolute path of the file of a place; None for a module."""
    in_file = _FILE.fullmatch(text)
    return Path(in_file["file"]).resolve() if in_file else None


def adapted(kind: Any, where: str) -> type[Task]:
    """Checks a task, and adds missing members of the contract with their defaults.

    Raises:
        InputError: A required member is missing.
    """
    check_task(kind, where)
    for member in ("hands", "user"):
        if not hasattr(kind, member):
            setattr(kind, member, getattr(TaskDefaults, member))
    task: type[Task] = kind
    return task


def check_task(kind: Any, where: str) -> None:
    """Raises an error for an object that lacks a part of a task.

    Raises:
        InputError: A part is missing or invalid; the error names it.
    """
    if not _looks_like_task(kind):
        raise InputError(
            "not a task", where=where, got=repr(kind)[:80], expected="a class with draw and measure"
        )
    name = getattr(kind, "name", None)
    if not (isinstance(name, str) and _NAME.fullmatch(name)):
        raise InputError(
            "a task's name is missing or invalid",
            where=where,
            got=name,
            expected="small letters, digits and hyphens: my-lab-push",
        )
    for number in _NUMBERS:
        value = getattr(kind, number, None)
        if isinstance(value, bool) or not isinstance(value, int | float) or not value >= 0:
            raise InputError(
                f"a task's {number} is missing or invalid",
                where=where,
                got=value,
                expected="a number that is not negative",
            )
    if getattr(kind, "plane", None) not in ("table", "front"):
        raise InputError(
            "a task's plane is missing or invalid",
            where=where,
            got=getattr(kind, "plane", None),
            expected="table or front",
        )
    missing: frozenset[str] = getattr(kind, "__abstractmethods__", frozenset())
    if missing:
        raise InputError("this task lacks members", where=where, got=", ".join(sorted(missing)))


def _guarded(load: Any, where: str) -> Any:
    try:
        return load()
    except HandSandboxError:
        raise
    except Exception as error:
        raise InputError("this task cannot be loaded", where=where, got=failure(error)) from error


def _module_of(path: Path) -> ModuleType:
    if not path.is_file():
        raise InputError("no such file", where="the task's file", got=str(path))
    module: ModuleType = _guarded(lambda: load_file(path.resolve()), str(path))
    return module


def _looks_like_task(kind: Any) -> bool:
    return isinstance(kind, type) and all(
        callable(getattr(kind, part, None)) for part in ("draw", "measure")
    )


def _tasks_in(module: ModuleType) -> list[str]:
    """Names of the task classes that a module defines itself."""
    return [
        name
        for name, kind in vars(module).items()
        if _looks_like_task(kind) and kind.__module__ == module.__name__
    ]


def _only_task(module: ModuleType, path: str) -> str:
    tasks = _tasks_in(module)
    if len(tasks) != 1:
        raise InputError(
            "unclear which task of the file is meant",
            where=path,
            got=_names(tasks),
            expected=f"one task, or {Path(path).name}:CLASS",
        )
    return tasks[0]


def _names(tasks: list[str]) -> str:
    return ", ".join(tasks) or "no task"
