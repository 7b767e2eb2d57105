"""Bring a box to its goal through two gates of standing pins.

The simulated user drags the box between the pins along the shortest path that is clear of them. A
search on a grid finds this path before the user moves, as a person plans a path with the eyes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from heapq import heappop, heappush
from math import cos, sin, sqrt
from typing import ClassVar

import numpy as np

from models.arithmetic import (
    Array,
    distance,
    length,
    matrix_product,
    small_product,
    squared_lengths,
)
from models.errors import SurfaceTooSmallError
from models.message import Message
from models.objects import Box, Cylinder
from models.surface import Surface, inside
from tasks.box_to_goal import BORDER, POSITION_TOLERANCE, missing
from tasks.sensing import Sensing
from tasks.simulated_user.grasp import Grasp, Surroundings, roomiest_grasp
from tasks.simulated_user.handling import BoxHandling
from tasks.simulated_user.user import SkilledUser
from tasks.simulated_user.user_hand import SCREEN_EDGE, Hand
from tasks.task import Goal, Measure, TaskDefaults
from tasks.user import SeenObject, Sight, UserConfiguration, UserMaker

GRID = 0.004
"""Spacing (m) of the grid on which the search for a path runs."""
EASY = 0.010
"""Clearance (m) to other objects above which a path costs nothing extra."""
_HARD = 0.002
"""Shortfall (m) below `EASY` at which a stretch of the path costs twice its length."""
_BESIDE = 0.045
"""Distance (m) by which a path may pass beyond the start and the end on each axis."""
_LOSES = 0.001
"""Largest clearance (m) that may be lost when a straight leg replaces a part of the path."""
_NEAR_TABLE = 0.020
"""Height (m) above the table at which distances are measured: half the height of the objects."""


@dataclass(frozen=True)
class Footprint:
    """Outline of the box and the fingers that move it, seen from above.

    Attributes:
        points: (n, 2) m, points of box and fingers relative to the middle of the box.
        radii: (n,) m, radii of discs around the points.
        tips: (k, 2) m, fingertips relative to the middle of the box; they must stay on the screen.
    """

    points: Array
    radii: Array
    tips: Array


def clear_leg(
    start: Array,
    end: Array,
    footprint: Footprint,
    things: Sequence[SeenObject],
    surface: Surface,
) -> Array:
    """First straight leg (2,) m of a path from start to end: the longest that stays clear.

    Args:
        start: (2,) m, position of the box.
        end: (2,) m, position to which the box has to go.
        footprint: Outline of the box and the fingers at it.
        things: Obstacles: all objects but the box.
        surface: The screen, which fingers do not leave.
    """
    way = _way(start, end, footprint, things, surface)
    room = [_room(place[None], footprint, things)[0] for place in way]
    for last in range(len(way) - 1, 0, -1):
        least = min(*room[1 : last + 1], EASY) - _LOSES
        many = max(int(length(way[last] - start) / GRID) * 2, 2)
        line = start + np.linspace(0.0, 1.0, many)[1:, None] * (way[last] - start)
        if last == 1 or float(_room(line, footprint, things).min()) >= least:
            return np.asarray(way[last] - start)
    return end - start


def lacking_room(
    start: Array,
    end: Array,
    footprint: Footprint,
    turned: Footprint,
    things: Sequence[SeenObject],
    surface: Surface,
) -> float:
    """Difference (m) between `EASY` and the smallest clearance on the best path and at its end.

    It is 0 if the clearance is at least `EASY` everywhere.

    Args:
        start, end, footprint, things, surface: See `clear_leg`.
        turned: The outline in its orientation at the end.
    """
    way = _way(start, end, footprint, things, surface)
    room = min(
        float(_room(np.array(way[1:]), footprint, things).min()),
        float(_room(end[None], turned, things)[0]),
    )
    return max(EASY - room, 0.0)


def _way(
    start: Array,
    end: Array,
    footprint: Footprint,
    things: Sequence[SeenObject],
    surface: Surface,
) -> list[Array]:
    """Points (2,) m of the best path on the grid, from start to end, both included."""
    low = np.minimum(start, end) - _BESIDE
    counts = [int(n) for n in (np.abs(end - start) + 2 * _BESIDE) / GRID]
    columns, rows = counts[0] + 1, counts[1] + 1
    x, y = (a.ravel() for a in np.meshgrid(np.arange(columns), np.arange(rows)))
    places = low + GRID * np.column_stack([x, y])
    short = np.maximum(EASY - _room(places, footprint, things), 0.0) / _HARD
    price = (
        1.0 + short * short + 1e3 * (short > EASY / _HARD) + 1e3 * _off(places, footprint, surface)
    )
    first, goal = (int(np.argmin(squared_lengths(places - place))) for place in (start, end))
    costs = np.full(len(places), np.inf)
    before = np.full(len(places), -1)
    costs[first] = 0.0
    prices = price.tolist()
    edge = [(0.0, first)]
    while edge:
        cost, at = heappop(edge)
        if at == goal:
            break
        if cost > costs[at]:
            continue
        row, column = divmod(at, columns)
        for down, right, step in _NEIGHBOURS:
            if not (0 <= row + down < rows and 0 <= column + right < columns):
                continue
            to = at + down * columns + right
            new = cost + step * 0.5 * (prices[at] + prices[to])
            if new < costs[to]:
                costs[to], before[to] = new, at
                heappush(edge, (new, to))
    way = [end]
    at = int(before[goal])
    while at >= 0 and at != first:
        way.append(places[at])
        at = int(before[at])
    return [start, *reversed(way)]


_NEIGHBOURS = [(a, b, sqrt(a * a + b * b)) for a in (-1, 0, 1) for b in (-1, 0, 1) if a or b]
"""The eight neighbours of a grid point: offset in rows, offset in columns, distance in steps."""


def _room(places: Array, footprint: Footprint, things: Sequence[SeenObject]) -> Array:
    """Clearance (n,) m between a footprint with its middle at places (n, 2) m and the nearest
    obstacle."""
    if not things:
        return np.full(len(places), np.inf)
    at = (places[:, None] + footprint.points).reshape(-1, 2)
    points = np.column_stack([at, np.full(len(at), _NEAR_TABLE)])
    clear = np.min([o.shape.clearance(points, o.position, o.rotation) for o in things], axis=0)
    return np.asarray((clear.reshape(len(places), -1) - footprint.radii).min(axis=1))


def _off(places: Array, footprint: Footprint, surface: Surface) -> Array:
    """Distance (n,) m by which fingers would be too near to the screen's border or beyond it, for a
    footprint with its middle at places (n, 2) m."""
    at = (places[:, None] + footprint.tips).reshape(-1, 2)
    on = surface.to_surface(np.column_stack([at, np.zeros(len(at))]))
    over = np.maximum(SCREEN_EDGE - np.minimum(on, surface.size - on), 0.0).max(axis=1)
    return np.asarray(over.reshape(len(places), -1).max(axis=1))


_TIP = 0.008
"""Radius (m) that the user assumes for a fingertip, with a small margin."""
_LEANS, _THUMB_LEANS = (0.006,), (0.012, 0.024)
"""Distances (m) outwards from a fingertip to points of a finger, and of the thumb, that are still
lower than the obstacles. Both lean outwards; fingers lean only a little before they arch over the
box."""
_THERE = 0.006
"""Distance (m) from the goal below which the user turns the box."""
_SHARES = (-1.0, -0.5, 0.0, 0.5, 1.0)
"""Positions of the points on a box's outline, as shares of half an edge."""


