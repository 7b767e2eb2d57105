"""A curriculum: easier and harder trials, by the options of a reset."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, is_dataclass, replace
from math import pi
from typing import Any

from models.errors import InputError
from models.objects import MechanismPart
from sandbox.trial.settings import Settings
from tasks.task import Task
from tasks.variation import RANGES

NEAREST = 0.95
"""Largest share of the way to its goal on which an object may start."""


@dataclass(frozen=True)
class Curriculum:
    """Changes to one trial; none by default.

    Attributes:
        near: Share of the way to its goal, and of the turn, that every object starts ahead.
        size: Factor on the objects' edges.
        mass: Factor on their masses.
        friction: Factor on every coefficient of sliding friction.
        start: m by which every object's start is shifted, in a direction that follows from the
            seed.
    """

    near: float = 0.0
    size: float = 1.0
    mass: float = 1.0
    friction: float = 1.0
    start: float = 0.0

    @classmethod
    def of(cls, options: Mapping[str, Any] | None) -> Curriculum:
        """Reads the options of a reset.

        Raises:
            InputError: An option is unknown, no number, or out of range.
        """
        known = {f.name for f in fields(cls)}
        for name, value in (options or {}).items():
            if name not in known:
                raise InputError(
                    "not an option of reset",
                    where="reset(options=)",
                    got=name,
                    expected=", ".join(sorted(known)),
                )
            low, high = RANGES.get(name, (0.0, NEAREST))
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if not number or not low <= value <= high:
                raise InputError(
                    f"{name} is out of range",
                    where="reset(options=)",
                    got=value,
                    expected=f"{low:g} to {high:g}",
                )
        return cls(**{name: float(value) for name, value in (options or {}).items()})

    def settings(self, settings: Settings) -> Settings:
        """Settings of a trial with these changes."""
        changes = {f.name: getattr(self, f.name) for f in fields(self) if f.name != "near"}
        if self == Curriculum(near=self.near):
            return settings
        return replace(settings, variation=replace(settings.variation, **changes))

    def task(self, task: Task) -> Task:
        """A drawn trial whose objects start ahead.

        Raises:
            InputError: Its objects cannot start elsewhere.
        """
        if not self.near:
            return task
        goals = {goal.object: goal for goal in task.goals}
        moved = []
        for thing in task.objects:
            goal = goals.get(thing.name)
            if goal is None:
                moved.append(thing)
                continue
            lies = goal.on is None and abs(goal.position[2] - thing.position[2]) < 1e-3
            lies = lies and not isinstance(thing, MechanismPart)
            if not (lies and is_dataclass(thing) and is_dataclass(task)) or _bolted(thing):
                raise InputError(
                    "this object cannot start on the way to its goal",
                    where="reset(options=), near",
                    got=f"{thing.name} of {task.name}",
                    expected="an object that is moved along the table",
                )
            # The shorter way round.
            turn = (goal.yaw - thing.yaw + pi) % (2 * pi) - pi
            way = zip(thing.position, goal.position, strict=True)
            x, y, z = (a + self.near * (b - a) for a, b in way)
            moved.append(replace(thing, position=(x, y, z), yaw=thing.yaw + self.near * turn))
        changed: Task = replace(task, objects=tuple(moved))  # type: ignore[type-var]
        return changed


def _bolted(thing: Any) -> bool:
    return "bolt" in {f.name for f in fields(thing)} and thing.bolt is not None
