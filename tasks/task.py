"""Contract of tasks: a scene with goals, drawn from a seed, and a test of whether they are reached.

Some goals are fixed in the world. Other goals are on top of a moving object; `place` computes their
current positions. `place_surface` places the touch surface of a task in the world.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import atan2, cos, sin
from typing import TYPE_CHECKING, ClassVar, Protocol

import numpy as np

from models.arithmetic import Array, length, stacked_applied
from models.errors import InputError
from models.objects import SceneObject
from models.scene import PaintedRing
from models.surface import METRES_PER_INCH, Surface
from tasks.sensing import Sensing

if TYPE_CHECKING:
    from tasks.user import UserMaker

_NEAR = 0.030
"""An object that is nearer to its own goal than this distance (m) counts as placed. A goal on top
of a placed object follows the object. A goal on top of any other object is shown above that
object's goal."""


@dataclass(frozen=True)
class Goal:
    """Intended pose of an object; views draw the object's ghost there.

    Attributes:
        object: Name of the object.
        position: (3,) m, centre of the object at the goal. With `on`, it is relative to the centre
            of the lower object, in the world's directions.
        yaw: Yaw (rad) about the vertical. With `on`, it is relative to the lower object.
        on: Name of the lower object, on whose current position the object should stand. `place`
            converts such goals to positions in the world.
        shown: False for an object that only has to stay in place; views draw nothing for it.
        ghost: False where any pose within a painted area counts; views draw only the area.
    """

    object: str
    position: tuple[float, float, float]
    yaw: float
    on: str | None = None
    shown: bool = True
    ghost: bool = True

    @property
    def drawn(self) -> bool:
        """True if views draw the object's ghost at the goal."""
        return self.shown and self.ghost


class Posed(Protocol):
    """An object with a position (3,) m and a rotation (3, 3) in the world."""

    @property
    def position(self) -> Array: ...

    @property
    def rotation(self) -> Array: ...


def place(goals: Sequence[Goal], poses: Mapping[str, Posed]) -> tuple[Goal, ...]:
    """Converts goals to their current positions in the world; none of the results has `on` set.

    Args:
        goals: Goals in order, lower ones first.
        poses: Current poses of the objects, by name.
    """
    placed: dict[str, Goal] = {}
    for goal in goals:
        if goal.on is None:
            placed[goal.object] = goal
            continue
        below = poses[goal.on]
        base, yaw = np.asarray(below.position), flat_yaw(below.rotation)
        planned = placed.get(goal.on)
        if planned and length(base - planned.position) > _NEAR:
            base, yaw = np.asarray(planned.position), planned.yaw
        x, y, z = (base + goal.position).tolist()
        placed[goal.object] = Goal(goal.object, (x, y, z), yaw + goal.yaw)
    return tuple(placed[goal.object] for goal in goals)


def flat_yaw(rotation: Array) -> float:
    """Yaw (rad) of the object's most horizontal axis; among equals, x before y before z.

    A box that stands on its x face has an upright x axis, but its other edges still have a yaw.
    """
    steep = [round(10.0 * abs(z)) for z in rotation[2].tolist()]
    x, y, _ = rotation[:, steep.index(min(steep))].tolist()
    return atan2(y, x)


__all__ = ["Goal", "Measure", "Task", "TaskDefaults"]


@dataclass(frozen=True)
class Measure:
    """State of a task at one moment.

    Attributes:
        reached: All conditions of success hold right now.
        progress: 0 (as at the start, or worse) to 1 (reached).
        reason: Text, shown to people, that names the first condition that does not hold; empty if
            all conditions hold.
        lost: True if the trial has failed for good. It then ends, unless it had succeeded before.
        first: Measure of a condition that has to be held first, for the same hold time. Until then
            it replaces this measure. None if there is no such condition.
    """

    reached: bool
    progress: float
    reason: str
    lost: bool = False
    first: Measure | None = None