class AmongHandling(BoxHandling):
    """Handling of a box among objects that must not be touched.

    Args:
        surface: The screen.

    Attributes:
        around: The obstacles and the goal.
    """

    def __init__(self, surface: Surface) -> None:
        self.around = Surroundings(surface)

    def grasp(
        self, seen: SeenObject, turn: float, hand: Hand, failed: Grasp | None = None
    ) -> Grasp:
        """Grasp across two faces of the box: the best compromise between comfort and clearance,
        both where the fingers come down and on the path to the goal."""
        place, goal = np.asarray(seen.position[:2]), self.around.goal
        assert goal is not None and isinstance(seen.shape, Box)
        half = seen.shape.half_size

        def lacking(grasp: Grasp) -> float:
            at_start = footprint(seen.rotation, half, grasp.places(np.zeros(2), 0.0, hand))
            there = replace(grasp, axis=grasp.axis + turn).places(np.zeros(2), 0.0, hand)
            at_goal = footprint(matrix_product(_about_z(turn), seen.rotation), half, there)
            around = self.around
            return lacking_room(place, goal, at_start, at_goal, around.neighbours, around.surface)

        return roomiest_grasp(seen, turn, hand, self.around, failed, lacking)


class SlalomUser(SkilledUser):
    """Drags a box to its goal in straight legs, each clear of all other objects on the table.

    Args:
        configuration: Settings of the simulated user.
        surface: The tablet.
        seed: Seed of the user's randomness.
    """

    drags = 20

    def __init__(self, configuration: UserConfiguration, surface: Surface, seed: int) -> None:
        super().__init__(configuration, surface, seed)
        self._among = AmongHandling(surface)
        self._handling = self._among

    def _act(self, sight: Sight, now: float) -> None:
        (goal,) = sight.goals
        self._among.around = Surroundings(
            self.surface,
            tuple(o for name, o in sight.objects.items() if name != goal.object),
            np.asarray(goal.position[:2]),
        )
        super()._act(sight, now)

    def _leg(self, sight: Sight, box: SeenObject, off: Array, turn: float) -> tuple[Array, float]:
        """Shift (2,) m and turn, rad, of the next movement; the box is turned only at its goal."""
        if length(off) < _THERE:
            return off, turn
        place = np.asarray(box.position[:2])
        ids = self._fingers.ids()
        assert self._grasp is not None and isinstance(box.shape, Box)
        tips = (
            np.array([sight.tips[i][:2] for i in ids]) - place
            if all(i in sight.tips for i in ids)
            else self._grasp.places(np.zeros(2), 0.0, self._hand)
        )
        things = self._among.around.neighbours
        moved = footprint(box.rotation, box.shape.half_size, tips)
        leg = clear_leg(place, place + off, moved, things, self.surface)
        return leg, 0.0


