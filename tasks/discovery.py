"""Loads external tasks: from installed packages by entry point, from a file or a module.

A package offers its tasks under the name of the task:

    [project.entry-points."hand_sandbox.tasks"]
    my-lab-push = "my_lab.tasks:Push"

Errors in a task are reported when it is loaded; they do not affect other tasks.
"""

from __future__ import annotations

import re
from importlib.metadata import EntryPoint
from math import inf, isfinite
from pathlib import Path
from types import ModuleType
from typing import Any

from models.errors import InputError
from models.outside import OutsideKind, Place, load_file, place_in
from tasks.task import Task, TaskDefaults

OUTSIDE = OutsideKind("task", "hand_sandbox.tasks", InputError)

_NAME = re.compile(r"[a-z0-9]+(-[a-z0-9]+)*")
_NUMBERS = ("version", "time_limit", "hold_time", "table_friction", "touch_height", "lift_range")


def offered() -> dict[str, list[EntryPoint]]:
    """Entry points of installed packages by name; loads none of them."""
    return OUTSIDE.offered()


def load_offered(name: str) -> type[Task] | None:
    """Loads a task that a package offers; returns None if no package offers it.

    Raises:
        InputError: Two packages offer it, or the offered object is not a task.
    """
    loaded = OUTSIDE.load_offered(name)
    if loaded is None:
        return None
    task = adapted(loaded.thing, loaded.where)
    if task.name != name:
        raise InputError(
            "the entry point and its task have different names",
            where=loaded.where,
            got=task.name,
            expected=name,
        )
    return task


def is_place(text: str) -> bool:
    """True for a text of the form `FILE.py`, `FILE.py:Class` or `module:Class`."""
    return _place(text) is not None


def check_member(text: str) -> None:
    """Raises an error for a place whose class is not at the top of its file or module.

    Raises:
        InputError: It is inside another class or a function.
    """
    source, _, member = text.partition(":")
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


def load_place(text: str) -> type[Task]:
    """Loads the task at a place; see `is_place`.

    Raises:
        InputError: The file or module does not exist, or contains no task.
    """
    place = _place(text)
    assert place is not None
    loaded = OUTSIDE.load_place(place, _tasks_in)
    return adapted(loaded.thing, loaded.where)


def place_file(text: str) -> Path | None:
    """Absolute path of the file of a place; None for a module."""
    place = _place(text)
    return place.file if place else None


def place_member(text: str) -> str:
    """Name of the class in the file of a place, whose task has been loaded.

    It may be another than the class has itself, as that of a class which a function has made.
    """
    place = _place(text)
    assert place is not None and place.file is not None
    return place.member or _tasks_in(load_file(place.file))[0]


def _place(text: str) -> Place | None:
    place = place_in(text)
    return place if place and place.argument is None else None


def adapted(kind: Any, where: str) -> type[Task]:
    """Checks a task, and adds missing members of the contract with their defaults.

    Raises:
        InputError: A required member is missing.
    """
    check_task(kind, where)
    optional = ("hands", "user", "painted", "pressed", "own_friction", "with_room", "shifted")
    for member in optional:
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
    if getattr(kind, "plane", None) not in ("table", "front"):
        raise InputError(
            "a task's plane is missing or invalid",
            where=where,
            got=getattr(kind, "plane", None),
            expected="table or front",
        )
    _check_limits(kind, where)
    user = getattr(kind, "user", None)
    if user is not None and not callable(user):
        raise InputError(
            "a task's user is wrong",
            where=where,
            got=repr(user)[:80],
            expected="a class that is made from (configuration, surface, seed), or None",
        )
    missing: frozenset[str] = getattr(kind, "__abstractmethods__", frozenset())
    if missing:
        raise InputError("this task lacks members", where=where, got=", ".join(sorted(missing)))


def _check_limits(kind: Any, where: str) -> None:
    """Raises an error for a number of a task that is missing, or that cannot be.

    Raises:
        InputError: It names the number.
    """
    for number in _NUMBERS:
        value = getattr(kind, number, None)
        # Before an upright surface fingertips may also be behind what they grip.
        least = -inf if number == "touch_height" and kind.plane == "front" else 0.0
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
    if not kind.time_limit > 0:
        raise InputError("a task's time_limit must be above 0", where=where, got=kind.time_limit)
    if kind.hold_time > kind.time_limit:
        raise InputError(
            "a task's hold_time is longer than its time_limit, so that nobody could succeed",
            where=where,
            got=f"{kind.hold_time:g} s, and {kind.time_limit:g} s",
        )
    hands = getattr(kind, "hands", 1)
    if isinstance(hands, bool) or not isinstance(hands, int) or hands not in (1, 2):
        raise InputError("a task's hands are wrong", where=where, got=hands, expected="1 or 2")


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
