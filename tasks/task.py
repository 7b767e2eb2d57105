"""Contract of tasks: a scene with goals, drawn from a seed, and a test of whether they are
reached."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, Protocol

from models.errors import InputError
from models.objects import SceneObject
from models.scene import PaintedRing
from models.surface import Surface
from tasks.goals import Goal
from tasks.sensing import Sensing
from tasks.user import UserMaker

__all__ = ["Goal", "Measure", "Task", "TaskDefaults"]


@dataclass(frozen=True)
class Measure:
    """State of a task at one moment.

    Attributes:
        reached: All conditions of success hold right now.
        progress: 0 (as at the start, or worse) to 1 (reached).
        reason: Text for people of the first condition that does not hold; empty when all hold.
        lost: True if the trial failed for good: it ends here, unless it had succeeded before.
        first: Measure of what has to be held before, for the same hold time; until it was, it
            stands for this one. None where nothing has to be.
    """

    reached: bool
    progress: float
    reason: str
    lost: bool = False
    first: Measure | None = None


class TaskDefaults(Protocol):
    """Members that a task may leave out, with their defaults.

    Attributes:
        hands: Number of hands that it needs.
        painted: Rings that are painted on the table.
        user: Creates its simulated user; None uses the user of the built-in tasks.
        pressed: Its objects are pressed from above: hands turn solid on their way down, rather than
            once they are down.
        own_friction: The friction of its objects counts against hands and table; see `SceneSpec`.
    """

    hands: ClassVar[int] = 1
    user: ClassVar[UserMaker | None] = None
    pressed: ClassVar[bool] = False
    own_friction: ClassVar[bool] = False

    @property
    def painted(self) -> tuple[PaintedRing, ...]:
        return ()

    def shifted(self: Task) -> tuple[str, ...]:
        """Names of the things whose starts `--vary start` shifts: what a person is to carry.

        By default all objects.

        Raises:
            InputError: There is nothing whose start could be shifted; the error says why.
        """
        return tuple(thing.name for thing in self.objects)

    def with_room(self, factor: float) -> Task:
        """The same trial with so much more or less room between its things.

        Args:
            factor: Factor on what the task calls its room: the width of a gate, a clearance.

        Raises:
            InputError: The task leaves no room that could be varied, as by default.
        """
        raise InputError(
            "this task leaves no room that can be varied",
            where="room",
            remedy="Vary something else",
        )


class Task(TaskDefaults, Protocol):
    """One drawn trial of a task. It only reads the simulation and never moves anything.

    Attributes:
        name: Name on the command line.
        version: Version of ranges and conditions; results of two versions cannot be compared.
        seed: Seed of the trial.
        objects: Objects in the scene at their start.
        goals: Goals to be reached.
        table_friction: Coulomb coefficient of the table; of no effect with `own_friction`.
        touch_height: m, height of the touch plane above the table; a fingertip's centre is a
            little above it, near the middle of the objects' height.
        lift_range: m by which the hand rises at lift control 1; 0 where the task needs none.
        plane: Placement of the touch surface: `table` lies flat over the table; `front` stands
            upright, its y the world's z.
        time_limit: s, duration of a trial at most.
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
    def objects(self) -> tuple[SceneObject, ...]: ...

    @property
    def goals(self) -> tuple[Goal, ...]: ...

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Task:
        """Draws the trial of a seed, placed within reach of fingers on the surface."""
        ...

    def measure(self, sensing: Sensing) -> Measure:
        """Measures whether the goal is reached now, the progress and what is missing."""
        ...
