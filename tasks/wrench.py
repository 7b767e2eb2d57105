"""Wrench tasks: turn a wrench on a bolt, or turn and slide a wrench that lies on the table."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import cos, sin
from typing import ClassVar, Self

import numpy as np

from models import arithmetic
from models.arithmetic import Array, length
from models.errors import SurfaceTooSmallError
from models.message import Message
from models.objects import BOLT_LIFT, HANDLE, JAW, THICKNESS, Wrench
from models.surface import Surface
from tasks.sensing import ObjectState, Sensing
from tasks.task import Goal, Measure, TaskDefaults

Place = tuple[float, float, float]

NAME = "wrench"
"""Name of the wrench in all these tasks."""
MASS = (0.060, 0.150)
"""Range of the wrench's mass (kg)."""
END_BORDER = 0.004
"""Least distance (m) of an end of the wrench from the surface's border."""
SPEED_TOLERANCE = 0.010
"""Speed (m/s) of the wrench's middle, below which it counts as still."""

_TRIES = 4_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class WrenchTask(TaskDefaults, ABC):
    """Bring a wrench onto its translucent twin.

    Subclasses differ in the wrench's freedom of movement, its starts and its tolerances.

    Attributes:
        stream: Number of this task in the key of the random generator.
        border: Least distance (m) of a drawn place from the surface's border.
        room: Text for error messages that names the objects for which a surface needs room.
        room_in: (2,) inches, size of a surface with enough room.
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
        """Friction (N m) about the bolt; None without a bolt."""
        return None

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the wrench is at its goal, let go and at rest now."""
        wrench = sensing.object(NAME)
        reason = self._missing(wrench) or _reason_not_settled(wrench)
        # Only success gives 1.
        progress = 1.0 if not reason else float(min(self._progress(wrench), 0.99))
        return Measure(not reason, progress, reason, self._lost(wrench))

    @abstractmethod
    def _missing(self, wrench: ObjectState) -> str:
        """Reason why the wrench is not at its goal, apart from touch and speed; empty at the
        goal."""

    def _lost(self, wrench: ObjectState) -> bool:
        """True if the wrench was turned in a way that ends the trial."""
        return False

    @abstractmethod
    def _progress(self, wrench: ObjectState) -> float:
        """Progress: 0 at the start or farther away, 1 at the goal."""

    def _turn_left(self, wrench: ObjectState) -> float:
        """Angle in rad between the wrench and its goal."""
        return _apart(wrench.yaw, self.goals[0].yaw)

    def _turned(self, wrench: ObjectState, tolerance: float) -> float:
        """Share of the turn that is done, complete within a tolerance (rad)."""
        whole = _apart(self.objects[0].yaw, self.goals[0].yaw)
        return share(self._turn_left(wrench), whole, tolerance)


def share(left: float, whole: float, tolerance: float) -> float:
    """Share (0 to 1) of a way that is done, complete within a tolerance."""
    return min(max(1.0 - max(left - tolerance, 0.0) / (whole - tolerance), 0.0), 1.0)


def _reason_not_settled(wrench: ObjectState) -> str:
    if wrench.held:
        return Message("wrench_touched", "a hand still touches the wrench")
    if wrench.speed > SPEED_TOLERANCE:
        return Message("wrench_moves", "the wrench is still moving")
    return ""


def wrapped(angle: float) -> float:
    """An angle (rad), converted to -pi to pi."""
    return float((angle + np.pi) % (2 * np.pi) - np.pi)


def _apart(a: float, b: float) -> float:
    """Difference (rad) of two yaws."""
    return abs(wrapped(a - b))


SLIDE_TURN = (np.deg2rad(40.0), np.deg2rad(80.0))
"""Range of the turn (rad) from start to goal, either way."""
DISTANCE = (0.050, 0.100)
"""Range of the distance (m) of the wrench's middle from start to goal."""

POSITION_TOLERANCE = 0.010
SLIDE_YAW_TOLERANCE = float(np.deg2rad(8.0))
TILT_TOLERANCE = float(np.deg2rad(5.0))
"""Largest errors in position (m), yaw (rad) and tilt (rad) of a wrench at its goal."""


