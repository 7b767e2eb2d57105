"""Stacking tasks: on a touch surface that lies on the table, or on an upright touch surface.

In `Stack` and `StackThree` the touch surface is flat, and a second control lifts the hand. In
`StackVertical` it is upright, and one hand does everything.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from math import cos, sin
from typing import ClassVar, Self

import numpy as np

from models.arithmetic import Array, length
from models.errors import SurfaceTooSmallError
from models.message import Message
from models.objects import Box
from models.scene import TABLE
from models.surface import Surface
from tasks.sensing import ObjectState, Sensing
from tasks.task import Goal, Measure, Posed, TaskDefaults, place

NAMES = ("base", "second", "third")
"""Names of the boxes, from below."""
COLOURS = ((0.86, 0.30, 0.24), (0.93, 0.68, 0.22), (0.30, 0.52, 0.78))
"""Colours of the boxes. The texts of the web page name the boxes by their colours
(sandbox/words)."""

EDGE = (0.040, 0.060)
"""Range of a box's edge (m)."""
MASS = (0.050, 0.250)
"""Range of a box's mass (kg)."""
YAW = float(np.deg2rad(45.0))
"""Largest rotation of a box relative to the surface's axes at the start (rad), either way."""

OFFSET_TOLERANCE = 0.35
"""Largest distance of the centres of two boxes, seen from above, as a share of the smaller edge."""
LEAN_TOLERANCE = float(np.deg2rad(3.0))
"""Largest tilt (rad) of a stacked box."""
SPEED_TOLERANCE = 0.010
"""Speed (m/s) below which a box counts as still."""


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
    fewest_fingers: ClassVar[int] = 2
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
        """Tests whether the boxes are stacked now. The reason is about the lowest box that is not
        in place."""
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
        """Reason why a box does not stand on the box that belongs below it; empty if it does."""
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


SIDE = 0.012
"""Least distance (m) between the face of an unrotated box and the surface's border at the start. It
is about the width of a fingertip, so a finger has room between box and border."""
GAP = 0.030
"""Least gap (m) between two boxes at the start, so that fingers have room: the distance of their
centres minus half the sum of their edges."""