class TaskDefaults(Protocol):
    """Members that a task may leave out, with their defaults.

    Attributes:
        hands: Number of hands that the task needs.
        painted: Rings that are painted on the table.
        user: Creates the simulated user; None uses the user of the built-in tasks.
        pressed: True if the objects are pressed from above. Hands then turn solid on their way
            down, rather than once they are down.
        own_friction: True if contacts of an object with hands and table use the friction
            coefficient of the object; see `SceneSpec`.
        fewest_fingers: Least number of different fingers with which the task can be played.
    """

    hands: ClassVar[int] = 1
    fewest_fingers: ClassVar[int] = 1
    user: ClassVar[UserMaker | None] = None
    pressed: ClassVar[bool] = False
    own_friction: ClassVar[bool] = False

    @property
    def painted(self) -> tuple[PaintedRing, ...]:
        return ()

    def shifted(self: Task) -> tuple[str, ...]:
        """Names of the objects whose starts `--vary start` shifts: those that a person carries.

        By default all objects.

        Raises:
            InputError: No object's start can be shifted; the error gives the reason.
        """
        return tuple(thing.name for thing in self.objects)

    def with_room(self, factor: float) -> Task:
        """The same trial with more or less room between its objects.

        Args:
            factor: Factor on the task's room, such as the width of a gate or a clearance.

        Raises:
            InputError: The task has no room that can be varied, as by default.
        """
        raise InputError(
            "this task has no room that can be varied",
            where="room",
            remedy="Vary something else",
        )


class Task(TaskDefaults, Protocol):
    """One drawn trial of a task. It only reads the simulation and never moves anything.

    Attributes:
        name: Name on the command line.
        version: Version of the ranges and conditions. Results of different versions cannot be
            compared.
        seed: Seed of the trial.
        objects: Objects in the scene at their start.
        goals: Goals to be reached.
        table_friction: Coulomb coefficient of the table; it has no effect with `own_friction`.
        touch_height: Height (m) of the touch plane above the table. A fingertip's centre is a
            little above this plane, near the middle of the objects' height.
        lift_range: Height (m) by which the hand rises at lift control 1; 0 if the task needs none.
        plane: Placement of the touch surface: `table` lies flat over the table; `front` stands
            upright, and the surface's y is vertical.
        time_limit: Longest duration (s) of a trial.
        hold_time: Time (s) for which the goal must be reached without a break.
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


BELOW_TABLE = 0.015
"""Distance (m) by which an upright surface reaches below the table's top, so that fingers beside an
object on the table are still on the surface."""

_SHARES = np.linspace(0.0, 1.0, 50)
"""Heights of the test points on a surface's sides, as shares of the surface's height."""


def place_surface(surface: Surface, task: type[Task]) -> Surface:
    """Places a task's surface in the world: flat over the table, or upright in front of the person.

    A flat surface is `touch_height` above the table. An upright surface is `touch_height` in front
    of world y = 0, which is the depth of the objects of an upright task.
    """
    if task.plane == "front":
        return surface.placed_upright(-task.touch_height, -BELOW_TABLE)
    return surface.centred_at((0.0, 0.0, task.touch_height))


def over_a_side(obj: SceneObject, surface: Surface) -> bool:
    """True if an object at its start projects over the left or right side of an upright surface.

    The object cannot be gripped there, so a session would put it back again and again.

    Args:
        obj: The object; its yaw is about the vertical.
        surface: The surface as placed in the world.
    """
    position = np.asarray(obj.position, float)
    x, _, off = stacked_applied(surface.rotation.T, position - surface.corner).tolist()
    if not 0.0 < x < surface.size[0]:
        return True
    c, s = cos(obj.yaw), sin(obj.yaw)
    turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return reaches_a_side(obj, position, turned, surface, (x, off))


def reaches_a_side(
    obj: SceneObject,
    position: Array,
    rotation: Array,
    surface: Surface,
    place: tuple[float, float],
) -> bool:
    """True if the nearer side of an upright surface runs through an object.

    Args:
        obj: The object.
        position: (3,) m, its middle in the world.
        rotation: (3, 3), world from object.
        surface: The surface as placed in the world.
        place: Position (m) of the object's middle along the surface, and its distance from it.
    """
    x, off = place
    width, height = METRES_PER_INCH * surface.width_in, METRES_PER_INCH * surface.height_in
    side = 0.0 if x < width / 2 else width
    points = np.column_stack([np.full(len(_SHARES), side), height * _SHARES])
    return bool(obj.clearance(surface.to_world(points, off), position, rotation).min() < 0.0)


def summary(task: type[Task]) -> str:
    """The first line of a task's docstring."""
    return (task.__doc__ or task.name).strip().splitlines()[0]
