"""Push, pinch or drag a box to a goal on the table."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import ClassVar

import numpy as np

from models.arithmetic import distance, length
from models.errors import SurfaceTooSmallError
from models.message import Message
from models.objects import Box
from models.surface import Surface
from tasks.sensing import ObjectState, Sensing
from tasks.task import Goal, Measure, TaskDefaults

EDGE = 0.050
"""Edge of the box (m)."""
BORDER = 0.042
"""Smallest distance (m) of a box's centre from the surface's border. A fingertip then has room
between the box and the border."""
DISTANCE = (0.050, 0.100)
"""Range of the distance (m) from start to goal."""
ROOM = 0.055
"""Least diagonal (m) of the area for a box's centre; in a smaller area, no goal is far enough
away."""
TURN = np.deg2rad(45.0)
"""Largest turn from start to goal (rad)."""
MASS = (0.050, 0.250)
"""Range of the box's mass (kg)."""

POSITION_TOLERANCE = 0.010
YAW_TOLERANCE = np.deg2rad(10.0)
TILT_TOLERANCE = np.deg2rad(5.0)
SPEED_TOLERANCE = 0.010
"""Largest errors in position (m), yaw (rad) and tilt (rad), and largest speed (m/s), of a box at
its goal."""


@dataclass(frozen=True)
class BoxToGoal(TaskDefaults):
    """Bring a 5 cm box onto its translucent twin.

    Scene: a cube with edges of 5 cm and a mass of 50 to 250 g on a table. The friction coefficient
    between box and table is 0.5.
    Goal: the box's ghost, 5 to 10 cm away and turned by up to 45 degrees.
    Success: within 30 s, all of these hold for 0.5 s without a break: the centre is within 1 cm of
    the goal (in three dimensions); the yaw is within 10 degrees of the goal; the tilt is under 5
    degrees; the box touches the table; the box is slower than 1 cm/s; no hand touches it. A cube
    looks the same after every quarter turn, so the yaw counts to the nearest of the four equal
    poses.
    Start: start and goal are uniform over the part of the surface that is at least 42 mm from its
    border, and redrawn until their distance is in range. The yaw is uniform within 45 degrees of
    the surface's axes, and the turn to the goal is uniform within 45 degrees.
    History: version 1.
    """

    name: ClassVar[str] = "box-to-goal"
    version: ClassVar[int] = 1
    time_limit: ClassVar[float] = 30.0
    hold_time: ClassVar[float] = 0.5
    table_friction: ClassVar[float] = 0.5
    touch_height: ClassVar[float] = 0.022
    lift_range: ClassVar[float] = 0.0
    plane: ClassVar[str] = "table"

    seed: int
    objects: tuple[Box, ...]
    goals: tuple[Goal, ...]

    @classmethod
    def draw(cls, seed: int, surface: Surface) -> BoxToGoal:
        """Draws the trial of a seed; the same seed and surface give the same trial.

        Raises:
            SurfaceTooSmallError: The surface has no room for a start and a goal.
        """
        rng = np.random.default_rng([seed, cls.version])
        low = np.array([BORDER, BORDER])
        high = surface.size - BORDER
        if np.any(high < low) or length(high - low) < ROOM:
            size = surface.width_in, surface.height_in
            raise SurfaceTooSmallError(cls.name, size, "two places of a box", (5.5, 4.0))
        distance = 0.0
        while not DISTANCE[0] <= distance <= DISTANCE[1]:
            start, end = rng.uniform(low, high), rng.uniform(low, high)
            distance = length(end - start)
        yaw = float(rng.uniform(-np.pi / 4, np.pi / 4))
        turn = float(rng.uniform(-TURN, TURN))
        mass = float(rng.uniform(*MASS))
        places = surface.to_world(np.stack([start, end]))
        half = EDGE / 2
        box = Box("box", (half, half, half), mass, (*places[0, :2].tolist(), half), yaw)
        goal = Goal("box", (*places[1, :2].tolist(), half), yaw + turn)
        return cls(seed, (box,), (goal,))

    def measure(self, sensing: Sensing) -> Measure:
        """Tests whether the box is at its goal now."""
        box, goal = sensing.object("box"), self.goals[0]
        target = goal.position
        off = distance(box.position.tolist(), target)
        reason = missing(box, goal)
        way = max(distance(target, self.objects[0].position) - POSITION_TOLERANCE, 1e-9)
        travelled = 1.0 - max(off - POSITION_TOLERANCE, 0.0) / way
        # Only success gives 1. A box that is on its way, tilted or still held gives less.
        progress = 1.0 if not reason else min(max(travelled, 0.0), 0.99)
        return Measure(not reason, progress, reason)


def missing(box: ObjectState, goal: Goal) -> str:
    """Text of the first condition that a box does not meet at its goal; empty if it meets all.

    Args:
        box: The box, a cube.
        goal: Its goal on the table.
    """
    off = distance(box.position.tolist(), goal.position)
    if off > POSITION_TOLERANCE:
        return _from_goal(f"{1000 * off:.0f}")
    # Seen from above, a cube repeats every 90 degrees.
    quarter = np.pi / 2
    turn = abs((box.yaw - goal.yaw + quarter / 2) % quarter - quarter / 2)
    reason: str = ""
    if box.tilt > TILT_TOLERANCE:
        degrees = f"{np.rad2deg(box.tilt):.0f}"
        reason = Message("box_tilted", "the box is tilted by {degrees} degrees", degrees=degrees)
    elif turn > YAW_TOLERANCE:
        reason = Message(
            "box_turned",
            "the box is turned by {degrees} degrees against the goal",
            degrees=f"{np.rad2deg(turn):.0f}",
        )
    elif not box.on_table:
        reason = Message("box_off_table", "the box does not stand on the table")
    elif box.held:
        reason = Message("box_touched", "a hand still touches the box")
    elif box.speed > SPEED_TOLERANCE:
        reason = Message("box_moves", "the box is still moving")
    return reason


@cache
def _from_goal(mm: str) -> Message:
    """The reason while the box is away from its goal. It is cached, since most control steps have
    this reason, and successive steps often have the same number of millimetres."""
    return Message("box_from_goal", "the box is {mm} mm from the goal", mm=mm)