def _about_z(turn: float) -> Array:
    """Rotation (3, 3) by an angle, rad, about the vertical."""
    c, s = cos(turn), sin(turn)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def footprint(rotation: Array, half_size: tuple[float, float, float], tips: Array) -> Footprint:
    """Footprint of a box and the fingers that grasp it.

    Args:
        rotation: (3, 3) rotation of the box.
        half_size: (3,) m, half the edges of the box.
        tips: (n, 2) m, fingertips relative to the middle of the box, thumb first.
    """
    a, b, _ = half_size
    on_edges = [(s, t) for s in _SHARES for t in _SHARES if max(abs(s), abs(t)) == 1.0]
    within = [(s, t) for s in (-0.5, 0.0, 0.5) for t in (-0.5, 0.0, 0.5)]
    places = small_product(np.array(on_edges + within) * (a, b), rotation[:2, :2].T)
    outwards = [tip / length(tip) for tip in tips]
    leaning = [
        tip + way * out
        for i, (tip, out) in enumerate(zip(tips, outwards, strict=True))
        for way in (_LEANS if i else _THUMB_LEANS)
    ]
    fingers = np.vstack([tips, *leaning])
    radii = [0.0] * len(on_edges) + [0.5 * min(a, b)] * len(within) + [_TIP] * len(fingers)
    return Footprint(np.vstack([places, fingers]), np.array(radii), tips)


EDGE = 0.040
"""Edge (m) of the box, equal to the smallest box of the stacking tasks."""
MASS = (0.050, 0.150)
"""Range of the box's mass (kg)."""

PIN_RADIUS, PIN_HEIGHT = 0.00525, 0.0445
"""Radius and height (m) of a pin: the largest that IEC 60086-2 allows for an AAA battery (LR03). A
battery that stands on its end falls when it is tilted by 13 degrees."""
PIN_MASS = 0.0115
"""Mass (kg) of an alkaline AAA battery (11 to 12 g in makers' data sheets)."""
COLOURS = ((0.34, 0.71, 0.91), (0.90, 0.62, 0.0))
"""Colours of the pins of the first and of the second gate."""

OPENING = 0.100
"""Gap (m) between the pins of a gate. The box with a fingertip on either side takes 40 + 2 x 16 mm
of it, which leaves 14 mm to spare on either side."""
GATES_APART = 0.050
"""Distance (m) from the first gate to the second, along the straight path."""
LEAD = (0.026, 0.032)
"""Range of the distances (m) from the start to the first gate and from the second gate to the
goal."""
SHIFT = 0.008
"""Distance (m) by which the two gates are shifted off the straight path, to opposite sides. A box
dragged straight ahead with fingers on either side has 6 mm to spare."""
PIN_BORDER = 0.005
"""Least distance (m) of a pin from the surface's border."""
TURN = float(np.deg2rad(30.0))
"""Largest turn (rad) from start to goal."""

STANDS, FALLEN = float(np.deg2rad(5.0)), float(np.deg2rad(30.0))
"""Tilt (rad) up to which a pin counts as standing, and tilt beyond which it counts as toppled."""

