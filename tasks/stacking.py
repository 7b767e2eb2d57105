"""Base class of stacking tasks: boxes, their order, and the test of whether they are stacked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import cos, sin
from typing import ClassVar, Self

import numpy as np

from models.arithmetic.arrays import Array
from models.arithmetic.products import length
from models.errors import SurfaceTooSmallError
from models.message import Message
from models.objects import Box
from models.scene import TABLE
from models.surface import Surface
from tasks.goals import Posed, place
from tasks.sensing import ObjectState, Sensing
from tasks.task import Goal, Measure, TaskDefaults

NAMES = ("base", "second", "third")
"""Names of the boxes, from below."""
COLOURS = ((0.86, 0.30, 0.24), (0.93, 0.68, 0.22), (0.30, 0.52, 0.78))
"""Colours of the boxes, by which the page names them (sandbox/words)."""

EDGE = (0.040, 0.060)
"""m."""
MASS = (0.050, 0.250)
"""kg."""
YAW = float(np.deg2rad(45.0))
"""rad, largest rotation of a box relative to the surface's axes at the start, either way."""

OFFSET_TOLERANCE = 0.35
"""Share of the smaller edge of two boxes: largest distance of their centres, seen from above."""
LEAN_TOLERANCE = float(np.deg2rad(3.0))
"""rad."""
SPEED_TOLERANCE = 0.010
"""m/s."""


@dataclass(frozen=True)
class Stacking(TaskDefaults):
    """Boxes to be stacked in a given order.

    Tasks differ in the number of boxes and in their starts.

    Attributes:
        count: Number of boxes.
    """

    name: ClassVar[str]
    version: ClassVar[int] = 1
    count: ClassVar[int] = 2
    time_limit: ClassVar[float] = 60.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.5
    touch_height: ClassVar[float] = 0.022
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"

    seed: int
    objects: tuple[Box, ...]
    goals: tuple[Goal, ...]

    @classmethod
    def of(cls, seed: int, edges: Array, masses: Array, places: Array, yaws: Array) -> Self:
        """Creates the trial with these boxes, the lowest one first.

        Args:
            seed: Seed from which the values were drawn.
            edges: (count,) m.
            masses: (count,) kg.
            places: (count, 2) m, centres on the table, in the world.
            yaws: (count,) rad.
        """
        boxes = tuple(
            Box(
                NAMES[i],
                (edges[i] / 2,) * 3,
                float(masses[i]),
                (float(places[i, 0]), float(places[i, 1]), edges[i] / 2),
                float(yaws[i]),
                COLOURS[i],
            )
            for i in range(cls.count)
        )
        goals = tuple(
            Goal(upper.name, (0.0, 0.0, lower.half_size[2] + upper.half_size[2]), 0.0, lower.name)
            for lower, upper in pairwise(boxes)
        )
        return cls(seed, boxes, goals)

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the boxes are stacked now; names the lowest missing condition."""
        states = {box.name: sensing.object(box.name) for box in self.objects}
        done, missing = 0, ""
        for lower, upper in pairwise(self.objects):
            missing = self._missing(lower, upper, states, sensing)
            if missing:
                break
            done += 1
        reason = self._base_missing(states, sensing) or missing
        progress = 1.0 if not reason else min(self._progress(states, done), 0.99)
        return Measure(not reason, progress, reason)

    def _base_missing(self, states: dict[str, ObjectState], sensing: Sensing) -> str:
        name = self.objects[0].name
        if not sensing.rests_on(name, TABLE):
            return Message("stack_off_table", "the {box} box does not stand on the table", box=name)
        if any(sensing.rests_on(name, other.name) for other in self.objects[1:]):
            return Message("stack_on_other", "the {box} box stands on another one", box=name)
        return _reason_not_settled(name, states[name])

    def _missing(
        self, lower: Box, upper: Box, states: dict[str, ObjectState], sensing: Sensing
    ) -> str:
        """Reason why a box does not stand on the right box below; empty if it does."""
        name, below = upper.name, lower.name
        if sensing.touching(name, TABLE):
            return Message("stack_on_table", "the {box} box stands on the table", box=name)
        others = (o.name for o in self.objects if o.name not in (name, below))
        if not sensing.rests_on(name, below) or any(sensing.rests_on(name, o) for o in others):
            return Message(
                "stack_not_on",
                "the {box} box does not stand on the {below} box",
                box=name,
                below=below,
            )
        off = length((states[name].position - states[below].position)[:2])
        if off > OFFSET_TOLERANCE * 2 * min(lower.half_size[0], upper.half_size[0]):
            return Message(
                "stack_off_middle",
                "the {box} box is {mm} mm off the middle of the {below} box",
                box=name,
                mm=f"{1000 * off:.0f}",
                below=below,
            )
        return _reason_not_settled(name, states[name])

    def _progress(self, states: dict[str, ObjectState], done: int) -> float:
        """Share of the upper boxes that are in place, plus the progress of the next one."""
        if done == len(self.goals):
            return 1.0
        way = min(
            max(1.0 - self._distance_to_place(done, states) / self._start_distances[done], 0.0), 1.0
        )
        return (done + 0.99 * way) / len(self.goals)

    def _distance_to_place(self, i: int, poses: Mapping[str, Posed]) -> float:
        """Distance in m from a goal's box to its current place."""
        goal = place(self.goals[: i + 1], poses)[i]
        return length(poses[goal.object].position - goal.position)

    @cached_property
    def _start_distances(self) -> tuple[float, ...]:
        """Distance in m from every goal's box to its place at the start."""
        start = {box.name: _Start(box) for box in self.objects}
        return tuple(self._distance_to_place(i, start) for i in range(len(self.goals)))


class _Start:
    """State of a box at the start."""

    def __init__(self, box: Box) -> None:
        self.position = np.asarray(box.position)
        c, s = cos(box.yaw), sin(box.yaw)
        self.rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _reason_not_settled(name: str, state: ObjectState) -> str:
    if state.lean > LEAN_TOLERANCE:
        return Message(
            "stack_tilted",
            "the {box} box is tilted by {degrees} degrees",
            box=name,
            degrees=f"{np.rad2deg(state.lean):.0f}",
        )
    if state.held:
        return Message("stack_touched", "a hand still touches the {box} box", box=name)
    if state.speed > SPEED_TOLERANCE:
        return Message("stack_moves", "the {box} box is still moving", box=name)
    return ""


def too_small(name: str, surface: Surface, example_in: tuple[float, float]) -> SurfaceTooSmallError:
    """The error for a surface that is too small for a task."""
    size = surface.width_in, surface.height_in
    return SurfaceTooSmallError(name, size, "the boxes", example_in)
