"""Base class for custom tasks: place the objects, and test when the task is done.

    class Push(CustomTask):
        name = "my-lab-push"

        @classmethod
        def place(cls, rng, surface):
            start, goal = two_places(rng, surface)
            described = Path(__file__).parent / "mug.xml"
            mug = MjcfObject.on_table("mug", described, 0.2, start)
            return [mug], [Goal("mug", (goal[0], goal[1], mug.height), 0.0)]

        def measure(self, sensing):
            off = sensing.object("mug").position - self.goals[0].position
            far = length(off)
            return judge(1 - far / 0.1, (far > 0.01, f"it is {1000 * far:.0f} mm away"))

Any class that follows the contract `tasks.task.Task` works as well. `CustomTask` adds the parts
that most tasks have in common.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from inspect import getattr_static
from typing import ClassVar, Self
from zlib import crc32

import mujoco
import numpy as np

from models.arithmetic import Array, length
from models.errors import InputError, SurfaceTooSmallError
from models.objects import MechanismPart, SceneObject
from models.scene import Scene, SceneSpec
from models.surface import Surface
from tasks.sensing import Sensing
from tasks.task import Goal, Measure, TaskDefaults

_SUNK = 0.001
"""Greatest depth (m) below the table's top at which a mechanism may be placed."""
_TRIES = 4_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class CustomTask(TaskDefaults, ABC):
    """One drawn trial of a task; its class attributes are those of `tasks.task.Task`.

    Attributes:
        seed: The seed of the trial.
        objects: Objects in the scene at their start.
        goals: The goals, which views show to people and to the simulated user.
        user: Creates the simulated user for `--device simulated`; None uses the user of the
            built-in tasks, who brings `goals[0].object` to its goal by pinching it.
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
    objects: tuple[SceneObject, ...]
    goals: tuple[Goal, ...] = ()

    @classmethod
    @abstractmethod
    def place(
        cls, rng: np.random.Generator, surface: Surface
    ) -> tuple[Sequence[SceneObject], Sequence[Goal]]:
        """Returns the objects at their start, and the goals.

        Args:
            rng: The only source of randomness, so that the same seed gives the same trial.
            surface: The area that fingers reach; `surface.to_world(xy)` gives positions in the
                world.
        """

    @abstractmethod
    def measure(self, sensing: Sensing) -> Measure:
        """Measures whether the task is done now, its progress and what is missing; see `judge`."""

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Self:
        """Draws the trial of a seed; the same seed, version and surface give the same trial."""
        if not isinstance(getattr_static(cls, "place"), classmethod | staticmethod):
            raise InputError(
                "`place` is not a class method",
                where=cls.name,
                remedy="Write @classmethod above `def place(cls, rng, surface)`",
            )
        rng = np.random.default_rng([seed, cls.version, crc32(cls.name.encode())])
        objects, goals = cls.place(rng, surface)
        for what, placed in (("objects", objects), ("goals", goals)):
            if not isinstance(placed, Iterable):
                raise InputError(
                    f"`place` did not return a list of {what}",
                    where=cls.name,
                    got=type(placed).__name__,
                    expected=f"a list of {what}",
                    remedy="For a mechanism `desk`, return desk.parts"
                    if placed is objects
                    else None,
                )
        if not cls.pressed:
            _check_not_sunk(tuple(objects), f"{cls.name}, seed {seed}")
        return cls(seed, tuple(objects), tuple(goals))


def _check_not_sunk(objects: tuple[SceneObject, ...], where: str) -> None:
    """Checks that no mechanism was placed below the table's top.

    The table does not push a fixed mechanism out, since the two do not collide. A description may
    have geoms below its origin, such as keys that move down into the table. The position is a
    mistake only if both the origin and solid geoms are below the table's top.

    Raises:
        InputError: A mechanism was placed below the table's top.
    """
    low = {
        obj.name: obj.together
        for obj in objects
        if isinstance(obj, MechanismPart) and obj.carrier is None and obj.position[2] < -_SUNK
    }
    if not low:
        return
    scene = Scene(SceneSpec((), objects))
    model, data = scene.model, mujoco.MjData(scene.model)
    mujoco.mj_kinematics(model, data)
    for name, parts in low.items():
        inside = [scene.object_bodies[part] for part in parts]
        solid = np.isin(model.geom_bodyid, inside) & (model.geom_contype > 0)
        turns = data.geom_xmat[solid].reshape(-1, 3, 3)[:, 2]
        middle, half = model.geom_aabb[solid, :3], model.geom_aabb[solid, 3:]
        middles = data.geom_xpos[solid, 2] + np.sum(turns * middle, axis=1)
        lowest = float(np.min(middles - np.sum(np.abs(turns) * half, axis=1), initial=np.inf))
        if lowest < -_SUNK:
            raise InputError(
                f"{name} is sunk into the table",
                where=where,
                got=f"{-1000 * lowest:.1f} mm deep",
                expected=f"at most {1000 * _SUNK:g} mm",
                remedy="Place it higher. In its description, sunk parts belong below the origin",
            )


def judge(progress: float, *lacks: tuple[bool, str]) -> Measure:
    """Combines the conditions of success into a measure.

    Args:
        progress: Progress, 0 (as at the start) to 1, before the conditions are taken into account.
        lacks: For each condition, a boolean that is true while the condition is not met, and a
            text. People see the first text, among the unmet conditions, that is not empty.
    """
    missing = [why for lacking, why in lacks if lacking]
    # Only success is 1.
    reached = not missing
    part = 1.0 if reached else float(np.clip(progress, 0.0, 0.99))
    return Measure(reached, part, next(filter(None, missing), ""))


def two_places(
    rng: np.random.Generator,
    surface: Surface,
    apart: tuple[float, float] = (0.05, 0.10),
    border: float = 0.035,
) -> tuple[Array, Array]:
    """Draws start and goal on the table, (3,) and (3,) m in the world, uniformly.

    Args:
        rng: Source of randomness.
        surface: The screen.
        apart: Least and greatest distance (m).
        border: Distance (m) from the surface's border, so that fingers have room beside an object.

    Raises:
        SurfaceTooSmallError: The surface is too small for two places.
        InputError: The surface is upright (`plane = "front"`). Objects in front of it stand on a
            floor, which has no second dimension to draw.
    """
    if surface.upright:
        raise InputError(
            "`two_places` draws places on a table, but this surface is upright",
            where="two_places",
            remedy="Draw the places yourself: x along the screen, z up, y in the screen's plane",
        )
    low, high = np.full(2, border), surface.size - border
    for _ in range(_TRIES if np.all(high > low) else 0):
        start, end = rng.uniform(low, high), rng.uniform(low, high)
        if apart[0] <= length(end - start) <= apart[1]:
            places = surface.to_world(np.stack([start, end]))
            places[:, 2] = 0.0
            return places[0], places[1]
    size = surface.width_in, surface.height_in
    raise SurfaceTooSmallError("", size, f"two places {1000 * apart[0]:.0f} mm apart")
