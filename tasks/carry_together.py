"""Carry a tray to its place in the air with a hand at each end. One hand alone tips the tray."""

from __future__ import annotations

from dataclasses import dataclass
from math import asin, cos, sin
from typing import ClassVar

import numpy as np

from models.arithmetic import distance
from models.errors import SurfaceTooSmallError
from models.message import Message
from models.objects import TRAY_GRIP, TRAY_HANDLE, Tray
from models.surface import Surface
from tasks.sensing import Sensing
from tasks.task import Goal, Measure, TaskDefaults

MASS = (0.300, 0.600)
"""Range of the tray's mass (kg)."""
DISTANCE = (0.030, 0.080)
"""Range of the distance (m) from start to goal, seen from above."""
YAW = np.deg2rad(12.0)
"""Largest turn of start and goal against the surface's axes (rad)."""
RISE = (0.040, 0.060)
"""Range of the height (m) of the goal above the start."""
BORDER = 0.042
"""Smallest distance (m) of a grip from the surface's border. A thumb then has room beside the
handle."""
SEAM = 0.030
"""Smallest distance (m) of a grip from the middle line of the surface, which divides the areas of
the two hands."""

POSITION_TOLERANCE = 0.015
YAW_TOLERANCE = np.deg2rad(8.0)
SLOPE_TOLERANCE, ROLL_TOLERANCE = np.deg2rad(6.0), np.deg2rad(25.0)
SPEED_TOLERANCE = 0.050
"""Largest errors in position (m), yaw, slope and roll (rad), and largest speed (m/s), of a tray at
its goal."""

_TRIES = 20_000
"""Number of draws after which a surface is reported as too small."""


@dataclass(frozen=True)
class CarryTogether(TaskDefaults):
    """Lift a tray with a hand at either end, carry it to its translucent twin, and hold it there.

    Scene: a tray of 300 to 600 g lies on a table. Its deck of 16 by 12 cm is wider than a hand can
    open. It has a handle of 30 mm width at each end, and the grips are 24 cm apart. Each hand has
    its own touch surface, with that of the right hand on the right; or both hands share a surface
    of the combined size. A lift control raises each hand by up to 12 cm.
    Goal: the tray's ghost in the air, 4 to 6 cm higher, 3 to 8 cm away and turned.
    Success: for 0.5 s without a break, within 60 s, all of these hold: the tray's middle is within
    15 mm of the goal, the yaw is within 8 degrees, the slope from handle to handle is under 6
    degrees, the roll about that line is under 25 degrees, and the tray does not touch the table and
    is slower than 5 cm/s. The roll may be larger because hands that only move up and down can
    hardly control it. A single hand at one handle tips the tray.
    Start: the tray lies flat on the table. Its middle is uniform over the surface, and its yaw is
    uniform within 12 degrees of the surface's axes. The position and yaw of the goal are drawn in
    the same way, and its height is uniform. Start and goal are redrawn until their distance is in
    range and each grip, at the start and at the goal, is on the half of its hand, at least 42 mm
    from the border and 30 mm from the middle line.
    History: version 1.
    """

    name: ClassVar[str] = "carry-together"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 60.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.5
    touch_height: ClassVar[float] = 0.016
    lift_range: ClassVar[float] = 0.12
    plane: ClassVar[str] = "table"
    hands: ClassVar[int] = 2
    fewest_fingers: ClassVar[int] = 2

    seed: int
    objects: tuple[Tray, ...]
    goals: tuple[Goal, ...]

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> CarryTogether:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Args:
            seed: Seed of everything that is drawn.
            surface: The surface of both hands together.

        Raises:
            SurfaceTooSmallError: The surface has no room for a start and a goal.
        """
        rng = np.random.default_rng([seed, cls.version, 20])
        # Only in this area can both grips of a tray be in their halves of the surface.
        width, height = surface.size.tolist()
        low = (max(width / 2 - TRAY_GRIP + SEAM, 0.0), 0.0)
        high = (min(width / 2 + TRAY_GRIP - SEAM, width), height)
        for _ in range(_TRIES):
            start, end = rng.uniform(low, high, (2, 2)).tolist()
            yaw, goal_yaw = rng.uniform(-YAW, YAW, 2).tolist()
            far = distance(start, end)
            if (
                DISTANCE[0] <= far <= DISTANCE[1]
                and _fits(start, yaw, surface)
                and _fits(end, goal_yaw, surface)
            ):
                break
        else:
            raise SurfaceTooSmallError(
                cls.name,
                (surface.width_in, surface.height_in),
                "a tray between two hands",
                (14.0, 5.5),
                "Give every hand its own surface: --device A --device B",
            )
        mass, rise = float(rng.uniform(*MASS)), float(rng.uniform(*RISE))
        places = surface.to_world(np.array([start, end]))[:, :2].tolist()
        tray = Tray("tray", mass, (*places[0], TRAY_HANDLE[2]), yaw)
        goal = Goal("tray", (*places[1], TRAY_HANDLE[2] + rise), goal_yaw)
        return cls(seed, (tray,), (goal,))

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the tray is in its place now."""
        tray, goal = sensing.object("tray"), self.goals[0]
        off = distance(tray.position.tolist(), goal.position)
        turn = abs((tray.yaw - goal.yaw + np.pi) % (2 * np.pi) - np.pi)
        slope, roll = (asin(min(abs(z), 1.0)) for z in tray.rotation[2, :2].tolist())
        if tray.rotation[2, 2] < 0.0:
            roll = np.pi - roll
        reason: str = ""
        if tray.on_table:
            reason = Message("tray_on_table", "the tray is on the table")
        elif slope > SLOPE_TOLERANCE:
            reason = Message(
                "tray_slopes",
                "the tray slopes by {degrees} degrees from end to end",
                degrees=f"{np.rad2deg(slope):.0f}",
            )
        elif roll > ROLL_TOLERANCE:
            reason = Message(
                "tray_rolled",
                "the tray is rolled by {degrees} degrees",
                degrees=f"{np.rad2deg(roll):.0f}",
            )
        elif off > POSITION_TOLERANCE:
            reason = Message(
                "tray_from_goal", "the tray is {mm} mm from the goal", mm=f"{1000 * off:.0f}"
            )
        elif turn > YAW_TOLERANCE:
            reason = Message(
                "tray_turned",
                "the tray is turned by {degrees} degrees against the goal",
                degrees=f"{np.rad2deg(turn):.0f}",
            )
        elif tray.speed > SPEED_TOLERANCE:
            reason = Message("tray_moves", "the tray is still moving")
        way = max(distance(goal.position, self.objects[0].position) - POSITION_TOLERANCE, 1e-9)
        travelled = 1.0 - max(off - POSITION_TOLERANCE, 0.0) / way
        progress = 1.0 if not reason else min(max(travelled, 0.0), 0.99)
        return Measure(not reason, progress, reason)


def _fits(middle: list[float], yaw: float, surface: Surface) -> bool:
    """True if each hand can reach its grip of a tray.

    Args:
        middle: (2,) m, middle of the tray in surface coordinates.
        yaw: Yaw (rad) of the tray.
        surface: The surface of both hands together.
    """
    # Yaw is counterclockwise seen from above, but the surface's y points down.
    way = TRAY_GRIP * np.array([cos(yaw), -sin(yaw)])
    right, left = middle + way, middle - way
    width, height = surface.size
    half = width / 2
    return bool(
        half + SEAM <= right[0] <= width - BORDER
        and BORDER <= left[0] <= half - SEAM
        and min(right[1], left[1]) >= BORDER
        and max(right[1], left[1]) <= height - BORDER
    )