_TRIES = 20_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class Slalom(TaskDefaults):
    """Bring a box to its goal through two gates of standing pins, without toppling one.

    Scene: a box of 4 cm, 50 to 150 g, and four pins that stand on their ends, two for each gate.
    The pins are as large and heavy as AAA batteries. The friction coefficient against the table is
    0.5.
    Goal: the box's ghost, 10.2 to 11.4 cm away behind both gates, turned by up to 30 degrees. The
    gates are 100 mm wide and 5 cm apart. They are shifted off the straight path by 8 mm, the first
    gate to one side and the second to the other side.
    Success: every pin stands (tilt under 5 degrees), and the box is at its goal as in
    `box-to-goal`: centre within 1 cm, yaw within 10 degrees of the nearest equivalent, tilt under 5
    degrees, on the table, slower than 1 cm/s and touched by no hand, all for 0.5 s without a break,
    within 60 s. The trial is lost once a pin is tilted by more than 30 degrees. A path around the
    gates is allowed if the surface has room for it.
    Start: place, direction of the path and distances are uniform, redrawn until start and goal are
    at least 42 mm from the border, and pins at least 5 mm. The yaw is uniform within 45 degrees of
    the surface's axes, and the turn within 30 degrees. The side of the first shift is random.
    History: version 1.
    """

    name: ClassVar[str] = "slalom"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 60.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.5
    touch_height: ClassVar[float] = 0.022
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"
    user: ClassVar[UserMaker | None] = SlalomUser

    seed: int
    objects: tuple[Box | Cylinder, ...]
    goals: tuple[Goal, ...]

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> Slalom:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            SurfaceTooSmallError: The surface has no room for the gates and the way through them.
        """
        rng = np.random.default_rng([seed, cls.version, 22])
        size = surface.size
        for _ in range(_TRIES):
            start = rng.uniform((0.0, 0.0), size)
            angle = float(rng.uniform(-np.pi, np.pi))
            first, last = rng.uniform(*LEAD, 2).tolist()
            side = float(rng.choice((-1.0, 1.0)))
            if not inside(start[None], BORDER, size):
                continue
            along = np.array([cos(angle), sin(angle)])
            across = np.array([-along[1], along[0]])
            end = start + (first + GATES_APART + last) * along
            middles = (
                start + first * along + side * SHIFT * across,
                start + (first + GATES_APART) * along - side * SHIFT * across,
            )
            out = OPENING / 2 + PIN_RADIUS
            pins = [middle + way * out * across for middle in middles for way in (1.0, -1.0)]
            if inside(np.stack([start, end]), BORDER, size) and inside(
                np.stack(pins), PIN_BORDER, size
            ):
                break
        else:
            raise SurfaceTooSmallError(
                cls.name, (surface.width_in, surface.height_in), "two gates of pins", (7.8, 5.9)
            )
        yaw = float(rng.uniform(-np.pi / 4, np.pi / 4))
        turn = float(rng.uniform(-TURN, TURN))
        mass = float(rng.uniform(*MASS))
        places = surface.to_world(np.stack([start, end, *pins]))[:, :2].tolist()
        half = EDGE / 2
        box = Box("box", (half, half, half), mass, (*places[0], half), yaw)
        standing = tuple(
            Cylinder(
                f"pin{i + 1}",
                PIN_RADIUS,
                PIN_HEIGHT / 2,
                PIN_MASS,
                (*place, PIN_HEIGHT / 2),
                rgb=COLOURS[i // 2],
            )
            for i, place in enumerate(places[2:])
        )
        return cls(seed, (box, *standing), (Goal("box", (*places[1], half), yaw + turn),))

    def shifted(self) -> tuple[str, ...]:
        """Only the box; the pins stay where they are."""
        return ("box",)

    def with_room(self, factor: float) -> Slalom:
        """The same trial with the gap of each gate multiplied by a factor."""
        placed = {pin.name: pin.position for pin in self.objects[1:]}
        out = OPENING / 2 + PIN_RADIUS
        wider = (factor * OPENING / 2 + PIN_RADIUS) / out
        moved = []
        for pin in self.objects[1:]:
            number = int(pin.name.removeprefix("pin"))
            other = placed[f"pin{number + 1 if number % 2 else number - 1}"]
            x, y = (
                (a + b) / 2 + wider * (a - b) / 2
                for a, b in zip(pin.position[:2], other[:2], strict=True)
            )
            moved.append(replace(pin, position=(x, y, pin.position[2])))
        return replace(self, objects=(self.objects[0], *moved))

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the box is at its goal now, and every pin stands."""
        box, goal = sensing.object("box"), self.goals[0]
        pins = [sensing.object(pin.name) for pin in self.objects[1:]]
        tilt = max(pin.tilt for pin in pins)
        lost = tilt > FALLEN
        reason: str = missing(box, goal)
        if lost:
            reason = Message("pin_toppled", "a pin has been toppled")
        elif tilt > STANDS:
            reason = Message("pin_leans", "a pin does not stand upright")
        off = distance(box.position.tolist(), goal.position)
        way = max(distance(goal.position, self.objects[0].position) - POSITION_TOLERANCE, 1e-9)
        travelled = 1.0 - max(off - POSITION_TOLERANCE, 0.0) / way
        progress = 1.0 if not reason else min(max(travelled, 0.0), 0.99)
        return Measure(not reason, progress, reason, lost)