@dataclass(frozen=True)
class WrenchSlide(WrenchTask):
    """Turn and slide a free wrench onto its translucent twin.

    Scene: an open-ended wrench of 12 cm, 60 to 150 g, lies flat on a table. The friction
    coefficient between wrench and table is 0.3.
    Goal: the wrench's ghost, 5 to 10 cm away and turned by 40 to 80 degrees in either direction.
    Success: for 0.5 s without a break, within 30 s, all of these hold: the middle is within 1 cm of
    the goal (in three dimensions), the yaw is within 8 degrees, the tilt is under 5 degrees, the
    wrench touches the table, is slower than 1 cm/s, and no hand touches it.
    Start: the middles are uniform, at least 36 mm from the surface's border, so that fingers have
    room beside the handle. The yaw is uniform over the full circle, and the turn is uniform over
    its range in both directions. Start and goal are redrawn until their distance is in range, and
    both ends of the wrench are at least 4 mm from the border at both places.
    Size: a variation of the size scales all edges of the wrench about the point under its middle.
    The mass does not change. The ends of a larger wrench may be beyond the border.
    History: version 1.
    """

    name: ClassVar[str] = "wrench-slide"
    version: ClassVar[int] = 1
    stream: ClassVar[int] = 3
    border: ClassVar[float] = 0.036
    room: ClassVar[str] = "two places of a wrench"
    room_in: ClassVar[tuple[float, float]] = (7.06, 4.65)

    @classmethod
    def _way(
        cls, rng: np.random.Generator, low: Array, high: Array, surface: Surface
    ) -> tuple[Place, float, Place, float] | None:
        start, end = rng.uniform(low, high), rng.uniform(low, high)
        yaw = float(rng.uniform(-np.pi, np.pi))
        turn = float(rng.uniform(*SLIDE_TURN)) * float(rng.choice([-1.0, 1.0]))
        fits = _on_surface(start, yaw, surface.size) and _on_surface(end, yaw + turn, surface.size)
        if not fits or not DISTANCE[0] <= length(end - start) <= DISTANCE[1]:
            return None
        (x, y), (u, v) = surface.to_world(np.stack([start, end]))[:, :2].tolist()
        return (x, y, THICKNESS / 2), yaw, (u, v, THICKNESS / 2), turn

    def _missing(self, wrench: ObjectState) -> str:
        off, turn = self._off(wrench), self._turn_left(wrench)
        if off > POSITION_TOLERANCE:
            return Message(
                "wrench_from_goal", "the wrench is {mm} mm from the goal", mm=f"{1000 * off:.0f}"
            )
        if wrench.tilt > TILT_TOLERANCE:
            return Message(
                "wrench_tilted",
                "the wrench is tilted by {degrees} degrees",
                degrees=f"{np.rad2deg(wrench.tilt):.0f}",
            )
        if turn > SLIDE_YAW_TOLERANCE:
            return Message(
                "wrench_turned",
                "the wrench is turned by {degrees} degrees against the goal",
                degrees=f"{np.rad2deg(turn):.0f}",
            )
        if not wrench.on_table:
            return Message("wrench_off_table", "the wrench does not lie on the table")
        return ""

    def _progress(self, wrench: ObjectState) -> float:
        """Progress: half for the slide, half for the turn."""
        way = np.subtract(self.goals[0].position, self.objects[0].position)
        slid = share(self._off(wrench), length(way), POSITION_TOLERANCE)
        return 0.5 * (slid + self._turned(wrench, SLIDE_YAW_TOLERANCE))

    def _off(self, wrench: ObjectState) -> float:
        """Distance (m) from the wrench's middle to the goal."""
        return length(wrench.position - self.goals[0].position)


def _on_surface(middle: Array, yaw: float, size: Array) -> bool:
    """True if both ends of a wrench are on the surface (in its frame, y down)."""
    way = np.array([cos(yaw), -sin(yaw)])
    ends = middle + np.outer([JAW - 0.012, HANDLE[1]], way)
    return bool(np.all(ends >= END_BORDER) and np.all(ends <= size - END_BORDER))


BOLT_TURN = (np.deg2rad(40.0), np.deg2rad(90.0))
"""Range of the turn (rad) from start to goal, either way."""
FRICTION = (2.0, 2.5)
"""Range of the dry friction (N m) about the bolt; 18 to 22 N at the handle's end."""
GRIP = 0.032
"""Position (m) along the wrench's x axis where fingers close, near the handle's end."""
GRIP_BORDER = 0.034
"""Least distance (m) of that position from the surface's border during the whole turn, so that
fingers have room beside the handle."""

BOLT_YAW_TOLERANCE = float(np.deg2rad(5.0))
"""Angle (rad) within which the wrench counts as turned."""

TOO_FAR = float(np.deg2rad(15.0))
"""Angle (rad) past the goal at which the nut is overtightened."""


