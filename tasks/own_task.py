"""What a task of somebody's own is made from: say what lies where, and when it is done.

    class Push(OwnTask):
        name = "my-lab-push"

        @classmethod
        def place(cls, rng, surface):
            start, goal = two_places(rng, surface)
            mug = MjcfThing.on_table("mug", "mug.xml", 0.2, start)
            return [mug], [Goal("mug", (goal[0], goal[1], mug.height), 0.0)]

        def measure(self, sensing):
            off = sensing.object("mug").position - self.goals[0].position
            far = float(np.linalg.norm(off))
            return judge(1 - far / 0.1, (far > 0.01, f"it is {1000 * far:.0f} mm away"))

Any class that keeps to `tasks.task.Task` will do as well; this one fills in what is mostly alike.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, Self
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from models.errors import InputError
from models.objects import Thing
from models.surface import Surface
from tasks.sensing import Sensing
from tasks.task import Goal, Measure, TaskDefaults

Array = NDArray[np.float64]

_TRIES = 4_000
"""Draws before a surface is said to be too small."""


@dataclass(frozen=True)
class OwnTask(TaskDefaults, ABC):
    """One drawn trial of a task; its class attributes are those of `tasks.task.Task`.

    Attributes:
        seed: What the trial was drawn from.
        objects: Things in the scene at their start.
        goals: What is to be reached; views show it, and the simulated user sees it there.
        user: Plays it as `--device simulated`; None: the one that plays our own tasks, which brings
            `goals[0].object` to its goal by pinching it.
    """

    name: ClassVar[str]
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 30.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.3
    touch_height: ClassVar[float] = 0.015
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"

    seed: int
    objects: tuple[Thing, ...]
    goals: tuple[Goal, ...] = ()

    @classmethod
    @abstractmethod
    def place(
        cls, rng: np.random.Generator, surface: Surface
    ) -> tuple[Sequence[Thing], Sequence[Goal]]:
        """Things at their start, and goals.

        Args:
            rng: The only chance there is: the same seed places the same.
            surface: Where fingers reach; `surface.to_world(xy)` are places in the world.
        """

    @abstractmethod
    def measure(self, sensing: Sensing) -> Measure:
        """Whether it is done now, how near it is, and what is missing; see `judge`."""

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Self:
        """The trial of a seed; same seed, version and surface, same trial."""
        rng = np.random.default_rng([seed, cls.version, crc32(cls.name.encode())])
        objects, goals = cls.place(rng, surface)
        return cls(seed, tuple(objects), tuple(goals))


def judge(progress: float, *lacks: tuple[bool, str]) -> Measure:
    """How things stand.

    Args:
        progress: 0 (as at the start) to 1, as if nothing else were to be looked at.
        lacks: What stands against success, and whether it does; the first is told to the person.
    """
    reason = next((why for lacking, why in lacks if lacking), "")
    # Nothing but success is 1.
    return Measure(not reason, float(np.clip(progress, 0.0, 0.99)) if reason else 1.0, reason)


def two_places(
    rng: np.random.Generator,
    surface: Surface,
    apart: tuple[float, float] = (0.05, 0.10),
    border: float = 0.035,
) -> tuple[Array, Array]:
    """Start and goal on the table, (3,) and (3,) m in the world, uniform where they fit.

    Args:
        rng: Draws them.
        surface: The screen.
        apart: m, least and greatest distance.
        border: m from the surface's border, so that fingers have room beside a thing.

    Raises:
        InputError: The surface has no room for them.
    """
    low, high = np.full(2, border), surface.size - border
    for _ in range(_TRIES if np.all(high > low) else 0):
        start, end = rng.uniform(low, high), rng.uniform(low, high)
        if apart[0] <= np.linalg.norm(end - start) <= apart[1]:
            places = surface.to_world(np.stack([start, end]))
            places[:, 2] = 0.0
            return places[0], places[1]
    raise InputError(
        "the surface is too small for this task",
        got=f"{surface.width_in:.3g}x{surface.height_in:.3g}in",
        expected=f"room for two places {1000 * apart[0]:.0f} mm apart",
    )
