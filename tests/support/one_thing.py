"""A thing to put fingers beside, as a task without a goal, and where its faces are.

It lies near the middle of the surface. The line from thumb to fingers that holds it is turned
against the hand's natural one, so that the hand has to turn as far. The number of a trial, and how
many fingers and what turn it is about, are in its seed.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar, NamedTuple, Self

import numpy as np

from models.arithmetic import Array
from models.mjcf_object import MjcfObject
from models.objects import SceneObject
from models.surface import Surface
from tasks.sensing import Sensing
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import UserConfiguration

TURNS = (0, 15, 30, 45)
"""degrees, either way."""

FINGERS = (2, 3, 5)
"""Touching fingers, the thumb among them."""

TRIALS = 1000
"""Most trials of a turn and a number of fingers."""

APART = {2: 0.0, 3: 0.020, 5: 0.018}
"""m between neighbouring fingers that share a face, by the number of fingers."""

MUG_RADIUS = 0.030
"""m, outside."""

MUG = """<mujoco><worldbody><body>
  <geom type="cylinder" size=".030 .040" rgba=".25 .45 .60 1" friction="1"/>
  <geom type="capsule" size=".005" fromto=".028 0 .022 .052 0 .016"/>
  <geom type="capsule" size=".005" fromto=".052 0 .016 .052 0 -.016"/>
  <geom type="capsule" size=".005" fromto=".052 0 -.016 .028 0 -.022"/>
</body></worldbody></mujoco>"""

HANDLE = 115.0
"""degrees from the middle of the fingers to the mug's handle."""


class Grip(NamedTuple):
    """Where fingers hold a thing, thumb first, in the plane of the surface.

    Attributes:
        points: (n, 2) m in the world, on its faces.
        outwards: (n, 2) unit vectors away from the thing.
        axis: (2,) unit vector from the thumb to the fingers.
    """

    points: Array
    outwards: Array
    axis: Array


@dataclass(frozen=True)
class OneThing(TaskDefaults, ABC):
    """One thing on the table; nothing has to be done with it.

    Attributes:
        seed: Tells the turn, the number of fingers, and the trial among those.
        objects: The thing.
        fingers: Number of touching fingers.
        axis: rad, direction from the thumb to the fingers that holds it.
    """

    name: ClassVar[str]
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 60.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.3
    touch_height: ClassVar[float] = 0.022
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"

    seed: int
    objects: tuple[SceneObject, ...]
    fingers: int
    axis: float
    goals: tuple[Goal, ...] = ()

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Self:
        """The trial of a seed."""
        turn, fingers = divmod(seed // TRIALS, len(FINGERS))
        rng = np.random.default_rng([seed, 61_003])
        person = UserConfiguration()
        count = FINGERS[fingers]
        natural = person.natural_axis if count == 2 else person.natural_axis_of_row
        axis = natural + rng.choice((-1.0, 1.0)) * np.deg2rad(TURNS[turn])
        middle = surface.to_world(surface.size / 2 + rng.uniform(-0.015, 0.015, 2))
        thing = cls._thing(rng, middle, float(axis), count)
        return cls(seed, (thing,), count, float(axis))

    @classmethod
    @abstractmethod
    def _thing(
        cls, rng: np.random.Generator, middle: Array, axis: float, fingers: int
    ) -> SceneObject:
        """The thing at (3,) m, to be held along an axis, rad."""

    def grip(self) -> Grip:
        """Where its fingers hold it at the start."""
        c, s = np.cos(self.axis), np.sin(self.axis)
        points, outwards = self._faces()
        turn = np.array([[c, s], [-s, c]])
        return Grip(
            np.array(self.objects[0].position[:2]) + points @ turn,
            outwards @ turn,
            np.array([c, s]),
        )

    def _faces(self) -> tuple[Array, Array]:
        """Points on the faces and directions out of them, (n, 2) and (n, 2), x along the axis."""
        row = APART[self.fingers] * (np.arange(self.fingers - 1) - (self.fingers - 2) / 2)
        half = self._half_width()
        points = np.column_stack([np.full(self.fingers - 1, half), -row])
        thumb = np.array([[-half, 0.0]])
        away = np.repeat([[-1.0, 0.0], [1.0, 0.0]], [1, self.fingers - 1], axis=0)
        return np.vstack([thumb, points]), away

    @abstractmethod
    def _half_width(self) -> float:
        """m from its middle to the faces that are held."""

    def measure(self, sensing: Sensing) -> Measure:
        """Nothing is to be reached."""
        return Measure(False, 0.0, "there is no goal")


class MugOnTable(OneThing):
    """A mug of 80 to 200 g, its handle beside the thumb, on either side."""

    name = "mug-on-table"

    @classmethod
    def _thing(
        cls, rng: np.random.Generator, middle: Array, axis: float, fingers: int
    ) -> SceneObject:
        handle = np.deg2rad(HANDLE) * rng.choice((-1.0, 1.0))
        mass = float(rng.uniform(0.08, 0.20))
        return MjcfObject.on_table("thing", MUG, mass, middle, axis + float(handle))

    def _half_width(self) -> float:
        return MUG_RADIUS

    def _faces(self) -> tuple[Array, Array]:
        points, outwards = super()._faces()
        # As far apart along the middles of the fingertips as along a flat face.
        angles = -points[1:, 1] / (MUG_RADIUS + 0.008)
        outwards[1:] = np.column_stack([np.cos(angles), np.sin(angles)])
        return MUG_RADIUS * outwards, outwards