@dataclass(frozen=True)
class WrenchTurn(WrenchTask):
    """Turn a wrench about its bolt onto its translucent twin.

    Scene: an open-ended wrench of 12 cm, 60 to 150 g, on a fixed bolt that is being tightened or
    loosened. The dry friction of 2.0 to 2.5 N m holds the wrench in place when it is let go.
    Nothing stops the wrench at the goal. If it is turned more than 15 degrees past the goal, the
    nut is overtightened and the trial fails.
    Goal: the wrench's ghost, turned by 40 to 90 degrees in either direction.
    Success: the yaw is within 5 degrees of the goal, the wrench's middle is slower than 1 cm/s, and
    no hand touches the wrench, all for 2 s without a break, within 20 s.
    Start: the bolt is uniform, at least 18 mm from the surface's border, so that it can be seen.
    The yaw is uniform over the full circle, and the turn is uniform over its range in both
    directions. All are redrawn until, during the whole turn, the part of the handle where fingers
    close is at least 34 mm from the border, and the handle's end at least 4 mm.
    Size: a variation of the size scales all edges of the wrench and the width of its bolt. The bolt
    stays where it is. Mass and friction do not change, so a shorter handle is harder to turn. A
    longer handle ends beyond the border, and the simulated user grips it nearer to the bolt.
    History: version 3. Version 2 was never registered. It had a hold time of 0.5 s within 30 s, and
    the nut could be turned past the goal. Random touches left the wrench at its goal in 4 of 38
    trials, more than the allowed 5 %. Version 1 was never registered either. Its bolt had a
    friction of 0.02 to 0.10 N m and turned at the lightest contact, so random touches succeeded in
    3 of 25 trials.
    """

    name: ClassVar[str] = "wrench-turn"
    version: ClassVar[int] = 3
    stream: ClassVar[int] = 2
    time_limit: ClassVar[float] = 20.0
    hold_time: ClassVar[float] = 2.0
    border: ClassVar[float] = 0.018
    room: ClassVar[str] = "the way of a wrench's handle"
    room_in: ClassVar[tuple[float, float]] = (7.76, 5.82)

    @classmethod
    def _way(
        cls, rng: np.random.Generator, low: Array, high: Array, surface: Surface
    ) -> tuple[Place, float, Place, float] | None:
        """Draws bolt and turn; on the default surface, one draw in 43 fits."""
        bolt = rng.uniform(low, high)
        yaw = float(rng.uniform(-np.pi, np.pi))
        turn = float(rng.uniform(*BOLT_TURN)) * float(rng.choice([-1.0, 1.0]))
        if not _in_reach(bolt, yaw + np.linspace(0.0, turn, 13), surface.size):
            return None
        place = surface.to_world(bolt)[:2]
        return _middle(place, yaw), yaw, _middle(place, yaw + turn), turn

    @classmethod
    def _bolt(cls, rng: np.random.Generator) -> float:
        return float(rng.uniform(*FRICTION))

    def _missing(self, wrench: ObjectState) -> str:
        off = self._turn_left(wrench)
        if self._lost(wrench):
            return Message("nut_overtightened", "the nut is overtightened")
        if off > BOLT_YAW_TOLERANCE:
            return Message(
                "wrench_from_angle",
                "the wrench is {degrees} degrees from the goal",
                degrees=f"{np.rad2deg(off):.0f}",
            )
        return ""

    def _lost(self, wrench: ObjectState) -> bool:
        start, goal = self.objects[0].yaw, self.goals[0].yaw
        # The angle past the goal is measured up to half a turn; beyond that, its sign changes.
        past = np.sign(wrapped(goal - start)) * wrapped(wrench.yaw - goal)
        return bool(past > TOO_FAR)

    def _progress(self, wrench: ObjectState) -> float:
        return self._turned(wrench, BOLT_YAW_TOLERANCE)


def _in_reach(bolt: Array, yaws: Array, size: Array) -> bool:
    """True if grip and handle's end stay far enough from the surface's border at these yaws.

    Args:
        bolt: (2,) m, position of the bolt in surface coordinates (y down).
        yaws: (n,) rad, yaws of the wrench in the world.
        size: (2,) m, size of the surface.
    """
    ways = np.stack([arithmetic.cos(yaws), -arithmetic.sin(yaws)], axis=1)
    for along, border in ((GRIP, GRIP_BORDER), (HANDLE[1], END_BORDER)):
        places = bolt + (along - JAW) * ways
        if np.any(places < border) or np.any(places > size - border):
            return False
    return True


def _middle(bolt: Array, yaw: float) -> Place:
    """World position (3,) of the middle of a wrench on a bolt (2,)."""
    x, y = bolt - JAW * np.array([cos(yaw), sin(yaw)])
    return float(x), float(y), BOLT_LIFT + THICKNESS / 2