_TRIES = 20_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class Stack(Stacking):
    """Lift a box, put it down on another box, and let it stand there.

    Scene: two cubes with edges of 40 to 60 mm and masses of 50 to 250 g on a table. The friction
    coefficient is 0.5 between a box and the table, and 1 between the boxes. Touches move the hand
    over the table, and the device's lift control raises the hand by up to 12 cm.
    Goal: the ghost of the second box on top of the base, wherever the base stands now.
    Success: for 0.5 s without a break, within 60 s, all of these hold: the second box rests on the
    base and does not touch the table; seen from above, its centre is nearer to that of the base
    than 0.35 times the smaller edge; the base rests on the table and not on the second box; both
    boxes are tilted by less than 3 degrees, slower than 1 cm/s and touched by no hand. Any face of
    a cube may be below. A box rests on a part of the scene that carries more than 0.6 of its
    weight, measured by contact forces.
    Start: edges, masses and yaws are uniform, the yaws within 45 degrees of the surface's axes.
    Centres are uniform, at least half an edge and 12 mm from the surface's border. Edges and
    centres are redrawn until the distance of the centres is at least 30 mm larger than half the sum
    of the edges.
    History: version 1.
    """

    name: ClassVar[str] = "stack"
    lift_range: ClassVar[float] = 0.12

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Self:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            InputError: The surface is too small for the boxes.
        """
        rng = np.random.default_rng([seed, cls.version, 10 + cls.count])
        # If the smallest boxes do not fit at opposite corners, no draw can succeed.
        widest = surface.size - EDGE[0] - 2 * SIDE
        possible = np.all(widest > 0) and length(widest) > EDGE[0] + GAP
        for _ in range(_TRIES if possible else 0):
            edges = rng.uniform(*EDGE, cls.count)
            shares = rng.uniform(0.0, 1.0, (cls.count, 2))
            low = edges[:, None] / 2 + SIDE
            places = low + shares * (surface.size - 2 * low)
            if np.all(surface.size > 2 * low) and _apart(places, edges):
                break
        else:
            raise too_small(cls.name, surface, (7.76, 5.82))
        masses, yaws = rng.uniform(*MASS, cls.count), rng.uniform(-YAW, YAW, cls.count)
        return cls.of(seed, edges, masses, surface.to_world(places)[:, :2], yaws)


@dataclass(frozen=True)
class StackThree(Stack):
    """Stack three boxes: the second on the base, the third on the second.

    Scene, success and start are those of `stack`, with one more box and a lift of up to 18 cm.
    Edges and places are redrawn together if the boxes do not fit, so large boxes are rarer than
    small boxes.
    History: version 1.
    """

    name: ClassVar[str] = "stack-three"
    count: ClassVar[int] = 3
    lift_range: ClassVar[float] = 0.18


def _apart(places: Array, edges: Array) -> bool:
    """True if all boxes are far enough from each other."""
    for i in range(len(edges)):
        for j in range(i):
            least = (edges[i] + edges[j]) / 2 + GAP
            if length(places[i] - places[j]) < least:
                return False
    return True


UPRIGHT_SIDE = 0.020
"""Least distance (m) from a box's face to the surface's border, for stretched fingers beside the
box."""
UPRIGHT_GAP = 0.030
"""Least distance (m) between the faces of the two boxes at the start, for fingers between them."""
HEADROOM = 0.045
"""Least height (m) of the surface minus the height of the upper box's middle in the finished stack.
This is room for the part of the surface below the table's top, for carrying the box above its
place, and for fingers above its middle."""

_UPRIGHT_TRIES = 4_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class StackVertical(Stacking):
    """Lift a box by dragging it up the screen, put it down on another box, and let go.

    Scene: two cubes with edges of 40 to 60 mm and masses of 50 to 250 g on a table. The friction
    coefficient is 0.5 between a box and the table, and 1 between the boxes. The touch surface
    stands upright in front of them, with its lower edge 15 mm below the table's top. Right on the
    surface is right in the world, and up is up, so one hand is enough. The hand comes from the
    front. The surface is placed so that its fingertips close in the plane of the boxes' middles.
    The person neither sees nor controls the depth, so the program helps there: (1) Of a finger that
    touches, only the ball of the fingertip is solid. A thumb that holds a box reaches down over the
    box below, and would push that box away if its whole last link were solid. (2) As in other
    tasks, a hand turns solid only when it is down, its simulated fingertips are at their targets,
    and none of them is inside a box. (3) A box that fingers can no longer grip is put back after
    half a second. These are boxes into which the fingers' plane reaches by less than 5 mm, and
    boxes that stick out over a side of the surface. Until then boxes move freely along the depth
    and turn freely out of the plane.
    Goal: the ghost of the second box on top of the base, wherever the base stands now.
    Success: as in `stack`, with the depth included in the distance of the centres.
    Start: edges and masses are uniform. Centres are uniform over the surface's width, at least half
    the larger edge and 20 mm from its border, and redrawn until the gap between the boxes is at
    least 30 mm. All faces are square to the surface.
    History: version 1.
    """

    name: ClassVar[str] = "stack-vertical"
    touch_height: ClassVar[float] = -0.006
    plane: ClassVar[str] = "front"

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Self:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            InputError: The surface is too small for the boxes.
        """
        rng = np.random.default_rng([seed, cls.version, 20])
        width, height = surface.size
        for _ in range(_UPRIGHT_TRIES):
            edges = rng.uniform(*EDGE, cls.count)
            # The wider box may be the upper one.
            low = edges.max() / 2 + UPRIGHT_SIDE
            across = low + rng.uniform(0.0, 1.0, cls.count) * (width - 2 * low)
            fits = width > 2 * low and height >= edges[0] + edges[1] / 2 + HEADROOM
            if fits and abs(across[1] - across[0]) >= edges.mean() + UPRIGHT_GAP:
                break
        else:
            raise too_small(cls.name, surface, (7.76, 5.82))
        masses = rng.uniform(*MASS, cls.count)
        places = np.column_stack([surface.origin[0] + across, np.zeros(cls.count)])
        return cls.of(seed, edges, masses, places, np.zeros(cls.count))
