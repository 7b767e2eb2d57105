"""What a task is: a scene with a goal, drawn from a seed, and a test of whether it is reached."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol

import numpy as np
from numpy.typing import NDArray

from models.objects import Thing
from models.surface import Surface
from tasks.goals import Goal
from tasks.sensing import Sensing
from tasks.user import UserMaker

__all__ = ["Goal", "Measure", "Task", "TaskDefaults"]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Measure:
    """How things stand at one moment.

    Attributes:
        reached: All conditions of success hold right now.
        progress: 0 (as at the start, or worse) to 1 (reached).
        reason: The first condition that does not hold, for a person; empty when all hold.
        lost: What was done cannot be undone: the trial ends here, unless it was won before.
    """

    reached: bool
    progress: float
    reason: str
    lost: bool = False


class TaskDefaults(Protocol):
    """Members that a task may leave out, with their defaults.

    Attributes:
        hands: How many hands it is made for.
        user: Makes its simulated user; None: the one that plays the built-in tasks.
    """

    hands: ClassVar[int] = 1
    user: ClassVar[UserMaker | None] = None


class Task(TaskDefaults, Protocol):
    """One drawn trial of a task. It only reads the simulation and never moves anything.

    Attributes:
        name: On the command line.
        version: Ranges and conditions are part of it; results of two versions do not compare.
        seed: What the trial was drawn from.
        objects: Things in the scene at their start.
        goals: What is to be reached.
        table_friction: Coulomb coefficient of the table.
        touch_height: m, height of the touch plane above the table; a fingertip's centre is a
            little above it, near the middle of the objects' height.
        lift_range: m by which the hand rises at lift control 1; 0 where the task needs none.
        plane: How the touch surface is placed: `table` lies flat over the table; `front` stands
            upright, its y the world's z.
        time_limit: s.
        hold_time: s for which the goal must hold without a break.
    """

    name: ClassVar[str]
    version: ClassVar[int]
    time_limit: ClassVar[float]
    hold_time: ClassVar[float]
    table_friction: ClassVar[float]
    touch_height: ClassVar[float]
    lift_range: ClassVar[float]
    plane: ClassVar[str]

    @property
    def seed(self) -> int: ...

    @property
    def objects(self) -> tuple[Thing, ...]: ...

    @property
    def goals(self) -> tuple[Goal, ...]: ...

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Task:
        """The trial of a seed, placed within reach of fingers on the surface."""
        ...

    def measure(self, sensing: Sensing) -> Measure:
        """Whether the goal is reached now, how near it is, and what is missing."""
        ...
