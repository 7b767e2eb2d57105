"""Base class of wrench tasks: drawing a trial, testing the wrench's pose, and progress."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, Self

import numpy as np

from models.arithmetic.arrays import Array
from models.errors import SurfaceTooSmallError
from models.message import Message
from models.objects import Wrench
from models.surface import Surface
from tasks.sensing import ObjectState, Sensing
from tasks.task import Goal, Measure, TaskDefaults

Place = tuple[float, float, float]

NAME = "wrench"
"""Name of the wrench in all these tasks."""
MASS = (0.060, 0.150)
"""kg."""
END_BORDER = 0.004
"""m from the surface's border to the nearest place for an end of the wrench."""
SPEED_TOLERANCE = 0.010
"""m/s of the wrench's middle, below which it counts as still."""

_TRIES = 4_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class WrenchTask(TaskDefaults, ABC):
    """Bring a wrench onto its translucent twin.

    Tasks differ in the wrench's freedom of movement, its starts and its tolerances.

    Attributes:
        stream: Number of this task's random stream of a seed.
        border: m from the surface's border to the nearest place that is drawn.
        room: Text for errors: what a surface must have room for.
        room_in: (2,) inches of a surface that has it.
    """

    name: ClassVar[str]
    version: ClassVar[int]
    stream: ClassVar[int]
    border: ClassVar[float]
    room: ClassVar[str]
    room_in: ClassVar[tuple[float, float]]
    time_limit: ClassVar[float] = 30.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.3
    touch_height: ClassVar[float] = 0.006
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"

    seed: int
    objects: tuple[Wrench, ...]
    goals: tuple[Goal, ...]

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Self:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            SurfaceTooSmallError: The surface is too small for a start and a goal.
        """
        rng = np.random.default_rng([seed, cls.version, cls.stream])
        low, high = np.full(2, cls.border), surface.size - cls.border
        for _ in range(_TRIES if np.all(high > low) else 0):
            way = cls._way(rng, low, high, surface)
            if way is not None:
                break
        else:
            size = surface.width_in, surface.height_in
            raise SurfaceTooSmallError(cls.name, size, cls.room, cls.room_in)
        start, yaw, end, turn = way
        mass = float(rng.uniform(*MASS))
        wrench = Wrench(NAME, mass, start, yaw, cls._bolt(rng))
        return cls(seed, (wrench,), (Goal(NAME, end, yaw + turn),))

    @classmethod
    @abstractmethod
    def _way(
        cls, rng: np.random.Generator, low: Array, high: Array, surface: Surface
    ) -> tuple[Place, float, Place, float] | None:
        """Draws start, yaw at the start, goal and turn between them; None if the draw does not fit.

        Args:
            rng: This trial's source of randomness.
            low, high: (2,) m, corners of the area for places, in the surface's frame.
            surface: The tablet.
        """

    @classmethod
    def _bolt(cls, rng: np.random.Generator) -> float | None:
        """Friction about the bolt in N m; None without a bolt."""
        return None

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the wrench is at its goal, let go and at rest now."""
        wrench = sensing.object(NAME)
        reason = self._missing(wrench) or _reason_not_settled(wrench)
        # Only success is 1.
        progress = 1.0 if not reason else float(min(self._progress(wrench), 0.99))
        return Measure(not reason, progress, reason, self._lost(wrench))

    @abstractmethod
    def _missing(self, wrench: ObjectState) -> str:
        """Reason why the wrench is not at its goal, apart from touch and speed; empty if it is."""

    def _lost(self, wrench: ObjectState) -> bool:
        """True if the wrench was turned in a way that ends the trial."""
        return False

    @abstractmethod
    def _progress(self, wrench: ObjectState) -> float:
        """0 at the start or farther away, 1 at the goal."""

    def _turn_left(self, wrench: ObjectState) -> float:
        """Angle in rad between the wrench and its goal."""
        return _apart(wrench.yaw, self.goals[0].yaw)

    def _turned(self, wrench: ObjectState, tolerance: float) -> float:
        """Share of the turn that is done, complete within a tolerance, rad."""
        whole = _apart(self.objects[0].yaw, self.goals[0].yaw)
        return share(self._turn_left(wrench), whole, tolerance)


def share(left: float, whole: float, tolerance: float) -> float:
    """Share 0 to 1 of a way that is done, complete within a tolerance."""
    return min(max(1.0 - max(left - tolerance, 0.0) / (whole - tolerance), 0.0), 1.0)


def _reason_not_settled(wrench: ObjectState) -> str:
    if wrench.held:
        return Message("wrench_touched", "a hand still touches the wrench")
    if wrench.speed > SPEED_TOLERANCE:
        return Message("wrench_moves", "the wrench is still moving")
    return ""


def wrapped(angle: float) -> float:
    """An angle, rad, from -pi to pi."""
    return float((angle + np.pi) % (2 * np.pi) - np.pi)


def _apart(a: float, b: float) -> float:
    """Difference of two yaws, rad."""
    return abs(wrapped(a - b))
